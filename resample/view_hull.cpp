// SPDX-License-Identifier: BSD-3-Clause
#include "resample/view_hull.h"

#include <algorithm>
#include <cmath>

namespace lfm {

ViewHull::ViewHull(std::span<const Eigen::Vector2d> views, const ViewTriangulation& triangulation,
                   double margin) {
  if (triangulation.faces.empty()) return;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const int view : triangulation.distinct) mean += views[static_cast<size_t>(view)];
  mean /= static_cast<double>(triangulation.distinct.size());
  for (const auto& [a, b] : triangulation.hull) {
    const Eigen::Vector2d start = views[static_cast<size_t>(a)] - mean;
    const Eigen::Vector2d along = views[static_cast<size_t>(b)] - mean - start;
    const double length = std::hypot(along.x(), along.y());
    if (!(length > 0)) continue;
    Eigen::Vector2d outwards = Eigen::Vector2d(along.y(), -along.x()) / length;
    double distance = outwards.dot(start);
    // The mean lies inside, whichever way round the edge runs.
    if (distance < 0) {
      outwards = -outwards;
      distance = -distance;
    }
    const double at_mean = outwards.dot(mean);
    edges_.push_back({mean + (1 - margin) * start, (1 - margin) * along, outwards,
                      at_mean + distance, at_mean + (1 - margin) * distance});
  }
}

bool ViewHull::Contains(const Eigen::Vector2d& point) const {
  constexpr double kOnHull_abs = 1e-9;
  return !edges_.empty() && std::all_of(edges_.begin(), edges_.end(), [&](const Edge& edge) {
    return edge.outwards.dot(point) <= edge.offset + kOnHull_abs;
  });
}

Eigen::Vector2d ViewHull::DrawIn(const Eigen::Vector2d& point) const {
  const bool inside = std::all_of(edges_.begin(), edges_.end(), [&](const Edge& edge) {
    return edge.outwards.dot(point) <= edge.drawn_offset;
  });
  if (inside) return point;
  Eigen::Vector2d nearest = point;
  double least = HUGE_VAL;
  for (const Edge& edge : edges_) {
    const double t =
        std::clamp((point - edge.start).dot(edge.along) / edge.along.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector2d candidate = edge.start + t * edge.along;
    const double distance = (candidate - point).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace lfm
