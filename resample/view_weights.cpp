// SPDX-License-Identifier: BSD-3-Clause
#include "resample/view_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "resample/view_hull.h"
#include "resample/view_triangulation.h"

namespace lfm {
namespace {

// A query this far outside a face or the hull still counts as on it (plane and weight units).
constexpr double kOnHull_abs = 1e-9;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A face prepared for barycentric weights: weights 1 and 2 are linear in the query.
struct PreparedFace {
  Eigen::Vector2d origin, gradient_1, gradient_2;
  bool flat = false;  ///< too thin for weights computed in double precision
};

struct Mix {
  std::array<int, 3> view;
  std::array<double, 3> weight;
  bool seen = false;
};

PreparedFace PrepareFace(std::span<const Eigen::Vector2d> views,
                         const ViewTriangulation::Face& face) {
  constexpr double kFlat_rel = 1e-12;
  PreparedFace prepared;
  prepared.origin = views[static_cast<size_t>(face.views[0])];
  const Eigen::Vector2d e1 = views[static_cast<size_t>(face.views[1])] - prepared.origin;
  const Eigen::Vector2d e2 = views[static_cast<size_t>(face.views[2])] - prepared.origin;
  const double area = Cross(e1, e2);
  prepared.flat = !(area > kFlat_rel * std::max(e1.squaredNorm(), e2.squaredNorm()));
  if (prepared.flat) return prepared;
  prepared.gradient_1 = Eigen::Vector2d(e2.y(), -e2.x()) / area;
  prepared.gradient_2 = Eigen::Vector2d(-e1.y(), e1.x()) / area;
  return prepared;
}

std::array<double, 3> Barycentric(const PreparedFace& face, const Eigen::Vector2d& query) {
  const Eigen::Vector2d d = query - face.origin;
  const double w1 = face.gradient_1.dot(d), w2 = face.gradient_2.dot(d);
  return {1 - w1 - w2, w1, w2};
}

/// Weights of many queries in one triangulation; each search starts where the last one ended.
class WeightFinder {
 public:
  WeightFinder(std::span<const Eigen::Vector2d> views, const ViewTriangulation& triangulation,
               double hull_margin)
      : views_(views),
        triangulation_(triangulation),
        hull_(views, triangulation, hull_margin),
        hull_margin_(hull_margin) {
    faces_.reserve(triangulation.faces.size());
    for (const auto& face : triangulation.faces) faces_.push_back(PrepareFace(views, face));
  }

  Mix Find(const Eigen::Vector2d& query) {
    const Eigen::Vector2d drawn = hull_margin_ > 0 ? hull_.DrawIn(query) : query;
    Mix mix = FindThere(drawn);
    if (drawn != query) mix.seen = hull_.Contains(query);
    return mix;
  }

 private:
  Mix FindThere(const Eigen::Vector2d& query) {
    if (!faces_.empty()) {
      if (const auto inside = FindInside(query)) return *inside;
    }
    return NearestOnHull(query);
  }

  std::optional<Mix> FindInside(const Eigen::Vector2d& query) {
    // A walk in a Delaunay triangulation ends; rounding in thin faces may make it circle, hence
    // the bound and the exhaustive search behind it.
    size_t face = last_face_;
    for (size_t step = 0; step <= faces_.size(); ++step) {
      if (faces_[face].flat) return SearchAll(query);
      const std::array<double, 3> weight = Barycentric(faces_[face], query);
      const auto lowest = std::min_element(weight.begin(), weight.end());
      last_face_ = face;
      if (*lowest >= -kOnHull_abs) return Inside(face, weight);
      const auto edge = static_cast<size_t>(lowest - weight.begin());
      const int next = triangulation_.faces[face].neighbors[edge];
      if (next < 0) return std::nullopt;  // beyond the line of one hull edge: outside the hull
      face = static_cast<size_t>(next);
    }
    return SearchAll(query);
  }

  std::optional<Mix> SearchAll(const Eigen::Vector2d& query) {
    constexpr double kBetweenFaces_abs = 1e-6;
    size_t best_face = 0;
    double best_lowest = -HUGE_VAL;
    for (size_t face = 0; face < faces_.size(); ++face) {
      if (faces_[face].flat) continue;
      const std::array<double, 3> weight = Barycentric(faces_[face], query);
      const double lowest = *std::min_element(weight.begin(), weight.end());
      if (lowest > best_lowest) {
        best_lowest = lowest;
        best_face = face;
      }
    }
    if (best_lowest < -kBetweenFaces_abs) return std::nullopt;
    last_face_ = best_face;
    return Inside(best_face, Barycentric(faces_[best_face], query));
  }

  Mix Inside(size_t face, std::array<double, 3> weight) const {
    double sum = 0;
    for (double& w : weight) sum += w = std::max(0.0, w);
    for (double& w : weight) w /= sum;
    return {triangulation_.faces[face].views, weight, true};
  }

  Mix NearestOnHull(const Eigen::Vector2d& query) const {
    const int only = triangulation_.distinct.front();
    Mix mix{{only, only, only}, {1, 0, 0}, false};
    double nearest = (query - views_[static_cast<size_t>(only)]).squaredNorm();
    for (const auto& [a, b] : triangulation_.hull) {
      const Eigen::Vector2d& start = views_[static_cast<size_t>(a)];
      const Eigen::Vector2d along = views_[static_cast<size_t>(b)] - start;
      // Different points may still be too close for their squared distance to be a number.
      const double length_squared =
          std::max(along.squaredNorm(), std::numeric_limits<double>::min());
      const double t = std::clamp((query - start).dot(along) / length_squared, 0.0, 1.0);
      const double distance = (query - start - t * along).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      mix.view = {a, b, a};
      mix.weight = {1 - t, t, 0};
    }
    mix.seen = nearest <= kOnHull_abs * kOnHull_abs;
    return mix;
  }

  std::span<const Eigen::Vector2d> views_;
  const ViewTriangulation& triangulation_;
  ViewHull hull_;
  double hull_margin_;
  std::vector<PreparedFace> faces_;
  size_t last_face_ = 0;
};

}  // namespace

Eigen::Vector2d PlaneFromDirection(DirectionMap map, const Eigen::Vector3d& direction_in_frame) {
  constexpr double kFarthest = 1e3;
  const Eigen::Vector2d xy = direction_in_frame.head<2>();
  const double z = direction_in_frame.z();
  const double radius = xy.norm();
  if (map == DirectionMap::kOrthographic) {
    if (z >= 0) return xy;
    return radius > 0 ? Eigen::Vector2d(xy * ((2 - radius) / radius)) : Eigen::Vector2d(2, 0);
  }
  // Below the horizon 1 + z = radius^2 / (1 - z) keeps its digits.
  const double scale = z >= 0 ? 1 / (1 + z) : (1 - z) / std::max(radius * radius, 1e-300);
  if (radius == 0) return z >= 0 ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(kFarthest, 0);
  return xy * std::min(scale, kFarthest / radius);
}

std::vector<Eigen::Vector2d> GridInPlane(DirectionMap map, int grid) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<size_t>(grid) * static_cast<size_t>(grid));
  for (int q = 0; q < grid * grid; ++q) {
    points.push_back(PlaneFromDirection(map, GridDirection(map, grid, q)));
  }
  return points;
}

LightField::WeightBuffer ComputeViewWeights(std::span<const Eigen::Vector2d> views,
                                            std::span<const Eigen::Vector2d> queries,
                                            double hull_margin) {
  LightField::WeightBuffer buffer;
  if (views.empty()) return buffer;
  if (views.size() > 65535) {
    throw Error("view weights: more than 65535 photographs see one triangle; use fewer");
  }
  const ViewTriangulation triangulation = TriangulateViews(views);
  WeightFinder finder(views, triangulation, hull_margin);
  buffer.view.resize(3 * queries.size());
  buffer.weight.resize(3 * queries.size());
  buffer.seen.resize(queries.size());
  for (size_t q = 0; q < queries.size(); ++q) {
    const Mix mix = finder.Find(queries[q]);
    for (size_t k = 0; k < 3; ++k) {
      buffer.view[3 * q + k] = static_cast<uint16_t>(mix.view[k]);
      buffer.weight[3 * q + k] = static_cast<float>(mix.weight[k]);
    }
    buffer.seen[q] = mix.seen ? 1 : 0;
  }
  return buffer;
}

}  // namespace lfm
