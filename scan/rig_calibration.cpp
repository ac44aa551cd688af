// SPDX-License-Identifier: BSD-3-Clause
#include "scan/rig_calibration.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "scan/projector_resection.h"
#include "scan/rig_adjustment.h"

namespace lfm {
namespace {

constexpr double kPlateMarginMm = 1;
constexpr double kFlatWhite = 0.08;  // largest relative spread of white about a correspondence
constexpr int kFlatRadiusPx = 2;
constexpr int kMinCorrespondences = 50;
// A lens term must lower the held-out squared error at least to this share, and by this much.
constexpr double kLensGain = 0.98;
constexpr double kLensGainPx2 = 1e-6;
constexpr size_t kHeldOutPoints = 250;  // a placement
constexpr const char* kTiltAdvice =
    ": scan the empty platform at least twice (better five times), tilted 15-40 degrees in "
    "different directions and raised, under column and row patterns";

bool IsFlatWhite(const DecodedPixels& decoded, int x, int y) {
  float low = 1e30F, high = 0;
  for (int dy = -kFlatRadiusPx; dy <= kFlatRadiusPx; ++dy) {
    for (int dx = -kFlatRadiusPx; dx <= kFlatRadiusPx; ++dx) {
      const float c = decoded.contrast[static_cast<size_t>(y + dy) * decoded.width + x + dx];
      low = std::min(low, c);
      high = std::max(high, c);
    }
  }
  return high > 0 && high - low <= kFlatWhite * high;
}

std::vector<int> CountPerPlacement(size_t placements,
                                   const std::vector<PlateCorrespondence>& correspondences) {
  std::vector<int> counts(placements, 0);
  for (const PlateCorrespondence& c : correspondences) ++counts[static_cast<size_t>(c.placement)];
  return counts;
}

std::vector<ResectionPoint> ResectionPoints(const std::vector<PriorPlane>& planes,
                                            const std::vector<PlateCorrespondence>& all) {
  std::vector<ResectionPoint> points;
  for (const PlateCorrespondence& c : all) {
    const Eigen::Vector3d point =
        MeetPlane(planes[static_cast<size_t>(c.placement)], Eigen::Vector3d::Zero(), c.ray);
    points.push_back({point, c.projector_px, c.sigma_px.y() > 0});
  }
  return points;
}

void CheckMotion(const std::vector<ResectionPoint>& points, int placements_used,
                 const RigCalibrationOptions& options) {
  if (placements_used < 2) {
    throw Error("the rig cannot be calibrated: only " + std::to_string(placements_used) +
                " placement of the empty platform could be decoded" + kTiltAdvice);
  }
  if (CloudThickness(points) < options.min_thickness) {
    throw Error(std::string("the rig cannot be calibrated: all placements of the platform lie in "
                            "one plane of the scanner, which leaves two of ten unknowns free") +
                kTiltAdvice);
  }
  const bool rows =
      std::any_of(points.begin(), points.end(), [](const ResectionPoint& p) { return p.has_row; });
  if (!rows) {
    throw Error(std::string("the rig cannot be calibrated from column patterns alone") +
                kTiltAdvice);
  }
}

/// Mean squared residual, each clipped at 1 px, of a placement that did not take part.
double HeldOutError(const RigState& state, const std::vector<PriorPlane>& planes,
                    const std::vector<PlateCorrespondence>& all, int placement) {
  double sum = 0, count = 0;
  for (const PlateCorrespondence& c : all) {
    if (c.placement != placement) continue;
    const std::optional<Eigen::Vector2d> residual = RigResidualPx(state, planes, c);
    sum += residual ? std::min(1.0, residual->squaredNorm()) : 1.0;
    count += 1;
  }
  return count > 0 ? sum / count : 0;
}

std::vector<PlateCorrespondence> EveryNth(const std::vector<PlateCorrespondence>& all, size_t n) {
  std::vector<PlateCorrespondence> some;
  for (size_t i = 0; i < all.size(); i += n) some.push_back(all[i]);
  return some;
}

int ChooseLensTerms(const RigState& start, const std::vector<PriorPlane>& planes,
                    const std::vector<PlateCorrespondence>& all,
                    const RigCalibrationOptions& options) {
  // Two placements leave one to fit, which calibrates nothing: no evidence for a lens.
  if (planes.size() < 3) return 0;
  const std::vector<PlateCorrespondence> some =
      EveryNth(all, std::max<size_t>(1, all.size() / (kHeldOutPoints * planes.size())));
  double best_error = 0;
  int best_terms = 0;
  for (int terms : kLensModels) {
    double error = 0;
    for (size_t left_out = 0; left_out < planes.size(); ++left_out) {
      std::vector<bool> included(planes.size(), true);
      included[left_out] = false;
      const RigState state = AdjustRig(start, planes, some, included, terms, options);
      error += HeldOutError(state, planes, some, static_cast<int>(left_out));
    }
    error /= static_cast<double>(planes.size());
    if (terms == 0 || error < std::min(kLensGain * best_error, best_error - kLensGainPx2)) {
      best_error = error;
      best_terms = terms;
    }
  }
  return best_terms;
}

struct FitStatistics {
  double rms_px = 0;
  int used = 0;
};

FitStatistics Statistics(const RigState& state, const std::vector<PriorPlane>& planes,
                         const std::vector<PlateCorrespondence>& all,
                         const RigCalibrationOptions& options) {
  FitStatistics statistics;
  double sum = 0;
  for (const PlateCorrespondence& c : all) {
    const std::optional<Eigen::Vector2d> residual = RigResidualPx(state, planes, c);
    if (!residual) continue;
    const double sigma = std::hypot(c.sigma_px.cwiseMax(0.0).norm(), options.sigma_floor_px);
    if (residual->norm() > options.robust_scale * sigma) continue;
    sum += residual->squaredNorm();
    ++statistics.used;
  }
  if (statistics.used > 0) statistics.rms_px = std::sqrt(sum / statistics.used);
  return statistics;
}

}  // namespace

std::vector<PlateCorrespondence> PlateCorrespondences(const DecodedPixels& decoded,
                                                      const std::vector<Eigen::Vector2d>& rays,
                                                      const Board& board,
                                                      const PlatePlacement& placement,
                                                      int placement_index, int max_count) {
  std::vector<PlateCorrespondence> all;
  if (decoded.column.confidence.empty()) return all;
  const bool rows = !decoded.row.confidence.empty();
  const PriorPlane plane = PlaneOfPlacement(placement);
  const Pose world_from_camera = placement.camera_from_world.Inverse();
  for (int y = kFlatRadiusPx; y + kFlatRadiusPx < decoded.height; ++y) {
    for (int x = kFlatRadiusPx; x + kFlatRadiusPx < decoded.width; ++x) {
      const size_t p = static_cast<size_t>(y) * decoded.width + x;
      if (decoded.column.confidence[p] <= 0 || !IsFlatWhite(decoded, x, y)) continue;
      if (rows && decoded.row.confidence[p] <= 0) continue;
      const Eigen::Vector3d point = MeetPlane(plane, Eigen::Vector3d::Zero(), rays[p]);
      if (!point.allFinite() || point.z() <= 0) continue;
      const Eigen::Vector3d on_plate = world_from_camera * point;
      if (std::abs(on_plate.x()) > board.width_mm / 2 - kPlateMarginMm ||
          std::abs(on_plate.y()) > board.height_mm / 2 - kPlateMarginMm) {
        continue;
      }
      PlateCorrespondence c;
      c.placement = placement_index;
      c.ray = rays[p];
      c.projector_px = {decoded.column.position[p], rows ? decoded.row.position[p] : 0.0};
      c.sigma_px = {decoded.column.sigma[p], rows ? decoded.row.sigma[p] : 0.0};
      all.push_back(c);
    }
  }
  const size_t limit = static_cast<size_t>(std::max(1, max_count));
  // A stride that shares no factor with a row's length walks over rows and columns alike.
  return EveryNth(all, (all.size() + limit - 1) / limit | 1);
}

RigAdjustment CalibrateRig(const Camera& camera, int projector_width, int projector_height,
                           const std::vector<PlatePlacement>& placements,
                           const std::vector<PlateCorrespondence>& correspondences,
                           const RigCalibrationOptions& options) {
  const std::vector<int> counts = CountPerPlacement(placements.size(), correspondences);
  const auto enough =
      std::count_if(counts.begin(), counts.end(), [](int n) { return n >= kMinCorrespondences; });
  std::vector<PriorPlane> planes;
  for (const PlatePlacement& placement : placements) planes.push_back(PlaneOfPlacement(placement));
  const std::vector<ResectionPoint> points = ResectionPoints(planes, correspondences);
  CheckMotion(points, static_cast<int>(enough), options);

  const Resection start = ResectProjector(points, projector_width, projector_height);
  RigState state{start.projector, start.projector_from_camera,
                 std::vector<Eigen::Vector3d>(planes.size(), Eigen::Vector3d::Zero())};
  const std::vector<bool> all(planes.size(), true);
  state = AdjustRig(state, planes, correspondences, all, 0, options);
  const double condition = RigCondition(state, planes, correspondences, options);
  if (!(condition <= options.max_condition)) {
    throw Error(
        "the rig cannot be calibrated: the placements of the platform barely differ "
        "(condition number " +
        std::to_string(condition) + ")" + kTiltAdvice);
  }
  RigAdjustment result;
  result.lens_terms = ChooseLensTerms(state, planes, correspondences, options);
  if (result.lens_terms > 0) {
    state = AdjustRig(state, planes, correspondences, all, result.lens_terms, options);
  }
  const FitStatistics statistics = Statistics(state, planes, correspondences, options);
  result.used = statistics.used;
  result.rig.camera = camera;
  result.rig.projector = state.projector;
  result.rig.projector_from_camera = state.projector_from_camera;
  result.rig.projector_rms_px = statistics.rms_px;
  result.rig.condition = condition;
  return result;
}

}  // namespace lfm
