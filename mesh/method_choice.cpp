// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/method_choice.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "core/parallel.h"
#include "mesh/nearest_points.h"

namespace lfm {
namespace {

constexpr int64_t kLookedAt = 20000;
constexpr int kNeighbors = 12;
constexpr int64_t kFewestForPoisson = 500;
constexpr double kLeastAgreement = 0.75;
constexpr double kUpright = 0.7;

bool Agrees(const PointCloud& cloud, const NearestPoints& index, size_t i) {
  const std::vector<NearPoint> near = index.Find(cloud.points[i], kNeighbors + 1);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const NearPoint& n : near) mean += cloud.points[n.index];
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  int same_side = 0;
  for (const NearPoint& n : near) {
    const Eigen::Vector3d d = cloud.points[n.index] - mean;
    scatter += d * d.transpose();
    same_side += cloud.normals[n.index].dot(cloud.normals[i]) > 0;
  }
  const Eigen::Vector3d across =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  return std::abs(across.dot(cloud.normals[i])) > kUpright &&
         2 * same_side > static_cast<int>(near.size());
}

}  // namespace

const char* NameOf(SurfaceMethod method) {
  switch (method) {
    case SurfaceMethod::kPoisson:
      return "poisson";
    case SurfaceMethod::kWrap:
      return "wrap";
    default:
      return "auto";
  }
}

CloudLook LookAtCloud(const PointCloud& cloud) {
  CloudLook look;
  look.points = static_cast<int64_t>(cloud.points.size());
  if (cloud.points.empty() || cloud.normals.size() != cloud.points.size()) return look;
  const NearestPoints index(cloud.points);
  const int64_t stride = std::max<int64_t>(1, look.points / kLookedAt);
  std::vector<char> agrees((look.points + stride - 1) / stride, 0);
  ParallelFor(
      0, static_cast<int64_t>(agrees.size()),
      [&](int64_t k) { agrees[k] = Agrees(cloud, index, static_cast<size_t>(k * stride)); }, 64);
  look.normal_agreement = static_cast<double>(std::count(agrees.begin(), agrees.end(), 1)) /
                          static_cast<double>(agrees.size());
  return look;
}

MethodChoice ChooseMethod(const CloudLook& look, SurfaceMethod asked) {
  std::ostringstream reason;
  if (asked != SurfaceMethod::kAuto) {
    reason << NameOf(asked) << ": as asked";
    return {asked, reason.str()};
  }
  const auto percent = std::lround(100 * look.normal_agreement);
  if (look.points < kFewestForPoisson) {
    reason << "wrap: " << look.points << " points are too few to average over";
    return {SurfaceMethod::kWrap, reason.str()};
  }
  if (look.normal_agreement < kLeastAgreement) {
    reason << "wrap: only " << percent
           << " % of the normals agree with the points about them, and Poisson would take inside "
              "for outside";
    return {SurfaceMethod::kWrap, reason.str()};
  }
  reason << "poisson: " << percent << " % of the normals of " << look.points
         << " points agree with the points about them";
  return {SurfaceMethod::kPoisson, reason.str()};
}

}  // namespace lfm
