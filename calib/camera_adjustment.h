// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/bundle_adjustment.h"
#include "calib/calib.h"
#include "calib/calib_picture.h"

namespace lfm {

/// A camera and the pictures that it took, adjusted together.
struct CameraAdjustment {
  Camera camera;
  std::vector<CalibPicture> pictures;
  int lens_terms = kAllLensTerms;  ///< that are adjusted; the others stay 0
};

/// Intrinsics and poses to start from, out of the detected tags of the training pictures of one
/// camera: focal length from homographies, no lens distortion, planar poses, then a robust
/// adjustment. Pictures whose pose cannot be found are set aside. `known` intrinsics are held.
/// Throws Error when intrinsics are unknown and fewer than three pictures are in use.
CameraAdjustment StartCamera(std::vector<CalibPicture> pictures, const std::string& camera_name,
                             int width, int height, const std::optional<Camera>& known);

/// Start poses of the pictures of one split, from their detected tags with the camera held.
std::vector<CalibPicture> StartPoses(std::vector<CalibPicture> pictures,
                                     const std::string& camera_name, PhotoSplit split,
                                     const Camera& camera);

/// Adjusts poses (and, unless `known`, intrinsics with `adjustment.lens_terms` lens terms) to the
/// refined corners of the training pictures of one camera: with the Cauchy loss, then without the
/// corners beyond 4.5 robust standard deviations. Pictures that keep fewer than `min_corners` or
/// fit worse than `max_reprojection_px` are set aside, and the rest is adjusted again. Throws Error
/// when intrinsics are unknown and fewer than three pictures remain.
CameraAdjustment AdjustCamera(CameraAdjustment adjustment, const std::string& camera_name,
                              const Board& board, const std::optional<Camera>& known,
                              const CalibOptions& options);

/// The same for the test pictures of one camera: each by its own corners, the camera held.
std::vector<CalibPicture> AdjustTestPoses(std::vector<CalibPicture> pictures,
                                          const std::string& camera_name, const Camera& camera,
                                          const Board& board, const CalibOptions& options);

/// How the corners of some pictures of one camera fit.
struct CornerStatistics {
  int64_t corners = 0;
  double squared_px2 = 0;  ///< sum of squared errors, both coordinates
  double noise_px = 0;     ///< standard deviation of a coordinate, unbiased by the fitted unknowns
};
CornerStatistics ComputeCornerStatistics(const Camera& camera, const std::vector<BundleView>& views,
                                         int fitted_intrinsics);

/// Throws Error when the pictures do not determine the focal length to 2 % at the given noise, with
/// so many lens terms fitted beside it: all were taken from straight above, say.
void CheckFocalObservable(const std::string& camera_name, const Camera& camera,
                          const std::vector<BundleView>& views, double noise_px, int lens_terms);

}  // namespace lfm
