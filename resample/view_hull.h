// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "resample/view_triangulation.h"

namespace lfm {

/// The convex hull of views in their plane, and the same hull drawn in towards the mean of the
/// views by a share of itself.
///
/// The faces along a hull are slivers between views that lie far apart, often the flattest and
/// coarsest ones; just inside, three near views meet.
class ViewHull {
 public:
  /// `triangulation` is that of `views`; `margin` in [0, 1). Views on one line have no inside: they
  /// contain nothing and draw nothing in.
  ViewHull(std::span<const Eigen::Vector2d> views, const ViewTriangulation& triangulation,
           double margin);

  /// Whether a point lies in the hull, or outside it by no more than 1e-9.
  bool Contains(const Eigen::Vector2d& point) const;
  /// The nearest point of the hull drawn in: the point itself inside it. Continuous.
  Eigen::Vector2d DrawIn(const Eigen::Vector2d& point) const;

 private:
  struct Edge {
    Eigen::Vector2d start, along;  // drawn in
    Eigen::Vector2d outwards;      // unit
    double offset, drawn_offset;   // outwards.dot(x) on the hull, and drawn in
  };
  std::vector<Edge> edges_;
};

}  // namespace lfm
