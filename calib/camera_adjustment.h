// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "calib/board.h"
#include "calib/bundle_adjustment.h"
#include "calib/bundle_covariance.h"
#include "calib/calib.h"
#include "calib/calib_picture.h"
#include "calib/lens_choice.h"
#include "calib/platform_choice.h"

namespace lfm {

struct AdjustedCamera {
  Camera camera;
  bool known = false;                ///< intrinsics were given and are held
  int lens_terms = kBrownLensTerms;  ///< that are adjusted; the others stay 0
};

/// All cameras of a capture, the pictures that they took, and the platform that they saw.
struct Adjustment {
  std::map<std::string, AdjustedCamera> cameras;
  std::vector<CalibPicture> pictures;
  PlatformModel platform;
  PlatformShape shape;
};

/// The refined corners of the pictures in use of one split, as the adjustment takes them, weighed
/// by their noise (`CalibPicture::noise_px`) where it is known. Training pictures from one place
/// share what they have wrong (the print, where pixels cut edges): to cameras and platform they say
/// together what one of them says, and weigh so.
struct AdjustmentBundle {
  JointBundle bundle;
  std::vector<size_t> pictures;  ///< a view's place among `Adjustment::pictures`
  std::vector<double> repeats;   ///< so many views were taken from a view's place, itself counted
  double noise_px = 0;           ///< of a corner coordinate of weight 1
};
AdjustmentBundle BundleOf(const Adjustment& adjustment, const Board& board, PhotoSplit split,
                          const CalibOptions& options);

/// Adjusts everything together to the refined corners of the training pictures, outliers weighing
/// less (Cauchy loss). Throws Error when a camera with unknown intrinsics has fewer than three.
Adjustment AdjustRobustly(Adjustment adjustment, const Board& board, const CalibOptions& options);

/// Adjusts all poses, the intrinsics that are not known and the platform's unknowns together to the
/// refined corners of the training pictures: with the Cauchy loss, then without the corners beyond
/// 4.5 robust standard deviations, each picture weighed by its own noise. Pictures that keep fewer
/// than `min_corners` or fit worse than `max_reprojection_px` are set aside. Throws Error when
/// fewer than three pictures of a camera with unknown intrinsics remain.
Adjustment AdjustCorners(Adjustment adjustment, const Board& board, const CalibOptions& options);

/// The test pictures: each by its own corners, cameras and platform held.
Adjustment AdjustTestPoses(Adjustment adjustment, const Board& board, const CalibOptions& options);

/// What a lens needs, over the training pictures of one camera, the platform held.
LensChoice ChooseLensTerms(const Adjustment& adjustment, const std::string& camera_name,
                           const Board& board, const CalibOptions& options);
/// What the platform needs, over the training pictures of all cameras.
PlatformChoice ChoosePlatform(const Adjustment& adjustment, const Board& board,
                              const CalibOptions& options);

/// So many corners a picture needs: `min_corners`, or all that a small board has.
int LeastCorners(const Board& board, const CalibOptions& options);

/// Throws Error when pictures do not determine a camera's focal length to 2 %, or its principal
/// point to 2 % of the picture: all were taken from straight above, say, or from one place.
void CheckObservable(const std::string& camera_name, const Camera& camera,
                     const Eigen::Matrix<double, kIntrinsics, kIntrinsics>& covariance);

}  // namespace lfm
