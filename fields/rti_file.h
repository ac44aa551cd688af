// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "fields/ptm_file.h"

namespace lfm {

/// The bytes of an .rti file of hemispherical harmonics, as RTIBuilder's fitter writes and
/// RTIViewer, relight and web viewers open it: four lines of text that end in CR LF,
///
///   #HSH1.2 / 3 / width height 3 / terms 2 1
///
/// then, float32 little-endian, a scale and then a bias a term, then the bytes of the terms of red,
/// green and blue, pixel after pixel, rows from the top. A coefficient is byte / 255 * scale +
/// bias, the sum 0 to 1 and what the screen shows; the light's frame is the picture's (ViewFrame).
/// One channel is written three times.
///
/// Throws Error when the basis is another, the values are not display-coded, or sizes do not agree.
std::string EncodeRti(const FitPicture& picture);
/// The inverse, frame = the picture's; 4, 9 and 16 terms. Throws Error, `name` in front, when the
/// bytes are of another kind, cut short or longer than they say, or a scale is not finite. Takes
/// memory in proportion to `bytes`.
FitPicture DecodeRti(std::string_view bytes, const std::string& name);

void WriteRti(const FitPicture& picture, const std::filesystem::path& file);
FitPicture ReadRti(const std::filesystem::path& file);

}  // namespace lfm
