// SPDX-License-Identifier: BSD-3-Clause
#include "encode/patch_resolution.h"

#include <algorithm>
#include <cmath>

#include "encode/model_layout.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

template <typename T>
std::vector<T> Subsample(std::span<const T> values, int from, int to) {
  const int step = (from - 1) / (to - 1);
  std::vector<T> result(PatchSampleCount(to));
  for (int j = 0; j < to; ++j) {
    for (int i = 0; i + j < to; ++i) {
      result[PatchSampleIndex(to, i, j)] = values[PatchSampleIndex(from, step * i, step * j)];
    }
  }
  return result;
}

}  // namespace

int CoarserEdgeSamples(int n) {
  if (n <= 2) return 0;
  for (const int step : {2, 3}) {
    if ((n - 1) % step == 0) return (n - 1) / step + 1;
  }
  return 0;
}

std::vector<int> EdgeSampleLevels(int n) {
  std::vector<int> levels;
  for (; n > 0; n = CoarserEdgeSamples(n)) levels.push_back(n);
  return levels;
}

std::vector<float> SubsamplePatch(std::span<const float> values, int from, int to) {
  return Subsample(values, from, to);
}

std::vector<uint8_t> SubsamplePatch(std::span<const uint8_t> values, int from, int to) {
  return Subsample(values, from, to);
}

std::vector<float> InterpolatePatch(std::span<const float> values, int from, int to) {
  if (from == to) return {values.begin(), values.end()};
  std::vector<float> result(PatchSampleCount(to));
  const double step = static_cast<double>(from - 1) / (to - 1);
  for (int j = 0; j < to; ++j) {
    for (int i = 0; i + j < to; ++i) {
      const double x = i * step, y = std::min(j * step, from - 1 - x);
      const int a = std::min(static_cast<int>(x), from - 2);
      const int b = std::min(static_cast<int>(y), from - 2);
      const auto fx = static_cast<float>(x - a), fy = static_cast<float>(y - b);
      const auto value = [&](int di, int dj) {
        return a + di + b + dj < from ? values[PatchSampleIndex(from, a + di, b + dj)] : 0.f;
      };
      result[PatchSampleIndex(to, i, j)] =
          a + b >= from - 2 ? value(0, 0) * (1 - fx - fy) + value(1, 0) * fx + value(0, 1) * fy
                            : value(0, 0) * (1 - fx) * (1 - fy) + value(1, 0) * fx * (1 - fy) +
                                  value(0, 1) * (1 - fx) * fy + value(1, 1) * fx * fy;
    }
  }
  return result;
}

PatchMean MeanAtResolution(const LightFieldModel& model, int triangle, int n) {
  const int own = model.placements[triangle].edge_samples;
  const std::vector<uint8_t> codes = ReadMean(model, triangle);
  PatchMean mean(size_t{3} * PatchSampleCount(n));
  std::vector<float> channel(codes.size() / 3);
  for (size_t c = 0; c < 3; ++c) {
    for (size_t s = 0; s < channel.size(); ++s) {
      channel[s] = static_cast<float>(codes[3 * s + c]) / 255;
    }
    const std::vector<float> values = InterpolatePatch(channel, own, n);
    for (size_t s = 0; s < values.size(); ++s) mean[3 * s + c] = values[s];
  }
  return mean;
}

TermMaps TermAtResolution(const LightFieldModel& model, const VertexOperator& f,
                          std::span<const int> ring, int vertex, int term) {
  TermMaps maps = ReadVertexTerm(model, ring, vertex, term);
  std::vector<uint8_t> codes;
  const uint8_t* patch = maps.surface_codes.data();
  for (const RingBlock& block : f.blocks) {
    const int own = model.SurfacePlacement(term, block.triangle).edge_samples;
    const std::vector<float> values(patch, patch + PatchSampleCount(own));
    for (const float value : InterpolatePatch(values, own, block.edge_samples)) {
      codes.push_back(static_cast<uint8_t>(std::lround(value)));
    }
    patch += PatchSampleCount(own);
  }
  maps.surface_codes = std::move(codes);
  return maps;
}

}  // namespace lfm
