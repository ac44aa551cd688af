// SPDX-License-Identifier: BSD-3-Clause
#include "scan/registration.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include "core/parallel.h"
#include "scan/pose_parameters.h"
#include "scan/solver_log.h"

namespace lfm {
namespace {

constexpr int kBlockPx = 8;
constexpr double kMinNormalCosine = 0.7;
// Farther than so many times the limit across a surface, a point is of another surface.
constexpr double kOtherSurface = 4;
constexpr double kTurnFloorRad = 1e-5, kShiftFloorMm = 1e-3;

enum class Half { kFitted, kHeldOut };

/// A point of scan i and the surface of scan j that it meets.
struct Partner {
  int i = 0, j = 0;
  Eigen::Vector3d point_in_i, surface_in_j, normal_in_j;
  double distance_mm = 0;  ///< across the surface, signed
  double sigma_mm = 1;
};

std::vector<size_t> SamplePixels(const RangeMap& map, Half half, int count) {
  std::vector<size_t> pixels;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const bool odd = ((x / kBlockPx + y / kBlockPx) & 1) != 0;
      const size_t p = static_cast<size_t>(y) * map.width + x;
      if (map.depth[p] > 0 && odd == (half == Half::kHeldOut)) pixels.push_back(p);
    }
  }
  const size_t stride = std::max<size_t>(1, pixels.size() / static_cast<size_t>(count)) | 1;
  std::vector<size_t> some;
  for (size_t k = 0; k < pixels.size(); k += stride) some.push_back(pixels[k]);
  return some;
}

/// Everything that partners are looked for in.
struct Search {
  const std::vector<PosedRange>& scans;
  const std::vector<Pose>& starts;
  const Camera& camera;
  const std::vector<Eigen::Vector2d>& rays;
  const RegistrationOptions& options;
};

std::optional<Partner> MeetOther(const Search& search, const std::vector<Pose>& poses, int i, int j,
                                 size_t pixel) {
  const RangeMap &own = search.scans[static_cast<size_t>(i)].map,
                 &other = search.scans[static_cast<size_t>(j)].map;
  const Pose j_from_i = poses[static_cast<size_t>(j)] * poses[static_cast<size_t>(i)].Inverse();
  const Eigen::Vector3d point = own.depth[pixel] * search.rays[pixel].homogeneous();
  const Eigen::Vector3d there = j_from_i * point;
  const std::optional<Eigen::Vector2d> seen = Project(search.camera, there);
  if (!seen || !search.camera.Contains(*seen)) return std::nullopt;
  // On the picture's very border, -0.5, rounding leaves it.
  const int x = static_cast<int>(std::max(0L, std::lround(seen->x())));
  const int y = static_cast<int>(std::max(0L, std::lround(seen->y())));
  if (x >= other.width || y >= other.height) return std::nullopt;
  const size_t q = static_cast<size_t>(y) * other.width + static_cast<size_t>(x);
  if (other.depth[q] <= 0) return std::nullopt;
  Partner partner;
  partner.i = i;
  partner.j = j;
  partner.point_in_i = point;
  partner.surface_in_j = other.depth[q] * search.rays[q].homogeneous();
  partner.normal_in_j = other.normal[q].cast<double>();
  const Eigen::Vector3d normal = j_from_i.rotation * own.normal[pixel].cast<double>();
  if (!(normal.dot(partner.normal_in_j) >= kMinNormalCosine)) return std::nullopt;
  partner.distance_mm = partner.normal_in_j.dot(there - partner.surface_in_j);
  if (!(std::abs(partner.distance_mm) <= kOtherSurface * search.options.max_distance_mm)) {
    return std::nullopt;
  }
  partner.sigma_mm = std::hypot(own.sigma_mm[pixel], other.sigma_mm[q]);
  return partner;
}

std::vector<Partner> FindPartners(const Search& search, const std::vector<Pose>& poses, Half half) {
  const int count = static_cast<int>(search.scans.size());
  std::vector<std::vector<Partner>> found(search.scans.size());
  ParallelFor(0, count, [&](int64_t i) {
    const RangeMap& map = search.scans[static_cast<size_t>(i)].map;
    for (size_t pixel : SamplePixels(map, half, search.options.samples_per_scan)) {
      for (int j = 0; j < count; ++j) {
        if (j == i) continue;
        const auto partner = MeetOther(search, poses, static_cast<int>(i), j, pixel);
        if (partner) found[static_cast<size_t>(i)].push_back(*partner);
      }
    }
  });
  std::vector<Partner> all;
  for (const std::vector<Partner>& list : found) all.insert(all.end(), list.begin(), list.end());
  return all;
}

double RmsMm(const std::vector<Partner>& partners, double limit_mm) {
  double sum = 0;
  for (const Partner& p : partners) {
    const double d = std::min(std::abs(p.distance_mm), limit_mm);
    sum += d * d;
  }
  return partners.empty() ? 0 : std::sqrt(sum / static_cast<double>(partners.size()));
}

struct SurfaceResidual {
  Partner partner;
  Eigen::Matrix3d start_i, start_j;
  double weight;
  template <typename T>
  bool operator()(const T* pose_i, const T* pose_j, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Vector from_origin =
        partner.point_in_i.cast<T>() - Vector(pose_i[3], pose_i[4], pose_i[5]);
    const Vector back(-pose_i[0], -pose_i[1], -pose_i[2]);
    const Vector world = start_i.transpose().cast<T>() * TurnBy<T>(back.data(), from_origin);
    const Vector there = TurnBy<T>(pose_j, Vector(start_j.cast<T>() * world)) +
                         Vector(pose_j[3], pose_j[4], pose_j[5]);
    residual[0] =
        weight * partner.normal_in_j.cast<T>().dot(Vector(there - partner.surface_in_j.cast<T>()));
    return true;
  }
};

std::vector<Pose> AdjustPoses(const Search& search, const std::vector<Pose>& poses,
                              const std::vector<Eigen::Matrix<double, 6, 6>>& covariances,
                              const std::vector<Partner>& partners) {
  std::vector<PoseParameters> unknowns;
  for (const Pose& pose : poses) unknowns.push_back(PackPose(pose));
  ceres::Problem::Options borrowed;
  borrowed.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss loss(search.options.robust_scale);
  ceres::Problem problem(borrowed);
  for (size_t i = 0; i < poses.size(); ++i) {
    Eigen::Matrix<double, 6, 6> covariance = covariances[i];
    covariance.diagonal().head<3>().array() += kTurnFloorRad * kTurnFloorRad;
    covariance.diagonal().tail<3>().array() += kShiftFloorMm * kShiftFloorMm;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PosePrior, 6, 6>(new PosePrior{
                                 WhitenPose(covariance), search.starts[i], poses[i].rotation}),
                             nullptr, unknowns[i].data());
  }
  const double share = 1 / std::sqrt(search.options.correlation);
  for (const Partner& p : partners) {
    if (std::abs(p.distance_mm) > search.options.max_distance_mm) continue;
    const size_t i = static_cast<size_t>(p.i), j = static_cast<size_t>(p.j);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SurfaceResidual, 1, 6, 6>(
            new SurfaceResidual{p, poses[i].rotation, poses[j].rotation, share / p.sigma_mm}),
        &loss, unknowns[i].data(), unknowns[j].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // Threaded BLAS sums in an order of its own: the result would depend on the machine.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = 20;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  SilenceSolverLog();
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return poses;
  std::vector<Pose> adjusted;
  for (size_t i = 0; i < poses.size(); ++i) adjusted.push_back(UnpackPose(poses[i], unknowns[i]));
  return adjusted;
}

/// The middle of the scans' points, world. About it the unknowns are well conditioned; about an
/// origin ten metres away a turn and a shift would be the same.
Eigen::Vector3d WorldCenter(const std::vector<PosedRange>& scans,
                            const std::vector<Eigen::Vector2d>& rays) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const PosedRange& scan : scans) {
    const Pose world_from_camera = scan.camera_from_world.Inverse();
    for (size_t p : SamplePixels(scan.map, Half::kFitted, 100)) {
      sum += world_from_camera * (scan.map.depth[p] * rays[p].homogeneous());
      count += 1;
    }
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : Eigen::Vector3d::Zero();
}

/// A pose's covariance once the world's origin lies at `center`: translation + R center.
Eigen::Matrix<double, 6, 6> MoveOrigin(const Eigen::Matrix<double, 6, 6>& covariance,
                                       const Pose& pose, const Eigen::Vector3d& center) {
  const Eigen::Vector3d arm = pose.rotation * center;
  Eigen::Matrix<double, 6, 6> change = Eigen::Matrix<double, 6, 6>::Identity();
  change.block<3, 3>(3, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return change * covariance * change.transpose();
}

int CountPairs(const std::vector<Partner>& partners) {
  std::set<std::pair<int, int>> pairs;
  for (const Partner& p : partners) pairs.insert(std::minmax(p.i, p.j));
  return static_cast<int>(pairs.size());
}

}  // namespace

Registration RegisterScans(const std::vector<PosedRange>& scans,
                           const std::vector<Eigen::Matrix<double, 6, 6>>& covariances,
                           const Camera& camera, const std::vector<Eigen::Vector2d>& rays,
                           const RegistrationOptions& options, Progress& progress) {
  Registration result;
  for (const PosedRange& scan : scans) result.poses.push_back(scan.camera_from_world);
  const Pose world_from_center{Eigen::Matrix3d::Identity(), WorldCenter(scans, rays)};
  std::vector<Pose> starts;
  std::vector<Eigen::Matrix<double, 6, 6>> centred;
  for (size_t i = 0; i < scans.size(); ++i) {
    starts.push_back(scans[i].camera_from_world * world_from_center);
    centred.push_back(
        MoveOrigin(covariances[i], scans[i].camera_from_world, world_from_center.translation));
  }
  const Search search{scans, starts, camera, rays, options};
  progress.Start("register scans", options.rounds);
  std::vector<Pose> poses = starts;
  RegistrationReport& report = result.report;
  for (int round = 0; round < options.rounds; ++round) {
    const std::vector<Partner> partners = FindPartners(search, poses, Half::kFitted);
    progress.Advance();
    if (partners.empty()) return result;
    report.pairs = CountPairs(partners);
    report.correspondences = static_cast<int>(partners.size());
    poses = AdjustPoses(search, poses, centred, partners);
  }
  const std::vector<Partner> before = FindPartners(search, starts, Half::kHeldOut);
  const std::vector<Partner> after = FindPartners(search, poses, Half::kHeldOut);
  report.held_out = static_cast<int>(before.size());
  report.before_mm = RmsMm(before, options.max_distance_mm);
  report.after_mm = RmsMm(after, options.max_distance_mm);
  // Poses that lose the scans' overlap must not win by having nothing left to compare.
  constexpr double kMinOverlap = 0.95;
  const bool overlaps =
      static_cast<double>(after.size()) >= kMinOverlap * static_cast<double>(before.size());
  report.kept = overlaps && !before.empty() && report.after_mm < report.before_mm;
  if (!report.kept) return result;
  for (size_t i = 0; i < poses.size(); ++i) {
    report.largest_shift_mm =
        std::max(report.largest_shift_mm, (poses[i].translation - starts[i].translation).norm());
    result.poses[i] = poses[i] * world_from_center.Inverse();
  }
  return result;
}

}  // namespace lfm
