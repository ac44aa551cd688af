// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/print_sampler.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr int kCells = 4;   // along a pixel's side
constexpr int kPlaces = 3;  // along a cell's side
static_assert(kCells * kCells == kFineSamples);

// Every place has a column and a row of its own: edges along either lose nothing.
float Place(int major, int minor) {
  return (static_cast<float>(major) + (static_cast<float>(minor) + 0.5f) / kPlaces) / kPlaces;
}

}  // namespace

PrintSampler::PrintSampler(const SetReflectance& reflectance, const PixelRays& rays,
                           const Pose& camera_from_world)
    : reflectance_(reflectance),
      rays_(rays),
      world_from_camera_(camera_from_world.rotation.transpose().cast<float>()),
      eye_(camera_from_world.Center().cast<float>()) {}

V3f PrintSampler::PointAt(const Patch& patch, int x, int y, float dx, float dy) const {
  const V3f normal = patch.Normal().cast<float>();
  const V3f direction = world_from_camera_ * rays_.Direction(x, y, dx, dy);
  const float distance = normal.dot(patch.origin.cast<float>() - eye_) / normal.dot(direction);
  return eye_ + distance * direction;
}

V3f PrintSampler::CellColor(const Patch& patch, int x, int y, int cell) const {
  const auto left = static_cast<float>(cell / kCells), top = static_cast<float>(cell % kCells);
  const auto point = [&](float across, float down) {
    return PointAt(patch, x, y, (left + across) / kCells - 0.5f, (top + down) / kCells - 0.5f);
  };
  const auto exact =
      reflectance_.PrintColor(patch, {point(0, 0), point(1, 0), point(1, 1), point(0, 1)});
  if (exact) return *exact;
  V3f sum = V3f::Zero();
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < kPlaces; ++j) {
      sum += reflectance_.Color(patch, point(Place(i, j), Place(j, i)));
    }
  }
  return sum / (kPlaces * kPlaces);
}

V3f PrintSampler::PixelColor(const Patch& patch, int x, int y) const {
  V3f sum = V3f::Zero();
  for (int cell = 0; cell < kFineSamples; ++cell) sum += CellColor(patch, x, y, cell);
  return sum / kFineSamples;
}

bool PrintSampler::CornersDiffer(const Patch& patch, int x, int y) const {
  const auto color = [&](float dx, float dy) {
    return reflectance_.Color(patch, PointAt(patch, x, y, dx, dy));
  };
  const V3f first = color(-0.5f, -0.5f);
  return color(0.5f, -0.5f) != first || color(-0.5f, 0.5f) != first || color(0.5f, 0.5f) != first;
}

}  // namespace lfm
