// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/camera.h"
#include "core/pose.h"

namespace lfm {

/// A camera and where it stands.
struct PosedCamera {
  Camera camera;
  Pose camera_from_world;  ///< mm; world = platform frame
};

/// Reads a camera file (docs/formats.md):
///   {"camera": {"width", "height", "fx", "fy", "cx", "cy" and, if the lens distorts, "k1", "k2",
///    "k3", "p1", "p2"}, "camera_from_world": {"rotation": [w, x, y, z], "translation": [x, y, z]}}
/// Throws Error on missing, unknown or non-finite values and on cameras that make no picture.
PosedCamera ReadCameraFile(const std::filesystem::path& file);
/// The inverse; atomic.
void WriteCameraFile(const PosedCamera& camera, const std::filesystem::path& file);

/// The calibrated camera of a photograph in a workspace folder (WORK/calib). Throws Error when the
/// folder holds no calibration or the photograph is not among the posed ones.
PosedCamera PhotoCamera(const std::filesystem::path& work, const std::string& photo_id);
/// Those of all photographs that have a pose, by their ids.
std::map<std::string, PosedCamera> PhotoCameras(const std::filesystem::path& work);

}  // namespace lfm
