// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/camera.h"
#include "core/capture.h"
#include "core/pose.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// Where a hand-held camera goes round the subject.
struct CameraPathOptions {
  int photos = 120;
  int test_photos = 16;
  double min_elevation_deg = 10, max_elevation_deg = 85;
  double mm_per_pixel = 0.24;     ///< at the subject's centre
  double distance_jitter = 0.06;  ///< relative, either way
  double max_roll_deg = 35;
  double max_aim_error_mm = 7;
  uint64_t seed = 1;
};

struct CameraStation {
  Pose camera_from_world;
  PhotoSplit split = PhotoSplit::kTrain;
  double elevation_deg = 0;  ///< of the camera centre, seen from the subject's centre
};

/// The photographs' camera: 960 x 720 by default, about 47 degrees wide, Brown distortion.
Camera MakePhotoCamera(int width, int height);

/// The camera with its distortion coefficients times `factor`. Throws Error when such a lens folds
/// over inside the picture.
Camera ScaleDistortion(const Camera& camera, double factor);

/// Where photographs are aimed at and focused: on the axis, at 0.47 of the subject's height.
Eigen::Vector3d SubjectCenter(const TriangleMesh& subject);

/// Stations evenly over the hemisphere between the elevations (spherical Fibonacci lattice with
/// jitter), each aimed near the subject's centre and rolled, every vertex of the subject inside the
/// picture by a margin of 1 % of its height. Test stations are spread evenly among them, away from
/// the lowest and the highest. Throws Error when the subject cannot be framed.
std::vector<CameraStation> MakeCameraPath(const Camera& camera, const TriangleMesh& subject,
                                          const CameraPathOptions& options);

}  // namespace lfm
