// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/point_fit.h"

#include <cmath>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "core/ray_scene.h"
#include "mesh/nearest_points.h"
#include "mesh/vertex_moves.h"

namespace lfm {
namespace {

constexpr int kPasses = 5;
constexpr int kNeighbors = 40;
constexpr double kReachInSigmas = 2.5, kLargestResidualInSigmas = 2;
constexpr double kLikeNormalCosine = 0.3;
// Weight of staying, in points of full confidence.
constexpr double kInertia = 0.01;
// Horizontal part of the normal, from which a vertex on the platform is the end of a wall.
constexpr double kWallShare = 0.3;

constexpr float kNoResidual = std::numeric_limits<float>::quiet_NaN();

std::vector<float> Residuals(const TriangleMesh& mesh, const PointCloud& points, double largest) {
  const RayScene scene(mesh);
  std::vector<float> residuals(points.points.size(), kNoResidual);
  ParallelFor(
      0, static_cast<int64_t>(residuals.size()),
      [&](int64_t i) {
        const auto closest = scene.Closest(points.points[i], largest);
        if (!closest) return;
        const Eigen::Vector3d normal = TriangleNormal(mesh, closest->triangle);
        if (normal.dot(points.normals[i]) < kLikeNormalCosine) return;
        residuals[i] = static_cast<float>(normal.dot(points.points[i] - closest->point));
      },
      256);
  return residuals;
}

struct WeighedPoint {
  int index = 0;
  double weight = 0;
};

// The points round each vertex. Vertices move by much less than sigma: those found once do.
std::vector<std::vector<WeighedPoint>> PointsRound(const std::vector<Eigen::Vector3d>& vertices,
                                                   const PointCloud& points, double sigma_mm) {
  const NearestPoints index(points.points);
  std::vector<std::vector<WeighedPoint>> round(vertices.size());
  ParallelFor(
      0, static_cast<int64_t>(vertices.size()),
      [&](int64_t v) {
        for (const NearPoint& near : index.Find(vertices[v], kNeighbors)) {
          if (near.distance > kReachInSigmas * sigma_mm) break;
          const double in_sigmas = near.distance / sigma_mm;
          round[v].push_back({near.index, std::sqrt(points.confidence[near.index]) *
                                              std::exp(-0.5 * in_sigmas * in_sigmas)});
        }
      },
      256);
  return round;
}

// Where vertices may move: along the normal; on the platform, where walls end, sideways.
std::vector<Eigen::Vector3d> Directions(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> directions = ComputeVertexNormals(mesh);
  for (size_t v = 0; v < directions.size(); ++v) {
    if (mesh.vertices[v].z() > 0) continue;
    directions[v].z() = 0;
    const double length = directions[v].norm();
    directions[v] = length > kWallShare ? Eigen::Vector3d(directions[v] / length)
                                        : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  return directions;
}

}  // namespace

TriangleMesh FitToPoints(const TriangleMesh& mesh, const PointCloud& points, double sigma_mm) {
  TriangleMesh fitted = mesh;
  if (points.points.empty()) return fitted;
  const auto points_round = PointsRound(fitted.vertices, points, sigma_mm);
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<float> residuals =
        Residuals(fitted, points, kLargestResidualInSigmas * sigma_mm);
    const std::vector<Eigen::Vector3d> normals = Directions(fitted);
    Eigen::VectorXd moves = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(normals.size()));
    ParallelFor(
        0, moves.size(),
        [&](int64_t v) {
          if (normals[v].isZero()) return;
          double sum = 0, weights = kInertia;
          for (const WeighedPoint& near : points_round[v]) {
            const float residual = residuals[near.index];
            if (std::isnan(residual)) continue;
            if (points.normals[near.index].dot(normals[v]) < kLikeNormalCosine) continue;
            weights += near.weight;
            sum += near.weight * residual;
          }
          moves[v] = sum / weights;
        },
        256);
    fitted.vertices = MoveWithoutFlips(fitted, normals, std::move(moves));
  }
  return fitted;
}

}  // namespace lfm
