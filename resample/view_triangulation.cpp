// SPDX-License-Identifier: BSD-3-Clause
#include "resample/view_triangulation.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>

#include "core/error.h"

namespace lfm {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<int, Kernel>;
using Delaunay =
    CGAL::Delaunay_triangulation_2<Kernel,
                                   CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

void AddFaces(Delaunay& delaunay, ViewTriangulation& result) {
  for (const auto face : delaunay.all_face_handles()) face->info() = -1;
  int count = 0;
  for (const auto face : delaunay.finite_face_handles()) face->info() = count++;
  result.faces.reserve(static_cast<size_t>(count));
  for (const auto face : delaunay.finite_face_handles()) {
    ViewTriangulation::Face added;
    for (int k = 0; k < 3; ++k) {
      added.views[static_cast<size_t>(k)] = face->vertex(k)->info();
      added.neighbors[static_cast<size_t>(k)] = face->neighbor(k)->info();
    }
    for (size_t k = 0; k < 3; ++k) {
      if (added.neighbors[k] < 0) {
        result.hull.push_back({added.views[(k + 1) % 3], added.views[(k + 2) % 3]});
      }
    }
    result.faces.push_back(added);
  }
}

/// Points on one line: sorted along it, which is the lexicographic order of their coordinates.
void AddChain(std::span<const Eigen::Vector2d> points, ViewTriangulation& result) {
  std::vector<int> order = result.distinct;
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Eigen::Vector2d &p = points[static_cast<size_t>(a)], &q = points[static_cast<size_t>(b)];
    return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y();
  });
  for (size_t i = 1; i < order.size(); ++i) result.hull.push_back({order[i - 1], order[i]});
}

}  // namespace

ViewTriangulation TriangulateViews(std::span<const Eigen::Vector2d> points) {
  Delaunay delaunay;
  ViewTriangulation result;
  Delaunay::Face_handle hint;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      throw Error("view directions: a direction is not finite; check the poses of the photographs");
    }
    const size_t before = delaunay.number_of_vertices();
    const auto vertex = delaunay.insert({points[i].x(), points[i].y()}, hint);
    hint = vertex->face();
    if (delaunay.number_of_vertices() == before) continue;
    vertex->info() = static_cast<int>(i);
    result.distinct.push_back(static_cast<int>(i));
  }
  if (delaunay.dimension() == 2) {
    AddFaces(delaunay, result);
  } else {
    AddChain(points, result);
  }
  return result;
}

}  // namespace lfm
