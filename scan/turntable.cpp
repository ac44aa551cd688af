// SPDX-License-Identifier: BSD-3-Clause
#include "scan/turntable.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "scan/solver_log.h"
#include "scan/turntable_residual.h"

namespace lfm {
namespace {

constexpr size_t kMinMembers = 4;
constexpr double kMinTurnRad = 2 * std::numbers::pi / 180;
constexpr double kMaxChi2PerDof = 2;

/// How far a pose may be off an axis to be tried as a member.
struct Tolerance {
  double mm, rad;
};
constexpr Tolerance kStrict = {0.5, 2e-3}, kGenerous = {3, 2e-2};

struct Axis {
  Eigen::Vector3d direction, point;
};

/// The axis of the rigid motion from one pose to another, through the point nearest to the first's
/// origin. No answer for a motion that hardly turns.
std::optional<Axis> AxisBetween(const Pose& from, const Pose& to) {
  const Pose motion = to * from.Inverse();
  const Eigen::AngleAxisd turn(motion.rotation);
  if (!(turn.angle() > kMinTurnRad)) return std::nullopt;
  // What of the motion lies across the axis: (I - R) point = translation across.
  const Eigen::Vector3d& d = turn.axis();
  const Eigen::Vector3d across = motion.translation - d * d.dot(motion.translation);
  const Eigen::Vector3d half = (across + d.cross(across) / std::tan(turn.angle() / 2)) / 2;
  const Eigen::Vector3d point = half + d * d.dot(from.translation - half);
  if (!point.allFinite()) return std::nullopt;
  return Axis{d, point};
}

/// Angle by which `from` is turned about the axis to come nearest to `to`.
double AngleBetween(const Axis& axis, const Pose& from, const Pose& to) {
  const AxisFrame across(axis.direction);
  const Eigen::Matrix3d turn = to.rotation * from.rotation.transpose();
  const Eigen::Vector3d turned = turn * across.u;
  return std::atan2(turned.dot(across.v), turned.dot(across.u));
}

Pose TurnAbout(const Axis& axis, double angle, const Pose& pose) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis.direction).toRotationMatrix();
  return {turn * pose.rotation, turn * (pose.translation - axis.point) + axis.point};
}

bool Joins(const Axis& axis, const Pose& base, const Pose& pose, const Tolerance& tolerance) {
  const Pose put = TurnAbout(axis, AngleBetween(axis, base, pose), base);
  return (put.translation - pose.translation).norm() <= tolerance.mm &&
         RotationAngle(put.rotation, pose.rotation) <= tolerance.rad;
}

TurntableRun ProposeRun(const std::vector<PoseEstimate>& poses, const std::vector<int>& free,
                        const Tolerance& tolerance) {
  TurntableRun best;
  for (size_t a = 0; a < free.size(); ++a) {
    for (size_t b = a + 1; b < free.size(); ++b) {
      const Pose& base = poses[static_cast<size_t>(free[a])].camera_from_world;
      const auto axis = AxisBetween(base, poses[static_cast<size_t>(free[b])].camera_from_world);
      if (!axis) continue;
      TurntableRun run;
      run.direction = axis->direction;
      run.point = axis->point;
      run.base = base;
      for (size_t c = a; c < free.size(); ++c) {
        const Pose& pose = poses[static_cast<size_t>(free[c])].camera_from_world;
        if (!Joins(*axis, base, pose, tolerance)) continue;
        run.members.push_back(free[c]);
        run.angles.push_back(AngleBetween(*axis, base, pose));
      }
      if (run.members.size() > best.members.size()) best = run;
    }
  }
  return best;
}

Eigen::Matrix<double, 6, 6> WithPlay(const Eigen::Matrix<double, 6, 6>& covariance,
                                     const TurntableRun& run) {
  Eigen::Matrix<double, 6, 6> sum = covariance;
  sum.diagonal().head<3>().array() += run.play_rad * run.play_rad;
  sum.diagonal().tail<3>().array() += run.play_mm * run.play_mm;
  return sum;
}

/// Fits axis, base and angles to the members' poses.
TurntableRun FitRun(TurntableRun run, const std::vector<PoseEstimate>& poses) {
  RunParameters unknowns{{0, 0, 0, 0}, PackPose(run.base), run.angles};
  std::vector<PoseParameters> members;
  for (int m : run.members) {
    members.push_back(PackPose(poses[static_cast<size_t>(m)].camera_from_world));
  }
  ceres::Problem problem;
  for (size_t m = 0; m < members.size(); ++m) {
    const PoseEstimate& pose = poses[static_cast<size_t>(run.members[m])];
    auto* residual =
        new TurntableResidual{pose.camera_from_world.rotation, run.base.rotation, run.direction,
                              run.point, WhitenPose(WithPlay(pose.covariance, run))};
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<TurntableResidual, 6, 6, 4, 6, 1>(residual), nullptr,
        members[m].data(), unknowns.axis.data(), unknowns.base.data(), &unknowns.angles[m]);
    problem.SetParameterBlockConstant(members[m].data());
  }
  problem.SetParameterBlockConstant(unknowns.angles.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  SilenceSolverLog();
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  const AxisFrame across(run.direction);
  const Eigen::Vector3d point =
      run.point + unknowns.axis[2] * across.u + unknowns.axis[3] * across.v;
  run.direction =
      (run.direction + unknowns.axis[0] * across.u + unknowns.axis[1] * across.v).normalized();
  run.base = UnpackPose(run.base, unknowns.base);
  run.point = point + run.direction * run.direction.dot(run.base.translation - point);
  run.angles = unknowns.angles;
  // Six a member, less base, axis and the other members' angles.
  const double dof =
      6.0 * static_cast<double>(members.size()) - (6 + 4 + static_cast<double>(members.size()) - 1);
  run.chi2_per_dof = 2 * summary.final_cost / dof;
  double sum = 0;
  for (size_t m = 0; m < members.size(); ++m) {
    const Pose put = TurnAbout({run.direction, run.point}, run.angles[m], run.base);
    const Pose& pose = poses[static_cast<size_t>(run.members[m])].camera_from_world;
    sum += (put.translation - pose.translation).squaredNorm();
  }
  run.rms_mm = std::sqrt(sum / static_cast<double>(members.size()));
  return run;
}

}  // namespace

std::vector<TurntableRun> FindTurntableRuns(const std::vector<PoseEstimate>& poses,
                                            TurntableUse use) {
  std::vector<TurntableRun> runs;
  if (use == TurntableUse::kOff) return runs;
  std::vector<int> free;
  for (size_t i = 0; i < poses.size(); ++i) free.push_back(static_cast<int>(i));
  while (free.size() >= kMinMembers) {
    TurntableRun run = ProposeRun(poses, free, use == TurntableUse::kOn ? kGenerous : kStrict);
    if (run.members.size() < kMinMembers) break;
    run = FitRun(std::move(run), poses);
    std::erase_if(free, [&](int i) {
      return std::find(run.members.begin(), run.members.end(), i) != run.members.end();
    });
    const bool stands = use == TurntableUse::kOn || run.chi2_per_dof <= kMaxChi2PerDof;
    if (stands) runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace lfm
