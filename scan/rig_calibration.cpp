// SPDX-License-Identifier: BSD-3-Clause
#include "scan/rig_calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "scan/projector_resection.h"
#include "scan/rig_adjustment.h"

namespace lfm {
namespace {

constexpr int kMinCorrespondences = 50;
// A lens term must lower the held-out squared error at least to this share, and by this much.
constexpr double kLensGain = 0.98;
constexpr double kLensGainPx2 = 1e-6;
constexpr size_t kHeldOutPoints = 250;  // a placement
constexpr const char* kTiltAdvice =
    ": scan the empty platform at least twice (better five times), tilted 15-40 degrees in "
    "different directions and raised, under column and row patterns";

std::vector<int> CountPerPlacement(size_t placements,
                                   const std::vector<PlateCorrespondence>& correspondences) {
  std::vector<int> counts(placements, 0);
  for (const PlateCorrespondence& c : correspondences) ++counts[static_cast<size_t>(c.placement)];
  return counts;
}

std::vector<ResectionPoint> ResectionPoints(const std::vector<PlatePlacement>& placements,
                                            const std::vector<PlateCorrespondence>& all) {
  std::vector<ResectionPoint> points;
  for (const PlateCorrespondence& c : all) {
    const Eigen::Vector3d point =
        MeetPlate(placements[static_cast<size_t>(c.placement)].camera_from_world, c.ray, c.plate);
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
double HeldOutError(const RigState& state, const std::vector<PlateCorrespondence>& all,
                    int placement) {
  double sum = 0, count = 0;
  for (const PlateCorrespondence& c : all) {
    if (c.placement != placement) continue;
    const std::optional<Eigen::Vector2d> residual = RigResidualPx(state, c);
    sum += residual ? std::min(1.0, residual->squaredNorm()) : 1.0;
    count += 1;
  }
  return count > 0 ? sum / count : 0;
}

int ChooseLensTerms(const RigState& start, const std::vector<PlatePlacement>& placements,
                    const std::vector<PlateCorrespondence>& all,
                    const RigCalibrationOptions& options) {
  // Two placements leave one to fit, which calibrates nothing: no evidence for a lens.
  const size_t count = placements.size();
  if (count < 3) return 0;
  const std::vector<PlateCorrespondence> some =
      EveryNth(all, std::max<size_t>(1, all.size() / (kHeldOutPoints * count)));
  std::vector<double> errors(kLensModels.size() * count);
  ParallelFor(0, static_cast<int64_t>(errors.size()), [&](int64_t i) {
    const size_t trial = static_cast<size_t>(i), left_out = trial % count;
    RigData data{placements, some, std::vector<bool>(count, true)};
    data.included[left_out] = false;
    // The left-out placement stands where it was known to stand, whatever fits moved it.
    RigState without = start;
    without.platforms[left_out] = placements[left_out].camera_from_world;
    const RigState state =
        AdjustRig(without, data, {.projector_terms = kLensModels[trial / count]}, options);
    errors[trial] = HeldOutError(state, some, static_cast<int>(left_out));
  });
  double best_error = 0;
  int best_terms = 0;
  for (size_t model = 0; model < kLensModels.size(); ++model) {
    const auto begin = errors.begin() + static_cast<std::ptrdiff_t>(model * count);
    const double error = std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(count), 0.0) /
                         static_cast<double>(count);
    if (model == 0 || error < std::min(kLensGain * best_error, best_error - kLensGainPx2)) {
      best_error = error;
      best_terms = kLensModels[model];
    }
  }
  return best_terms;
}

struct FitStatistics {
  double rms_px = 0;
  int used = 0;
};

FitStatistics Statistics(const RigState& state, const std::vector<PlateCorrespondence>& all,
                         const RigCalibrationOptions& options) {
  FitStatistics statistics;
  double sum = 0;
  for (const PlateCorrespondence& c : all) {
    const std::optional<Eigen::Vector2d> residual = RigResidualPx(state, c);
    if (!residual) continue;
    const double sigma = std::hypot(c.sigma_px.cwiseMax(0.0).norm(), options.sigma_floor_px);
    if (residual->norm() > options.robust_scale * sigma) continue;
    sum += residual->squaredNorm();
    ++statistics.used;
  }
  if (statistics.used > 0) statistics.rms_px = std::sqrt(sum / statistics.used);
  return statistics;
}

RigCalibration RigOf(const RigState& state) {
  RigCalibration rig;
  rig.camera = state.camera;
  rig.projector = state.projector;
  rig.projector_from_camera = state.projector_from_camera;
  return rig;
}

/// The same correspondences with the rays that their pixels have under another camera. A pixel that
/// has none there keeps its ray.
std::vector<PlateCorrespondence> UnderCamera(const std::vector<PlateCorrespondence>& all,
                                             const Camera& from, const Camera& to) {
  std::vector<PlateCorrespondence> moved = all;
  for (PlateCorrespondence& c : moved) {
    const auto pixel = Project(from, c.ray.homogeneous());
    const auto direction = pixel ? TryUnproject(to, *pixel) : std::nullopt;
    if (direction) c.ray = direction->hnormalized();
  }
  return moved;
}

std::vector<double> MedianResiduals(const RigState& state,
                                    const std::vector<PlateCorrespondence>& all) {
  std::vector<std::vector<double>> lengths(state.platforms.size());
  for (const PlateCorrespondence& c : all) {
    const std::optional<Eigen::Vector2d> residual = RigResidualPx(state, c);
    lengths[static_cast<size_t>(c.placement)].push_back(residual ? residual->norm() : 1e9);
  }
  std::vector<double> medians;
  for (std::vector<double>& list : lengths) {
    const auto middle = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
    std::nth_element(list.begin(), middle, list.end());
    medians.push_back(list.empty() ? 0 : *middle);
  }
  return medians;
}

/// Fewer correspondences, as many as are independent, for the curvature.
std::vector<PlateCorrespondence> IndependentOf(const std::vector<PlateCorrespondence>& all,
                                               size_t placements) {
  const std::vector<int> counts = CountPerPlacement(placements, all);
  std::vector<int> passed(placements, 0);
  std::vector<PlateCorrespondence> some;
  for (const PlateCorrespondence& c : all) {
    const size_t i = static_cast<size_t>(c.placement);
    const int stride = std::max(1, counts[i] / kIndependentPoints);
    if (passed[i]++ % stride == 0) some.push_back(c);
  }
  return some;
}

}  // namespace

RigAdjustment CalibrateRig(const Camera& camera, int projector_width, int projector_height,
                           const std::vector<PlatePlacement>& placements,
                           const std::vector<PlateCorrespondence>& correspondences,
                           const RigCalibrationOptions& options) {
  const std::vector<int> counts = CountPerPlacement(placements.size(), correspondences);
  const auto enough =
      std::count_if(counts.begin(), counts.end(), [](int n) { return n >= kMinCorrespondences; });
  const std::vector<ResectionPoint> points = ResectionPoints(placements, correspondences);
  CheckMotion(points, static_cast<int>(enough), options);

  const Resection start = ResectProjector(points, projector_width, projector_height);
  RigState state{camera, start.projector, start.projector_from_camera, {}};
  for (const PlatePlacement& p : placements) state.platforms.push_back(p.camera_from_world);
  const RigData data{placements, correspondences, std::vector<bool>(placements.size(), true)};
  state = AdjustRig(state, data, {}, options);
  const double condition = RigCondition(state, data, options);
  if (!(condition <= options.max_condition)) {
    throw Error(
        "the rig cannot be calibrated: the placements of the platform barely differ "
        "(condition number " +
        std::to_string(condition) + ")" + kTiltAdvice);
  }
  const int terms = options.lens_terms
                        ? *options.lens_terms
                        : ChooseLensTerms(state, placements, correspondences, options);
  if (terms > 0) state = AdjustRig(state, data, {.projector_terms = terms}, options);
  const FitStatistics statistics = Statistics(state, correspondences, options);
  RigAdjustment result;
  result.used = statistics.used;
  result.rig = RigOf(state);
  result.rig.projector_terms = terms;
  result.rig.projector_rms_px = statistics.rms_px;
  result.rig.camera_rms_px = CornerRmsPx(state, placements);
  result.rig.condition = condition;
  result.platforms = state.platforms;
  return result;
}

RigRefinement RefineRig(const RigCalibration& rig, std::optional<int> camera_terms,
                        const RigEvidence& evidence, int scans_begin, TurntableUse use,
                        const RigCalibrationOptions& options) {
  const std::vector<PlatePlacement>& placements = evidence.placements;
  RigData data{placements, evidence.correspondences, std::vector<bool>(placements.size(), true)};
  const bool given = rig.source == RigSource::kGiven;
  const RigFreedom freedom{!given, given ? 0 : rig.projector_terms, camera_terms};
  RigState start{rig.camera, rig.projector, rig.projector_from_camera, {}};
  for (const PlatePlacement& p : placements) start.platforms.push_back(p.camera_from_world);
  RigState state = AdjustRig(start, data, freedom, options);

  // Given the camera: what its intrinsics leave open, poses and projector move with, and points on
  // the platform hardly feel it.
  const RigFreedom given_camera{freedom.projector, freedom.projector_terms, std::nullopt};
  const auto covariance_at = [&](const RigState& at) {
    const std::vector<PlateCorrespondence> some = IndependentOf(
        UnderCamera(evidence.correspondences, start.camera, at.camera), placements.size());
    return ComputeRigCovariance(at, {placements, some, data.included}, given_camera, options);
  };
  RigCovariance covariance = covariance_at(state);
  std::vector<PoseEstimate> scans;
  for (size_t i = static_cast<size_t>(scans_begin); i < placements.size(); ++i) {
    scans.push_back({state.platforms[i], covariance.platforms[i]});
  }
  data.runs = FindTurntableRuns(scans, use);
  for (TurntableRun& run : data.runs) {
    for (int& member : run.members) member += scans_begin;
  }
  if (!data.runs.empty()) {
    state = AdjustRig(start, data, freedom, options);
    covariance = covariance_at(state);
  }

  RigRefinement result;
  const std::vector<PlateCorrespondence> seen =
      UnderCamera(evidence.correspondences, start.camera, state.camera);
  result.rig = RigOf(state);
  result.rig.source = rig.source;
  result.rig.raster_gain = rig.raster_gain;
  result.rig.condition = rig.condition;
  result.rig.projector_terms = rig.projector_terms;
  result.rig.projector_rms_px = Statistics(state, seen, options).rms_px;
  result.rig.camera_rms_px = CornerRmsPx(state, placements);
  for (size_t i = 0; i < placements.size(); ++i) {
    result.platforms.push_back({state.platforms[i], covariance.platforms[i]});
  }
  result.uncertainty.projector = covariance.projector;
  result.runs = data.runs;
  result.median_px = MedianResiduals(state, seen);
  return result;
}

}  // namespace lfm
