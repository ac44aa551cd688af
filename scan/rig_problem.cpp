// SPDX-License-Identifier: BSD-3-Clause
#include "scan/rig_problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/lens_distortion.h"

namespace lfm {
namespace {

// Given poses come without covariance: this is how far they are believed.
constexpr double kTurnFloorRad = 2e-5;
constexpr double kShiftFloorMm = 2e-3;
constexpr double kCornerSigmaFloorPx = 0.01;
constexpr double kMinDepthMm = 1e-6;
constexpr double kMadToSigma = 1.4826;

double ValueOf(double x) { return x; }
template <typename T, int N>
double ValueOf(const ceres::Jet<T, N>& x) {
  return x.a;
}

/// Pixel of normalised coordinates under the intrinsics of RigProblem::camera.
template <typename T, typename U>
Eigen::Matrix<U, 2, 1> PixelOf(const T* c, const U& x, const U& y) {
  const LensTerms<U> lens{U(c[4]), U(c[5]), U(c[8]), U(c[6]), U(c[7]), U(c[9]), U(c[10]), U(c[11])};
  const Eigen::Matrix<U, 2, 1> d = DistortNormalized(lens, x, y);
  return {U(c[0]) * d[0] + U(c[2]), U(c[1]) * d[1] + U(c[3])};
}

/// The ray of a pixel, and by the implicit function theorem its derivatives by the intrinsics:
/// Newton's method in plain numbers, then one step in T.
template <typename T>
Eigen::Matrix<T, 2, 1> RayOf(const T* intrinsics, const Eigen::Vector2d& pixel,
                             const Eigen::Vector2d& start) {
  using Jet = ceres::Jet<double, 2>;
  double plain[12];
  for (int i = 0; i < 12; ++i) plain[i] = ValueOf(intrinsics[i]);
  Eigen::Vector2d ray = start;
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Identity();
  constexpr int kSteps = 4;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Matrix<Jet, 2, 1> seen = PixelOf(plain, Jet(ray.x(), 0), Jet(ray.y(), 1));
    Eigen::Matrix2d jacobian;
    jacobian << seen[0].v.transpose(), seen[1].v.transpose();
    inverse = jacobian.inverse();
    ray -= inverse * (Eigen::Vector2d(seen[0].a, seen[1].a) - pixel);
  }
  const Eigen::Matrix<T, 2, 1> off = PixelOf(intrinsics, T(ray.x()), T(ray.y())) - pixel.cast<T>();
  return ray.cast<T>() - inverse.cast<T>() * off;
}

/// A correspondence's residual once the camera's ray is known.
struct LitResidual {
  Eigen::Vector2d projector_px, weight;  ///< weight 1 / sigma; y is 0 where the row is unknown
  PlatePlane plate;
  Eigen::Matrix3d projector_start, platform_start;
  Camera lens_rest;  ///< the projector's k3 to k6, held

  template <typename T>
  bool Evaluate(const Eigen::Matrix<T, 2, 1>& ray, const T* pinhole, const T* lens, const T* turn,
                const T* translation, const T* platform, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Vector normal =
        TurnBy<T>(platform, Vector((platform_start * plate.normal).template cast<T>()));
    const Vector direction(ray[0], ray[1], T(1));
    const T distance = normal.dot(Vector(platform[3], platform[4], platform[5])) + plate.height;
    const Vector point = direction * (distance / normal.dot(direction));
    const Vector lit = TurnBy<T>(turn, Vector(projector_start.template cast<T>() * point)) +
                       Vector(translation[0], translation[1], translation[2]);
    if (!(lit[2] > T(kMinDepthMm))) return false;
    const Eigen::Matrix<T, 2, 1> d =
        DistortNormalized(LensTerms<T>{lens[0], lens[1], T(lens_rest.k3), lens[2], lens[3],
                                       T(lens_rest.k4), T(lens_rest.k5), T(lens_rest.k6)},
                          lit[0] / lit[2], lit[1] / lit[2]);
    residual[0] = weight.x() * (pinhole[0] * d[0] + pinhole[2] - projector_px.x());
    residual[1] = weight.y() * (pinhole[1] * d[1] + pinhole[3] - projector_px.y());
    return true;
  }
};

struct HeldCameraResidual {
  LitResidual lit;
  Eigen::Vector2d ray;
  template <typename T>
  bool operator()(const T* pinhole, const T* lens, const T* turn, const T* translation,
                  const T* platform, T* residual) const {
    const Eigen::Matrix<T, 2, 1> r = ray.cast<T>();
    return lit.Evaluate<T>(r, pinhole, lens, turn, translation, platform, residual);
  }
};

struct FreeCameraResidual {
  LitResidual lit;
  Eigen::Vector2d pixel, start_ray;
  template <typename T>
  bool operator()(const T* pinhole, const T* lens, const T* turn, const T* translation,
                  const T* platform, const T* camera, T* residual) const {
    return lit.Evaluate<T>(RayOf<T>(camera, pixel, start_ray), pinhole, lens, turn, translation,
                           platform, residual);
  }
};

struct CornerResidual {
  SeenCorner seen;
  Eigen::Matrix3d platform_start;
  double weight;
  template <typename T>
  bool operator()(const T* camera, const T* platform, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Vector p =
        TurnBy<T>(platform, Vector((platform_start * seen.point_in_world).template cast<T>())) +
        Vector(platform[3], platform[4], platform[5]);
    if (!(p[2] > T(kMinDepthMm))) return false;
    const Eigen::Matrix<T, 2, 1> pixel = PixelOf(camera, T(p[0] / p[2]), T(p[1] / p[2]));
    residual[0] = weight * (pixel[0] - seen.pixel.x());
    residual[1] = weight * (pixel[1] - seen.pixel.y());
    return true;
  }
};

std::vector<int> Range(int begin, int end) {
  std::vector<int> list;
  for (int i = begin; i < end; ++i) list.push_back(i);
  return list;
}

void AddPlatform(const RigState& state, const PlatePlacement& placement, size_t i,
                 double corner_sigma_px, double robust_scale, RigProblem& a) {
  for (const SeenCorner& seen : placement.corners) {
    a.problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<CornerResidual, 2, 12, 6>(
            new CornerResidual{seen, state.platforms[i].rotation, 1 / corner_sigma_px}),
        new ceres::HuberLoss(robust_scale), a.camera.data(), a.platforms[i].data());
  }
  if (!placement.corners.empty()) return;
  Eigen::Matrix<double, 6, 6> covariance = placement.covariance;
  covariance.diagonal().head<3>().array() += kTurnFloorRad * kTurnFloorRad;
  covariance.diagonal().tail<3>().array() += kShiftFloorMm * kShiftFloorMm;
  a.problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PosePrior, 6, 6>(new PosePrior{
          WhitenPose(covariance), placement.camera_from_world, state.platforms[i].rotation}),
      nullptr, a.platforms[i].data());
}

void AddCorrespondence(const RigState& state, const PlateCorrespondence& seen, bool camera_free,
                       const RigCalibrationOptions& options, RigProblem& a) {
  const size_t i = static_cast<size_t>(seen.placement);
  const Eigen::Vector2d variance =
      seen.sigma_px.cwiseAbs2().array() + options.sigma_floor_px * options.sigma_floor_px;
  Eigen::Vector2d weight = variance.cwiseSqrt().cwiseInverse();
  if (!(seen.sigma_px.y() > 0)) weight.y() = 0;
  const LitResidual lit{
      seen.projector_px,           weight,         seen.plate, state.projector_from_camera.rotation,
      state.platforms[i].rotation, state.projector};
  auto* loss = new ceres::HuberLoss(options.robust_scale);
  if (!camera_free) {
    a.problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<HeldCameraResidual, 2, 4, 4, 3, 3, 6>(
            new HeldCameraResidual{lit, seen.ray}),
        loss, a.pinhole.data(), a.lens.data(), a.turn.data(), a.translation.data(),
        a.platforms[i].data());
    return;
  }
  const std::array<double, 12>& c = a.camera;
  const Eigen::Vector2d pixel = PixelOf(c.data(), seen.ray.x(), seen.ray.y());
  a.problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<FreeCameraResidual, 2, 4, 4, 3, 3, 6, 12>(
          new FreeCameraResidual{lit, pixel, seen.ray}),
      loss, a.pinhole.data(), a.lens.data(), a.turn.data(), a.translation.data(),
      a.platforms[i].data(), a.camera.data());
}

void AddRun(const RigState& state, const TurntableRun& run, RunParameters& unknowns,
            RigProblem& a) {
  Eigen::Matrix<double, 6, 1> weight;
  weight << Eigen::Vector3d::Constant(1 / run.play_rad), Eigen::Vector3d::Constant(1 / run.play_mm);
  for (size_t m = 0; m < run.members.size(); ++m) {
    const size_t i = static_cast<size_t>(run.members[m]);
    auto* residual = new TurntableResidual{state.platforms[i].rotation, run.base.rotation,
                                           run.direction, run.point, weight.asDiagonal()};
    a.problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<TurntableResidual, 6, 6, 4, 6, 1>(residual), nullptr,
        a.platforms[i].data(), unknowns.axis.data(), unknowns.base.data(), &unknowns.angles[m]);
  }
  a.problem.SetParameterBlockConstant(unknowns.angles.data());
}

void HoldUnknowns(const RigFreedom& freedom, RigProblem& a) {
  const auto hold = [&](double* block) {
    if (a.problem.HasParameterBlock(block)) a.problem.SetParameterBlockConstant(block);
  };
  const auto hold_some = [&](double* block, int size, const std::vector<int>& held) {
    if (held.empty() || !a.problem.HasParameterBlock(block)) return;
    a.problem.SetManifold(block, new ceres::SubsetManifold(size, held));
  };
  if (!freedom.projector) {
    for (double* block : a.ProjectorBlocks()) hold(block);
  } else if (freedom.projector_terms == 0) {
    hold(a.lens.data());
  } else {
    hold_some(a.lens.data(), 4, Range(freedom.projector_terms, 4));
  }
  if (!freedom.camera_terms) {
    hold(a.camera.data());
  } else {
    hold_some(a.camera.data(), 12, Range(4 + *freedom.camera_terms, 12));
  }
}

}  // namespace

double CornerSigmaPx(const RigState& state, const std::vector<PlatePlacement>& placements) {
  std::vector<double> off;
  for (size_t i = 0; i < placements.size(); ++i) {
    for (const SeenCorner& seen : placements[i].corners) {
      const auto pixel = Project(state.camera, state.platforms[i] * seen.point_in_world);
      if (!pixel) continue;
      off.push_back(std::abs(pixel->x() - seen.pixel.x()));
      off.push_back(std::abs(pixel->y() - seen.pixel.y()));
    }
  }
  if (off.empty()) return 1;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return std::max(kCornerSigmaFloorPx, kMadToSigma * *middle);
}

std::unique_ptr<RigProblem> BuildRigProblem(const RigState& state, const RigData& data,
                                            const RigFreedom& freedom,
                                            const RigCalibrationOptions& options,
                                            double corner_sigma_px) {
  auto a = std::make_unique<RigProblem>();
  const Camera &c = state.camera, &p = state.projector;
  a->camera = {c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6};
  a->pinhole = {p.fx, p.fy, p.cx, p.cy};
  a->lens = {p.k1, p.k2, p.p1, p.p2};
  const Eigen::Vector3d& t = state.projector_from_camera.translation;
  a->translation = {t.x(), t.y(), t.z()};
  for (const Pose& pose : state.platforms) a->platforms.push_back(PackPose(pose));
  for (size_t i = 0; i < data.placements.size(); ++i) {
    if (!data.included[i]) continue;
    AddPlatform(state, data.placements[i], i, corner_sigma_px, options.robust_scale, *a);
  }
  for (const PlateCorrespondence& seen : data.correspondences) {
    if (!data.included[static_cast<size_t>(seen.placement)]) continue;
    AddCorrespondence(state, seen, freedom.camera_terms.has_value(), options, *a);
  }
  for (const TurntableRun& run : data.runs) {
    a->runs.push_back({{0, 0, 0, 0}, PackPose(run.base), run.angles});
  }
  for (size_t r = 0; r < data.runs.size(); ++r) AddRun(state, data.runs[r], a->runs[r], *a);
  HoldUnknowns(freedom, *a);
  return a;
}

RigState StateOf(const RigProblem& a, const RigState& start) {
  RigState state = start;
  Camera& c = state.camera;
  c.fx = a.camera[0], c.fy = a.camera[1], c.cx = a.camera[2], c.cy = a.camera[3];
  c.k1 = a.camera[4], c.k2 = a.camera[5], c.p1 = a.camera[6], c.p2 = a.camera[7];
  c.k3 = a.camera[8], c.k4 = a.camera[9], c.k5 = a.camera[10], c.k6 = a.camera[11];
  Camera& p = state.projector;
  p.fx = a.pinhole[0], p.fy = a.pinhole[1], p.cx = a.pinhole[2], p.cy = a.pinhole[3];
  p.k1 = a.lens[0], p.k2 = a.lens[1], p.p1 = a.lens[2], p.p2 = a.lens[3];
  PoseParameters projector;
  std::copy(a.turn.begin(), a.turn.end(), projector.begin());
  std::copy(a.translation.begin(), a.translation.end(), projector.begin() + 3);
  state.projector_from_camera = UnpackPose(start.projector_from_camera, projector);
  for (size_t i = 0; i < a.platforms.size(); ++i) {
    state.platforms[i] = UnpackPose(start.platforms[i], a.platforms[i]);
  }
  return state;
}

}  // namespace lfm
