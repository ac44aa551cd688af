// SPDX-License-Identifier: BSD-3-Clause
// What resampling alone errs by, before any factorisation: lfm-bench-resample WORK.
//
// Every third view of a triangle is left out and estimated from its other views, in the direction
// it was taken from; PSNR of sRGB-coded samples against what it shows, saturated and estimated ones
// included. Prints Markdown tables: how views are mixed, how fine the view grid is, and how many
// terms vertex rings need in the frame of the vertex and in that of reflected directions.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"
#include "resample/resample.h"
#include "resample/view_weights.h"
#include "resample_views.h"

namespace {

using lfm::bench::Mix;
using lfm::bench::MixesOf;
using lfm::bench::Object;
using lfm::bench::SquaredError;
using lfm::bench::Views;

constexpr int kStride = 5;     // of triangles
constexpr int kEveryView = 3;  // left out

float ThroughLinear(const Views& views, size_t row, const Mix& mix) {
  float value = 0;
  for (size_t k = 0; k < 3; ++k) {
    value += mix.weight[k] * lfm::LinearFromSrgb(views.At(row, mix.view[k]));
  }
  return lfm::SrgbFromLinear(value);
}

/// How a view that was left out is estimated.
struct Way {
  const char* name;
  double hull_margin;
  int grid;  // 0: the direction itself
  lfm::DirectionMap map = lfm::DirectionMap::kHemiOctahedral;
  enum Values { kCoded, kLinear, kMean } values = kCoded;
};
const double kMargin = lfm::ResampleOptions{}.hull_margin;
const std::vector<Way> kWays = {
    {"Delaunay, outside the hull its nearest point", 0, 0},
    {"hull drawn in by 0.04", 0.04, 0},
    {"0.08", 0.08, 0},
    {"0.12", 0.12, 0},
    {"0.16", 0.16, 0},
    {"default, linear values", kMargin, 0, lfm::DirectionMap::kHemiOctahedral, Way::kLinear},
    {"the mean view", kMargin, 0, lfm::DirectionMap::kHemiOctahedral, Way::kMean},
    {"default, grid 8", kMargin, 8},
    {"grid 12", kMargin, 12},
    {"grid 16", kMargin, 16},
    {"grid 24", kMargin, 24},
    {"grid 32", kMargin, 32},
    {"grid 48", kMargin, 48},
    {"grid 64", kMargin, 64},
    {"default, grid 32, orthographic disc", kMargin, 32, lfm::DirectionMap::kOrthographic},
};

/// Mixes and their weights: one, or those of four grid directions.
using Taps = std::vector<std::pair<float, Mix>>;

Taps TapsOf(const Way& way, const Eigen::Vector3d& direction,
            const std::vector<Eigen::Vector3d>& in_frame, std::span<const size_t> from) {
  std::vector<Eigen::Vector2d> plane, queries;
  for (const Eigen::Vector3d& d : in_frame) plane.push_back(lfm::PlaneFromDirection(way.map, d));
  std::vector<float> weights;
  if (way.grid == 0) {
    queries = {lfm::PlaneFromDirection(way.map, direction)};
    weights = {1};
  } else {
    const Eigen::Vector2d place = lfm::SquareFromDirection(way.map, direction) * (way.grid - 1);
    const int x = std::min(static_cast<int>(place.x()), way.grid - 2);
    const int y = std::min(static_cast<int>(place.y()), way.grid - 2);
    const auto fx = static_cast<float>(place.x() - x), fy = static_cast<float>(place.y() - y);
    for (int k = 0; k < 4; ++k) {
      const int q = (y + k / 2) * way.grid + x + k % 2;
      queries.push_back(lfm::PlaneFromDirection(way.map, lfm::GridDirection(way.map, way.grid, q)));
    }
    weights = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  }
  const std::vector<Mix> mixes = MixesOf(plane, from, queries, way.hull_margin);
  Taps taps;
  for (size_t k = 0; k < mixes.size(); ++k) taps.emplace_back(weights[k], mixes[k]);
  return taps;
}

float ValueOf(const Way& way, const Taps& taps, const Views& views, size_t row,
              std::span<const size_t> from) {
  float value = 0;
  if (way.values == Way::kMean) {
    for (const size_t v : from) value += views.At(row, v) / static_cast<float>(from.size());
    return value;
  }
  for (const auto& [weight, mix] : taps) {
    value += weight * (way.values == Way::kLinear ? ThroughLinear(views, row, mix)
                                                  : lfm::bench::Coded(views, row, mix));
  }
  return value;
}

struct Sums {
  // A way each: inside the hull of the other views, outside it, and beyond 70 degrees of the
  // normal.
  std::vector<std::array<SquaredError, 3>> errors =
      std::vector<std::array<SquaredError, 3>>(kWays.size());
  double directions = 0, below_horizon = 0;  // of a corner's views

  void Add(const Sums& other) {
    for (size_t w = 0; w < kWays.size(); ++w) {
      for (size_t i = 0; i < 3; ++i) errors[w][i].Add(other.errors[w][i]);
    }
    directions += other.directions;
    below_horizon += other.below_horizon;
  }
};

void LeaveOut(const Views& views, size_t left_out, const std::vector<Eigen::Vector3d>& in_frame,
              Sums& sums) {
  constexpr double kCosineOf70 = 0.342;
  std::vector<size_t> from;
  for (size_t v = 0; v < in_frame.size(); ++v) {
    if (v != left_out) from.push_back(v);
  }
  const Eigen::Vector3d& direction = in_frame[left_out];
  const bool seen = TapsOf(kWays[0], direction, in_frame, from).front().second.seen;
  for (size_t w = 0; w < kWays.size(); ++w) {
    const Taps taps = TapsOf(kWays[w], direction, in_frame, from);
    SquaredError error;
    for (size_t row = 0; row < views.rows(); ++row) {
      error.Add(ValueOf(kWays[w], taps, views, row, from) - views.At(row, left_out));
    }
    sums.errors[w][seen ? 0 : 1].Add(error);
    if (direction.z() < kCosineOf70) sums.errors[w][2].Add(error);
  }
}

Sums AskTriangle(const Object& object, int triangle) {
  Sums sums;
  const Views views = lfm::bench::ViewsOf(object, triangle);
  if (views.patch.photos.size() < lfm::bench::kLeastViews) return sums;
  const Eigen::Vector3i& corners = object.field.mesh().triangles[static_cast<size_t>(triangle)];
  for (int c = 0; c < 3; ++c) {
    const Eigen::Matrix3d& frame = object.field.vertex_frames()[static_cast<size_t>(corners[c])];
    std::vector<Eigen::Vector3d> in_frame;
    for (const Eigen::Vector3d& d : views.to_eye) {
      in_frame.push_back(frame.transpose() * d);
      sums.directions += 1;
      sums.below_horizon += in_frame.back().z() < 0 ? 1 : 0;
    }
    if (c != triangle % 3) continue;
    for (size_t v = 0; v < in_frame.size(); ++v) {
      // By photograph: the same views whatever the options of resampling.
      if ((views.patch.photos[v] + triangle) % kEveryView == 0) LeaveOut(views, v, in_frame, sums);
    }
  }
  return sums;
}

void Run(const std::filesystem::path& work) {
  const Object object = lfm::bench::LoadObject(work);
  const int64_t count = object.field.triangle_count() / kStride;
  std::vector<Sums> sums(static_cast<size_t>(count));
  lfm::ParallelFor(0, count, [&](int64_t i) {
    sums[static_cast<size_t>(i)] = AskTriangle(object, static_cast<int>(i * kStride));
  });
  Sums total;
  for (const Sums& s : sums) total.Add(s);
  std::printf(
      "views below a corner's horizon: %.2f %%; left-out samples outside the hull of the "
      "others: %.1f %%\n\n",
      100 * total.below_horizon / total.directions,
      100 * total.errors[0][1].count / (total.errors[0][0].count + total.errors[0][1].count));
  std::printf("| way | all | inside | outside | beyond 70° |\n|---|---|---|---|---|\n");
  for (size_t w = 0; w < kWays.size(); ++w) {
    SquaredError all = total.errors[w][0];
    all.Add(total.errors[w][1]);
    std::printf("| %s | %.2f | %.2f | %.2f | %.2f |\n", kWays[w].name, all.PsnrDb(),
                total.errors[w][0].PsnrDb(), total.errors[w][1].PsnrDb(),
                total.errors[w][2].PsnrDb());
  }
  std::fflush(stdout);
  lfm::bench::PrintTerms(object);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: lfm-bench-resample WORK\n");
    return 2;
  }
  try {
    Run(argv[1]);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-resample: %s\n", error.what());
    return 2;
  }
}
