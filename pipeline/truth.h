// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// What is really true of a synthetic capture: `CAPTURE/ground_truth`, itself a capture folder.
/// Opened by lfm-evaluate and tests alone.
struct GroundTruth {
  Capture capture;  ///< intrinsics, poses, masks, noise-free test photographs
  TriangleMesh mesh;
  Eigen::Vector2d plate_half_mm = {0, 0};  ///< half the platform's size; zero without a board
};
GroundTruth LoadGroundTruth(const std::filesystem::path& capture_folder);

/// Median errors of all posed photographs: distance of camera centres and angle of rotations.
struct PoseErrors {
  double median_mm = 0, median_deg = 0, max_mm = 0, max_deg = 0;
  int photos = 0;
};
PoseErrors MeasurePoses(const CalibResult& calib, const GroundTruth& truth);

/// What is left of the centres' errors after the best similarity: a print of another size than its
/// file says makes everything larger, and no picture shows it.
struct AlignedPoseErrors {
  double median_mm = 0;
  double scale_percent = 0;  ///< how much larger the calibration is than the truth
};
/// Of all posed photographs; with fewer than three, nothing is taken away: MeasurePoses' median.
AlignedPoseErrors MeasureAlignedPoses(const CalibResult& calib, const GroundTruth& truth);

/// Mean normalised squared error of the posed photographs, a degree of freedom: 1 when their
/// covariances are honest. 0 when none has a covariance.
double MeasurePoseHonesty(const CalibResult& calib, const GroundTruth& truth);

/// The largest errors of any camera that took a posed photograph (or scan).
struct IntrinsicsErrors {
  double focal_percent = 0;       ///< of fx or fy, of the true one
  double principal_point_px = 0;  ///< distance
  int cameras = 0;                ///< that the truth knows; 0: nothing was measured
};
IntrinsicsErrors MeasurePhotoIntrinsics(const CalibResult& calib, const GroundTruth& truth);
IntrinsicsErrors MeasureScannerIntrinsics(const CalibResult& calib, const GroundTruth& truth);

/// Scan points against the true object and the true platform plate (z = 0 within the plate).
struct PointErrors {
  double median_mm = 0, p95_mm = 0, over_1_mm_share = 0;
  /// Share of the true surface that camera and projector both see unoccluded in some scan, with a
  /// scanned point within 0.5 mm.
  double completeness = 0;
  double seen_share = 0;  ///< of the true surface, area
};

/// Distances between a reconstructed surface and the true one, both directions together, where the
/// true surface is seen by camera and projector in some scan. Accuracy, completeness and their
/// harmonic mean are shares within kSurfaceThreshold_mm (mesh/surface_comparison.h).
struct SurfaceErrors {
  double mean_mm = 0, rms_mm = 0, p95_mm = 0, max_mm = 0;
  double accuracy = 0, completeness = 0, f_score = 0;
};
inline constexpr double kSurfaceThreshold_mm = 0.2;

/// Compares geometry with the truth; the visibility of the true surface is found once.
class GeometryJudge {
 public:
  explicit GeometryJudge(const GroundTruth& truth);
  ~GeometryJudge();
  PointErrors MeasurePoints(const PointCloud& points) const;
  SurfaceErrors MeasureSurface(const TriangleMesh& mesh) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
