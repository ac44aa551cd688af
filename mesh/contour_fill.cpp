// SPDX-License-Identifier: BSD-3-Clause
// The one file that includes CGAL, whose triangulations are under GPL-3.
#include "mesh/contour_fill.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <deque>
#include <exception>
#include <optional>

namespace lfm {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceInfo = CGAL::Triangulation_face_base_with_info_2<int, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel, FaceInfo>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_tag>;

constexpr int kUnknown = -1;

// Number of contours between each face and the outside.
void MarkNesting(Triangulation& triangulation) {
  for (const auto face : triangulation.all_face_handles()) face->info() = kUnknown;
  std::deque<Triangulation::Face_handle> open = {triangulation.infinite_face()};
  open.front()->info() = 0;
  while (!open.empty()) {
    const Triangulation::Face_handle face = open.front();
    open.pop_front();
    for (int i = 0; i < 3; ++i) {
      const Triangulation::Face_handle neighbor = face->neighbor(i);
      if (neighbor->info() != kUnknown) continue;
      // Two faces that meet in an edge of a contour are one level apart; all other ways lead to the
      // same parity.
      neighbor->info() = face->info() + (face->is_constrained(i) ? 1 : 0);
      open.push_back(neighbor);
    }
  }
}

std::optional<std::vector<Eigen::Vector3i>> Triangulate(
    const std::vector<Eigen::Vector2d>& points, const std::vector<std::vector<int>>& contours) {
  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> handles(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t before = triangulation.number_of_vertices();
    handles[i] = triangulation.insert(Kernel::Point_2(points[i].x(), points[i].y()));
    if (triangulation.number_of_vertices() == before) return std::nullopt;
    handles[i]->info() = static_cast<int>(i);
  }
  try {
    for (const std::vector<int>& contour : contours) {
      for (size_t k = 0; k < contour.size(); ++k) {
        triangulation.insert_constraint(handles[contour[k]],
                                        handles[contour[(k + 1) % contour.size()]]);
      }
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  // A point on a contour's edge splits it: the neighbour beyond the edge would not know.
  for (const std::vector<int>& contour : contours) {
    for (size_t k = 0; k < contour.size(); ++k) {
      if (!triangulation.is_edge(handles[contour[k]], handles[contour[(k + 1) % contour.size()]])) {
        return std::nullopt;
      }
    }
  }
  if (triangulation.dimension() < 2) return std::vector<Eigen::Vector3i>{};
  MarkNesting(triangulation);
  std::vector<Eigen::Vector3i> triangles;
  for (const auto face : triangulation.finite_face_handles()) {
    if (face->info() % 2 == 0) continue;
    triangles.emplace_back(face->vertex(0)->info(), face->vertex(1)->info(),
                           face->vertex(2)->info());
  }
  return triangles;
}

}  // namespace

std::vector<Eigen::Vector3i> FillContours(const std::vector<Eigen::Vector2d>& points,
                                          const std::vector<std::vector<int>>& contours) {
  if (auto triangles = Triangulate(points, contours)) return *triangles;
  std::vector<Eigen::Vector3i> fans;
  for (const std::vector<int>& contour : contours) {
    for (size_t k = 2; k < contour.size(); ++k) {
      fans.emplace_back(contour[0], contour[k - 1], contour[k]);
    }
  }
  return fans;
}

}  // namespace lfm
