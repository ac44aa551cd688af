// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calib/board_match.h"
#include "calib/corner_refinement.h"
#include "core/capture.h"
#include "core/pose.h"

namespace lfm {

enum class PictureKind { kPhoto, kScan, kPlacement };

/// One picture on its way through the calibration.
struct CalibPicture {
  PictureKind kind = PictureKind::kPhoto;
  std::string id, file, camera;
  PhotoSplit split = PhotoSplit::kTrain;
  std::string rejected;  ///< the reason it was set aside, or empty

  int width = 0, height = 0;  ///< of the picture, px
  BoardMatch match;           ///< tags as the detector saw them
  double blur_px = 0;
  double noise_px = 0;  ///< standard deviation of a corner coordinate, once it is known
  Pose camera_from_world;
  std::vector<CornerObservation> corners;  ///< refined

  bool InUse() const { return rejected.empty(); }
};

/// Every picture of a capture that must be posed: photographs in manifest order, then the white
/// picture of every scan and of every placement. Throws Error when the scanner's roles name no
/// "white" frame.
std::vector<CalibPicture> ListPictures(const Capture& capture);

}  // namespace lfm
