// SPDX-License-Identifier: BSD-3-Clause
// Includes CGAL's alpha wrapping, which is under GPL-3.
#include "mesh/alpha_wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr size_t kFewestPoints = 4;
constexpr double kLeastAlphaInSpacings = 3;
constexpr double kKeptVolume = 0.6;

TriangleMesh WrapOnce(const std::vector<Kernel::Point_3>& points, double alpha_mm,
                      double offset_mm) {
  SurfaceMesh wrap;
  try {
    CGAL::alpha_wrap_3(points, alpha_mm, offset_mm, wrap);
  } catch (const std::exception& e) {
    throw Error(std::string("reconstruction: alpha wrapping failed: ") + e.what());
  }
  TriangleMesh mesh;
  std::vector<int> index(wrap.num_vertices() + wrap.number_of_removed_vertices(), -1);
  for (const auto v : wrap.vertices()) {
    index[v.idx()] = static_cast<int>(mesh.vertices.size());
    const auto& p = wrap.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : wrap.faces()) {
    Eigen::Vector3i triangle;
    int k = 0;
    for (const auto v : wrap.vertices_around_face(wrap.halfedge(f))) {
      if (k < 3) triangle[k++] = index[v.idx()];
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

WrapResult WrapPoints(const PointCloud& cloud, double spacing_mm, double offset_mm) {
  if (cloud.points.size() < kFewestPoints) {
    throw Error("reconstruction: " + std::to_string(cloud.points.size()) +
                " points cannot be wrapped; at least 4 are needed");
  }
  std::vector<Kernel::Point_3> points;
  Eigen::Vector3d low = cloud.points.front(), high = low;
  for (const Eigen::Vector3d& p : cloud.points) {
    points.emplace_back(p.x(), p.y(), p.z());
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double least = kLeastAlphaInSpacings * spacing_mm;
  WrapResult result;
  result.alpha_mm = std::max(0.25 * (high - low).maxCoeff(), least);
  result.mesh = WrapOnce(points, result.alpha_mm, offset_mm);
  if (result.mesh.triangles.empty()) throw Error("reconstruction: the wrap holds nothing");
  while (result.alpha_mm > least) {
    const double alpha_mm = std::max(0.5 * result.alpha_mm, least);
    TriangleMesh finer = WrapOnce(points, alpha_mm, offset_mm);
    if (finer.triangles.empty() || SignedVolume(finer) < kKeptVolume * SignedVolume(result.mesh)) {
      break;
    }
    result = {std::move(finer), alpha_mm};
  }
  return result;
}

}  // namespace lfm
