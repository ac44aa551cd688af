// SPDX-License-Identifier: BSD-3-Clause
#include "scan/world_cloud.h"

#include <algorithm>
#include <cmath>

#include "scan/uncertainty.h"

namespace lfm {
namespace {

// Nearer to the plate than this, a point is the plate's: paper and ink scatter by about half of it.
// Points that are known less well can be told from it only farther off.
constexpr double kPlateMm = 0.4, kPlateSigmas = 3;
// What faces sideways is not the plate: there it only has to be above the corner between them.
constexpr double kWallMm = 0.2, kWallCosine = 0.5;

bool StandsOnPlate(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double sigma_mm,
                   const Board& board) {
  const double least =
      normal.z() < kWallCosine ? kWallMm : std::max(kPlateMm, kPlateSigmas * sigma_mm);
  return point.z() >= least && std::abs(point.x()) <= board.width_mm / 2 &&
         std::abs(point.y()) <= board.height_mm / 2;
}

}  // namespace

PointCloud CloudFromRange(const PosedRange& scan, const Eigen::Matrix<double, 6, 6>& covariance,
                          const std::vector<Eigen::Vector2d>& rays, const Board& board) {
  PointCloud cloud;
  const Pose world_from_camera = scan.camera_from_world.Inverse();
  for (size_t p = 0; p < scan.map.depth.size(); ++p) {
    if (scan.map.depth[p] <= 0) continue;
    const Eigen::Vector3d in_camera = scan.map.depth[p] * rays[p].homogeneous();
    const Eigen::Vector3d point = world_from_camera * in_camera;
    const Eigen::Vector3d normal = scan.map.normal[p].cast<double>();
    const Eigen::Vector3d in_world = world_from_camera.rotation * normal;
    const double pose_mm2 =
        PoseVarianceMm2(covariance, in_camera - scan.camera_from_world.translation, normal);
    const double own_mm = scan.map.sigma_mm[p];
    const double sigma_mm = std::sqrt(own_mm * own_mm + pose_mm2);
    if (!StandsOnPlate(point, in_world, sigma_mm, board)) continue;
    cloud.points.push_back(point);
    cloud.normals.push_back(in_world);
    cloud.confidence.push_back(scan.map.confidence[p]);
    cloud.sigma_mm.push_back(static_cast<float>(sigma_mm));
  }
  return cloud;
}

PointCloud Concatenate(const std::vector<ScanCloud>& scans) {
  size_t total = 0;
  for (const ScanCloud& scan : scans) total += scan.cloud.points.size();
  PointCloud all;
  all.points.reserve(total);
  all.normals.reserve(total);
  all.confidence.reserve(total);
  all.sigma_mm.reserve(total);
  for (const ScanCloud& scan : scans) {
    const PointCloud& part = scan.cloud;
    all.points.insert(all.points.end(), part.points.begin(), part.points.end());
    all.normals.insert(all.normals.end(), part.normals.begin(), part.normals.end());
    all.confidence.insert(all.confidence.end(), part.confidence.begin(), part.confidence.end());
    all.sigma_mm.insert(all.sigma_mm.end(), part.sigma_mm.begin(), part.sigma_mm.end());
  }
  return all;
}

}  // namespace lfm
