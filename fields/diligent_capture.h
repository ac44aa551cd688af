// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/capture.h"
#include "core/progress.h"
#include "fields/field_capture.h"

namespace lfm {

/// Whether a folder has the two files that DiLiGenT's layout cannot do without.
bool IsDiligentFolder(const std::filesystem::path& folder);

/// A capture of a folder in the layout of the DiLiGenT photometric stereo benchmark (Shi et al.
/// 2019): `filenames.txt` with a picture a line (16-bit PNG, linear), `light_directions.txt` with
/// x, y, z a line (x right, y up, z to the viewer), and, where they are there,
/// `light_intensities.txt` with r, g, b (or one number) a line and `mask.png`. No pose. Every
/// `held_out_lights`-th line is held out.
///
/// Throws Error, naming file, line and cure, when a file is missing or empty, lines do not agree in
/// number, a number is not finite, a direction is the zero vector, an intensity is not positive, a
/// picture is missing, named twice, or lies outside the folder, or every light would be held out.
Capture OpenDiligentCapture(const std::filesystem::path& folder, const FieldCaptureOptions& options,
                            Progress& progress);

}  // namespace lfm
