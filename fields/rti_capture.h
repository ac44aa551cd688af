// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/capture.h"
#include "core/progress.h"
#include "fields/field_capture.h"

namespace lfm {

/// A capture of the pictures that an .lp file names, one column a line, in the picture's frame
/// (no pose). Every `held_out_lights`-th line is held out.
///
/// The capture's folder is the file's, or the one above a folder `assembly-files` (RTIBuilder
/// writes its .lp there, its pictures beside it); pictures come from inside it alone. A path in the
/// file is taken as it stands when it leads to a file in there, else (absolute, of another machine)
/// the picture is looked for by its name, regardless of case, in the folder and three levels of
/// folders below; of several, the one whose folders agree with the path's longest.
///
/// Throws Error as ReadLpFile does, and when pictures are missing (some are named), are to be found
/// in several places, two lines lead to one picture, or every light would be held out.
Capture OpenLpCapture(const std::filesystem::path& file, const FieldCaptureOptions& options,
                      Progress& progress);

}  // namespace lfm
