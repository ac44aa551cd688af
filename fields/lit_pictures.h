// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/capture.h"
#include "core/photo_split.h"
#include "fields/field_capture.h"

namespace lfm {

/// What light number `light` (from 0) is for when every `every`-th is held out: the last of each
/// `every`; 0: none.
PhotoSplit SplitOfLight(int64_t light, int every);

/// A capture whose pictures a list of another program names, in the picture's frame: a camera
/// "view" of the first picture's size, splits by `options.held_out_lights`. `encoding` is that of
/// 16-bit pictures. Throws Error, `list` in front, when there is no picture, all would be held out,
/// or the first cannot be read.
Capture CaptureOfLitPictures(const std::filesystem::path& folder, const std::string& name,
                             const std::string& list, std::vector<LitPicture> pictures,
                             ColorEncoding encoding, const FieldCaptureOptions& options);

/// "'a.png', 'b.png', 'c.png' and 4 more", for messages.
std::string SomeNames(const std::vector<std::string>& names);

}  // namespace lfm
