// SPDX-License-Identifier: BSD-3-Clause
#include "fields/patches.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

struct Distant {
  double distance = 0;
  int64_t point = 0;
  auto operator<=>(const Distant&) const = default;
};

void RequireAreas(const PatchAreas& areas) {
  if (areas.min_area < 1 || areas.max_area < areas.min_area || areas.steps_an_octave < 1 ||
      areas.steps_an_octave > 16) {
    throw Error("patches need 1 <= smallest area <= largest area and 1 to 16 steps an octave");
  }
}

void RequireCenter(const std::vector<uint8_t>& occupied, size_t points, int64_t center) {
  if (occupied.size() != points) {
    throw Error("patches: " + std::to_string(occupied.size()) + " marks of occupied points for " +
                std::to_string(points) + " points");
  }
  if (center < 0 || static_cast<size_t>(center) >= points || occupied[center] == 0) {
    throw Error("patches: point " + std::to_string(center) + " is not there or not occupied");
  }
}

NestedPatches Nested(std::vector<Distant> distant, int64_t center, const PatchAreas& areas) {
  std::sort(distant.begin(), distant.end());
  NestedPatches patches;
  patches.center = center;
  const double growth = std::exp2(1.0 / areas.steps_an_octave);
  const auto total = static_cast<int64_t>(distant.size());
  // A little above, so that whole octaves land on whole numbers.
  for (double area = static_cast<double>(areas.min_area);
       area <= static_cast<double>(areas.max_area) * 1.0001; area *= growth) {
    int64_t size = std::llround(area);
    if (size > total) break;
    const double ring = distant[size - 1].distance * (1 + 1e-9);
    while (size < total && distant[size].distance <= ring) ++size;
    if (patches.sizes.empty() || size > patches.sizes.back()) patches.sizes.push_back(size);
  }
  const int64_t kept = patches.sizes.empty() ? 0 : patches.sizes.back();
  for (int64_t i = 0; i < kept; ++i) patches.points.push_back(distant[i].point);
  return patches;
}

// The bits of a coordinate, spread to every third.
uint64_t Spread(uint64_t value) {
  uint64_t result = 0;
  for (int bit = 0; bit < 21; ++bit) result |= (value >> bit & 1) << (3 * bit);
  return result;
}

}  // namespace

NestedPatches PixelPatches(int width, int height, const std::vector<uint8_t>& occupied,
                           int64_t center, PatchShape shape, const PatchAreas& areas) {
  RequireAreas(areas);
  if (width < 1 || height < 1) throw Error("patches: the picture has no pixels");
  RequireCenter(occupied, static_cast<size_t>(width) * height, center);
  std::vector<Distant> distant;
  for (int64_t point = 0; point < static_cast<int64_t>(occupied.size()); ++point) {
    if (occupied[point] == 0) continue;
    const auto x = static_cast<double>(point % width - center % width);
    const auto y = static_cast<double>(point / width - center / width);
    const double distance =
        shape == PatchShape::kDisc ? std::hypot(x, y) : std::max(std::abs(x), std::abs(y));
    distant.push_back({distance, point});
  }
  return Nested(std::move(distant), center, areas);
}

NestedPatches VertexPatches(const std::vector<Eigen::Vector3f>& positions,
                            const std::vector<uint8_t>& occupied, int64_t center,
                            const PatchAreas& areas) {
  RequireAreas(areas);
  RequireCenter(occupied, positions.size(), center);
  std::vector<Distant> distant;
  for (size_t point = 0; point < positions.size(); ++point) {
    if (occupied[point] == 0) continue;
    distant.push_back({(positions[point] - positions[center]).cast<double>().norm(),
                       static_cast<int64_t>(point)});
  }
  return Nested(std::move(distant), center, areas);
}

NestedPatches GeodesicPatches(const std::vector<Eigen::Vector3f>& positions,
                              const std::vector<Eigen::Vector3i>& triangles,
                              const std::vector<uint8_t>& occupied, int64_t center,
                              const PatchAreas& areas) {
  RequireAreas(areas);
  RequireCenter(occupied, positions.size(), center);
  std::vector<std::vector<int>> neighbors(positions.size());
  for (const Eigen::Vector3i& triangle : triangles) {
    if (triangle.minCoeff() < 0 || triangle.maxCoeff() >= static_cast<int>(positions.size())) {
      throw Error("patches: a triangle names a vertex that is not there");
    }
    for (int e = 0; e < 3; ++e) {
      neighbors[triangle[e]].push_back(triangle[(e + 1) % 3]);
      neighbors[triangle[(e + 1) % 3]].push_back(triangle[e]);
    }
  }
  std::vector<double> best(positions.size(), std::numeric_limits<double>::infinity());
  std::priority_queue<Distant, std::vector<Distant>, std::greater<>> open;
  std::vector<Distant> distant;
  best[center] = 0;
  open.push({0, center});
  // What lies in the last ring is wanted whole.
  double end = std::numeric_limits<double>::infinity();
  while (!open.empty()) {
    const Distant next = open.top();
    open.pop();
    if (next.distance > best[next.point]) continue;
    if (next.distance > end) break;
    if (occupied[next.point] != 0) distant.push_back(next);
    if (static_cast<int64_t>(distant.size()) == areas.max_area + 1) {
      end = next.distance * (1 + 1e-8);
    }
    for (const int neighbor : neighbors[next.point]) {
      const double distance =
          next.distance + (positions[neighbor] - positions[next.point]).cast<double>().norm();
      if (!(distance < best[neighbor])) continue;
      best[neighbor] = distance;
      open.push({distance, neighbor});
    }
  }
  return Nested(std::move(distant), center, areas);
}

std::vector<int64_t> SpreadCenters(const std::vector<Eigen::Vector3f>& places,
                                   const std::vector<uint8_t>& occupied, int count) {
  if (occupied.size() != places.size()) {
    throw Error("centres: as many marks of occupied points are needed as points");
  }
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (size_t point = 0; point < places.size(); ++point) {
    if (occupied[point] == 0) continue;
    low = low.cwiseMin(places[point].cast<double>());
    high = high.cwiseMax(places[point].cast<double>());
  }
  std::vector<std::pair<uint64_t, int64_t>> order;
  for (size_t point = 0; point < places.size(); ++point) {
    if (occupied[point] == 0) continue;
    const double scale = std::max((high - low).maxCoeff(), 1e-300);
    uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = (places[point][axis] - low[axis]) / scale;
      code |= Spread(static_cast<uint64_t>(at * ((1 << 20) - 1))) << axis;
    }
    order.emplace_back(code, static_cast<int64_t>(point));
  }
  std::sort(order.begin(), order.end());
  std::vector<int64_t> centers;
  const auto total = static_cast<int64_t>(order.size()), wanted = std::min<int64_t>(count, total);
  for (int64_t i = 0; i < wanted; ++i) {
    centers.push_back(order[(2 * i + 1) * total / (2 * wanted)].second);
  }
  return centers;
}

}  // namespace lfm
