// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/spline_field.h"

#include <algorithm>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kDeepest = 14;

// The coarse cell beside cell z / 2 that also reaches the fine cell z.
int OtherCoarse(int z, int coarse_size) {
  return std::clamp(z / 2 + (z % 2 == 0 ? -1 : 1), 0, coarse_size - 1);
}

// Twice as many values along x and y.
std::vector<float> Refine(const std::vector<float>& coarse, int size) {
  const int fine = 2 * size;
  std::vector<float> along_x(static_cast<size_t>(fine) * size);
  for (int y = 0; y < size; ++y) {
    const float* in = &coarse[static_cast<size_t>(y) * size];
    float* out = &along_x[static_cast<size_t>(y) * fine];
    for (int x = 0; x < fine; ++x) out[x] = 0.75F * in[x / 2] + 0.25F * in[OtherCoarse(x, size)];
  }
  std::vector<float> both(static_cast<size_t>(fine) * fine);
  for (int y = 0; y < fine; ++y) {
    const float* near = &along_x[static_cast<size_t>(y / 2) * fine];
    const float* far = &along_x[static_cast<size_t>(OtherCoarse(y, size)) * fine];
    float* out = &both[static_cast<size_t>(y) * fine];
    for (int x = 0; x < fine; ++x) out[x] = 0.75F * near[x] + 0.25F * far[x];
  }
  return both;
}

}  // namespace

SplineLayers::SplineLayers(SplineField field) {
  if (field.levels.empty() || field.Depth() > kDeepest) {
    throw Error("spline field: it needs 1 to 15 levels");
  }
  levels_.resize(field.levels.size());
  for (size_t d = 0; d < levels_.size(); ++d) {
    Level& level = levels_[d];
    level.size = 1 << d;
    level.own = std::move(field.levels[d]);
    for (const auto& c : level.own) {
      if (std::min({c.x, c.y, c.z}) < 0 || std::max({c.x, c.y, c.z}) >= level.size) {
        throw Error("spline field: a cell lies outside the cube");
      }
    }
    std::stable_sort(level.own.begin(), level.own.end(),
                     [](const auto& a, const auto& b) { return a.z < b.z; });
    level.offsets.assign(static_cast<size_t>(level.size) + 1, 0);
    for (const auto& c : level.own) ++level.offsets[c.z + 1];
    for (int z = 0; z < level.size; ++z) level.offsets[z + 1] += level.offsets[z];
  }
}

const std::vector<float>& SplineLayers::Coefficients(int depth, int z) {
  Level& level = levels_[depth];
  std::vector<float>& slot = level.kept[z % 4];
  if (level.kept_z[z % 4] == z) return slot;
  if (depth == 0) {
    slot.assign(1, 0);
  } else {
    const int coarse_size = levels_[depth - 1].size;
    std::vector<float> mixed = Coefficients(depth - 1, z / 2);
    const std::vector<float>& other = Coefficients(depth - 1, OtherCoarse(z, coarse_size));
    for (size_t i = 0; i < mixed.size(); ++i) mixed[i] = 0.75F * mixed[i] + 0.25F * other[i];
    slot = Refine(mixed, coarse_size);
  }
  for (int64_t i = level.offsets[z]; i < level.offsets[z + 1]; ++i) {
    const auto& c = level.own[i];
    slot[static_cast<size_t>(c.y) * level.size + c.x] += c.value;
  }
  level.kept_z[z % 4] = z;
  return slot;
}

std::vector<float> SplineLayers::Corners(int k) {
  const int depth = static_cast<int>(levels_.size()) - 1;
  const int size = levels_[depth].size;
  const std::vector<float>& below = Coefficients(depth, std::max(k - 1, 0));
  const std::vector<float>& above = Coefficients(depth, std::min(k, size - 1));
  // At a corner each of the eight cells around weighs 1/2 along each axis.
  std::vector<float> values(static_cast<size_t>(size + 1) * (size + 1));
  std::vector<float> row(size);
  for (int y = 0; y <= size; ++y) {
    const size_t near = static_cast<size_t>(std::max(y - 1, 0)) * size;
    const size_t far = static_cast<size_t>(std::min(y, size - 1)) * size;
    for (int x = 0; x < size; ++x) {
      row[x] = below[near + x] + below[far + x] + above[near + x] + above[far + x];
    }
    float* out = &values[static_cast<size_t>(y) * (size + 1)];
    for (int x = 1; x < size; ++x) out[x] = 0.125F * (row[x - 1] + row[x]);
    out[0] = 0.25F * row[0];
    out[size] = 0.25F * row[size - 1];
  }
  return values;
}

}  // namespace lfm
