// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_interpolation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace lfm {
namespace {

constexpr size_t kNearest = 24;
constexpr double kSame = 1e-9;      // distance of directions that are one
constexpr double kOnPlane = 1e-12;  // of the hull, and of weights
constexpr double kLeastVolume = 1e-9;

using Directions = std::vector<Eigen::Vector3d>;

// Numbers of the nearest different lights, nearest first.
std::vector<int> NearestLights(const Directions& to_lights, const Eigen::Vector3d& to_light) {
  std::vector<int> order(to_lights.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return (to_lights[a] - to_light).squaredNorm() < (to_lights[b] - to_light).squaredNorm();
  });
  std::vector<int> nearest;
  for (int candidate : order) {
    const bool twice = std::any_of(nearest.begin(), nearest.end(), [&](int other) {
      return (to_lights[candidate] - to_lights[other]).norm() < kSame;
    });
    if (!twice) nearest.push_back(candidate);
    if (nearest.size() == kNearest) break;
  }
  return nearest;
}

bool IsHullFace(const Directions& to_lights, const Eigen::Vector3d& normal, double height) {
  return std::none_of(to_lights.begin(), to_lights.end(),
                      [&](const Eigen::Vector3d& d) { return normal.dot(d) > height + kOnPlane; });
}

LightWeights Normalized(LightWeights weights) {
  double sum = 0;
  for (const auto& [light, weight] : weights) sum += weight;
  for (auto& [light, weight] : weights) weight /= sum;
  std::erase_if(weights, [](const auto& w) { return w.second <= 0; });
  return weights;
}

// Of the triangle of three lights, when the direction passes through it and it is a face.
LightWeights InTriangle(const Directions& all, int a, int b, int c, const Eigen::Vector3d& d) {
  Eigen::Matrix3d corners;
  corners << all[a], all[b], all[c];
  if (std::abs(corners.determinant()) < kLeastVolume) return {};
  const Eigen::Vector3d weights = corners.inverse() * d;
  if (weights.minCoeff() < -kOnPlane) return {};
  Eigen::Vector3d normal = (all[b] - all[a]).cross(all[c] - all[a]).normalized();
  if (normal.dot(all[a]) < 0) normal = -normal;
  if (!IsHullFace(all, normal, normal.dot(all[a]))) return {};
  return Normalized({{a, std::max(0.0, weights[0])},
                     {b, std::max(0.0, weights[1])},
                     {c, std::max(0.0, weights[2])}});
}

LightWeights OnNearestEdge(const Directions& all, const std::vector<int>& nearest,
                           const Eigen::Vector3d& d) {
  LightWeights best = {{nearest[0], 1}};
  double least = (all[nearest[0]] - d).squaredNorm();
  for (size_t i = 0; i < nearest.size(); ++i) {
    for (size_t j = i + 1; j < nearest.size(); ++j) {
      const Eigen::Vector3d from = all[nearest[i]], along = all[nearest[j]] - from;
      const double t = std::clamp((d - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const Eigen::Vector3d point = from + t * along;
      if (point.norm() < kSame) continue;
      const double distance = (point.normalized() - d).squaredNorm();
      if (distance >= least - kOnPlane) continue;
      least = distance;
      best = Normalized({{nearest[i], 1 - t}, {nearest[j], t}});
    }
  }
  return best;
}

}  // namespace

LightWeights NearestLight(const Directions& to_lights, const Eigen::Vector3d& to_light) {
  if (to_lights.empty()) throw Error("interpolation of lights: there is no light");
  const auto nearest = std::min_element(
      to_lights.begin(), to_lights.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return (a - to_light).squaredNorm() < (b - to_light).squaredNorm();
      });
  return {{static_cast<int>(nearest - to_lights.begin()), 1}};
}

LightWeights SphericalWeights(const Directions& to_lights, const Eigen::Vector3d& to_light) {
  if (to_lights.empty()) throw Error("interpolation of lights: there is no light");
  const std::vector<int> nearest = NearestLights(to_lights, to_light);
  if ((to_lights[nearest[0]] - to_light).norm() < kSame) return {{nearest[0], 1}};
  for (size_t k = 2; k < nearest.size(); ++k) {
    for (size_t j = 1; j < k; ++j) {
      for (size_t i = 0; i < j; ++i) {
        LightWeights weights = InTriangle(to_lights, nearest[i], nearest[j], nearest[k], to_light);
        if (!weights.empty()) return weights;
      }
    }
  }
  return OnNearestEdge(to_lights, nearest, to_light);
}

}  // namespace lfm
