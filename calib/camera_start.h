// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/calib_picture.h"
#include "core/camera.h"

namespace lfm {

/// Pictures of one camera that can be used, by index.
std::vector<size_t> SelectPictures(const std::vector<CalibPicture>& pictures,
                                   const std::string& camera_name, PhotoSplit split);

/// Throws Error when fewer than three training pictures of a camera are in use, which is what
/// unknown intrinsics need; quotes one that was set aside.
void RequireEnough(const std::vector<CalibPicture>& pictures, const std::string& camera_name);

/// A camera and the pictures that it took.
struct CameraStart {
  Camera camera;
  std::vector<CalibPicture> pictures;
};

/// Intrinsics and poses to start from, out of the detected tags of the training pictures of one
/// camera: focal length from homographies, no lens distortion, planar poses, then a robust
/// adjustment. Pictures whose pose cannot be found are set aside. `known` intrinsics are held.
/// Throws Error when intrinsics are unknown and fewer than three pictures are in use.
CameraStart StartCamera(std::vector<CalibPicture> pictures, const std::string& camera_name,
                        int width, int height, const std::optional<Camera>& known);

/// Start poses of the pictures of one split, from their detected tags with the camera held.
std::vector<CalibPicture> StartPoses(std::vector<CalibPicture> pictures,
                                     const std::string& camera_name, PhotoSplit split,
                                     const Camera& camera);

}  // namespace lfm
