// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "viewer/orbit_camera.h"

namespace lfm {

/// A film: where the eye stands at some moments.
struct CameraPath {
  struct Key {
    double time = 0;  ///< s
    OrbitCamera camera;
  };
  double frames_per_second = 25;
  std::vector<Key> keys;  ///< times rise
};

/// Reads a camera path (docs/formats.md):
///   {"frames_per_second": 25, "keys": [{"time": 0, "azimuth": 300, "elevation": 25,
///    "distance": 500, "target": [x, y, z]}, ...]}
/// (s, degrees, mm). A missing distance or target is `start`'s. Azimuths are not wrapped: from 0 to
/// 720 are two turns. Throws Error on missing, unknown or non-finite values, times that do not
/// rise, and more than 100 000 frames.
CameraPath ReadCameraPath(const std::filesystem::path& file, const OrbitCamera& start);

/// The inverse of ReadCameraPath; atomic. Throws Error when it cannot be written.
void WriteCameraPath(const CameraPath& path, const std::filesystem::path& file);

/// A camera a frame, from the first key to the last: azimuth, elevation, target and the logarithm
/// of the distance run along cubic curves through the keys that never run beyond them, and rest at
/// both ends.
std::vector<OrbitCamera> FramesOf(const CameraPath& path);

}  // namespace lfm
