// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/image.h"

namespace lfm {

/// Pictures side by side on white, 8-bit sRGB RGB, tops aligned, a gap of 8 pixels between.
/// Throws Error when there is none.
Image SideBySide(const std::vector<Image>& pictures);

/// |a - b| times `gain`, clamped, black outside the mask. Both 8-bit RGB of one size.
Image DifferencePicture(const Image& a, const Image& b, const Image& mask, int gain);

/// The rectangle of the mask's pixels, with a margin, cut out of a picture of the same size; the
/// whole picture when the mask is empty.
Image CropToMask(const Image& picture, const Image& mask, int margin);

}  // namespace lfm
