// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/calib_picture.h"
#include "core/capture.h"
#include "core/exif.h"

namespace lfm {

/// What a photograph's file says of the camera that took it, if it says anything.
using ExifReader = std::function<std::optional<ExifCamera>(const std::string& file)>;

struct CameraGroups {
  std::map<std::string, CaptureCamera> cameras;
  std::vector<CalibPicture> pictures;
};

/// Parts the photographs that the manifest gives to one camera into the cameras that took them:
/// make, model, focal length and size of a picture. The largest part of the manifest's size keeps
/// the camera's name, the others are NAME-2, NAME-3, ... in order of their size; a picture without
/// EXIF belongs to the first. A part of fewer than three training pictures cannot be calibrated and
/// is set aside with the reason; so is a picture without EXIF that has not its camera's size.
/// Cameras whose intrinsics are given, and the scanner's, are not parted.
CameraGroups GroupByExif(std::vector<CalibPicture> pictures, const Capture& capture,
                         const ExifReader& read_exif);

}  // namespace lfm
