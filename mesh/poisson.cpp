// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/poisson.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
// The octree's own headers do not stand alone: this one includes them in order.
#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <pcl/surface/impl/poisson.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "mesh/marching_cubes.h"
#include "mesh/spline_field.h"

namespace lfm {
namespace {

constexpr int kSolverDivide = 8, kFewestIterations = 8;
constexpr double kSolverAccuracy = 1e-3;
constexpr int kNodesABlock = 1 << 12;
constexpr double kMostWall = 0.1;
using Tree = pcl::poisson::Octree<2>;

pcl::PointCloud<pcl::PointNormal>::Ptr MakeCloud(const PointCloud& points,
                                                 const Eigen::Vector3d& center) {
  pcl::PointCloud<pcl::PointNormal>::Ptr cloud(new pcl::PointCloud<pcl::PointNormal>);
  cloud->reserve(points.points.size());
  for (size_t i = 0; i < points.points.size(); ++i) {
    pcl::PointNormal p;
    p.getVector3fMap() = (points.points[i] - center).cast<float>();
    p.getNormalVector3fMap() = points.normals[i].cast<float>();
    cloud->push_back(p);
  }
  return cloud;
}

// The solved function less the value at the surface, and the cube it lives in.
struct Solution {
  SplineField field;
  double iso_value = 0;
  Eigen::Vector3d low = Eigen::Vector3d::Zero();  ///< corner of the cube, about the points' middle
  double side_mm = 0;
};

// The steps of pcl::Poisson up to its extraction.
Solution Solve(const pcl::PointCloud<pcl::PointNormal>::Ptr& cloud,
               const PoissonSettings& settings) {
  static std::mutex mutex;  // PCL keeps its nodes in a static pool
  const std::lock_guard lock(mutex);
  pcl::poisson::TreeNodeData::UseIndex = 1;
  pcl::poisson::TreeOctNode::SetAllocator(kNodesABlock);
  const int least_depth = std::min(5, settings.depth);
  Tree tree;
  tree.threads = 1;
  tree.setBSplineData(settings.depth, 1.0F / static_cast<float>(1 << settings.depth), true);
  pcl::poisson::Point3D<float> low;
  float side = 1;
  low.coords[0] = low.coords[1] = low.coords[2] = 0;
  tree.setTree<pcl::PointNormal>(cloud, settings.depth, least_depth, settings.depth - 2,
                                 static_cast<float>(settings.samples_per_node),
                                 static_cast<float>(settings.cube_scale), low, side, 1,
                                 static_cast<float>(settings.point_weight), true);
  tree.ClipTree();
  tree.finalize();
  tree.RefineBoundary(kSolverDivide);
  tree.SetLaplacianConstraints();
  tree.LaplacianMatrixIteration(kSolverDivide, false, kFewestIterations, kSolverAccuracy);

  Solution solution;
  solution.iso_value = tree.GetIsoValue();
  solution.side_mm = side;
  solution.low = Eigen::Vector3d(low.coords[0], low.coords[1], low.coords[2]);
  solution.field.levels.resize(static_cast<size_t>(settings.depth) + 1);
  for (auto* node = tree.tree.nextNode(); node != nullptr; node = tree.tree.nextNode(node)) {
    int depth = 0, cell[3];
    node->depthAndOffset(depth, cell);
    if (depth < least_depth || node->nodeData.solution == 0) continue;
    solution.field.levels[depth].push_back(
        {cell[0], cell[1], cell[2], static_cast<float>(node->nodeData.solution)});
  }
  return solution;
}

// Takes the corners on the cube's walls for outside.
void CloseAtWalls(int k, int cells, std::vector<float>& values) {
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      const bool wall = std::min({x, y, k}) == 0 || std::max({x, y, k}) == cells;
      float& value = values[static_cast<size_t>(y) * (cells + 1) + x];
      if (wall) value = -std::max(std::abs(value), 1e-3F);
    }
  }
}

// Share of the surface's area that lies in the outermost cells, of what is above `from_z` cells.
double WallShare(const TriangleMesh& mesh, int cells, double from_z) {
  double wall = 0, all = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& c = mesh.triangles[t];
    const Eigen::Vector3d middle =
        (mesh.vertices[c[0]] + mesh.vertices[c[1]] + mesh.vertices[c[2]]) / 3;
    if (middle.z() < from_z) continue;
    const double area = TriangleArea(mesh, static_cast<int>(t));
    all += area;
    if (middle.minCoeff() < 1 || middle.maxCoeff() > cells - 1) wall += area;
  }
  return all > 0 ? wall / all : 0;
}

}  // namespace

TriangleMesh ReconstructPoisson(const PointCloud& points, const PoissonSettings& settings) {
  if (points.points.empty()) throw Error("reconstruction: there are no points");
  // PCL computes in float32: far from the origin that would cost digits.
  Eigen::Vector3d lowest = points.points.front(), highest = lowest;
  for (const Eigen::Vector3d& p : points.points) {
    lowest = lowest.cwiseMin(p);
    highest = highest.cwiseMax(p);
  }
  const Eigen::Vector3d center = 0.5 * (lowest + highest);
  Solution solution;
  try {
    solution = Solve(MakeCloud(points, center), settings);
  } catch (const std::exception& e) {
    throw Error(std::string("reconstruction: Poisson failed: ") + e.what(), ErrorKind::kSystem);
  }
  const float iso_value = static_cast<float>(solution.iso_value);
  const int cells = 1 << settings.depth;
  SplineLayers layers(std::move(solution.field));
  const double cell_mm = solution.side_mm / cells;
  const Eigen::Vector3d low = center + solution.low;
  TriangleMesh mesh = MarchCubes(cells, [&](int k) {
    std::vector<float> values = layers.Corners(k);
    for (float& value : values) value = iso_value - value;  // ours is positive inside
    CloseAtWalls(k, cells, values);
    return values;
  });
  const double wall_share = WallShare(mesh, cells, (settings.closed_below_mm - low.z()) / cell_mm);
  if (wall_share > kMostWall) {
    throw Error("reconstruction: the surface does not close about the points");
  }
  for (Eigen::Vector3d& v : mesh.vertices) {
    v = low + cell_mm * v;
  }
  if (mesh.triangles.empty()) {
    throw Error("reconstruction: no surface came out; do the normals point towards the scanner?");
  }
  return mesh;
}

}  // namespace lfm
