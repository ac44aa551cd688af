// SPDX-License-Identifier: BSD-3-Clause
#include "scan/frame_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lfm {
namespace {

constexpr double kLeastVariance = 1e-7;
constexpr size_t kGroups = 16, kLeastGroup = 32;

/// Median of chi-square over its mean (Wilson and Hilferty).
double MedianOverMean(int freedom) {
  const double c = 1 - 2.0 / (9 * std::max(1, freedom));
  return c * c * c;
}

struct Group {
  double mean = 0, variance = 0;
};

std::vector<Group> MakeGroups(std::vector<NoiseSample>& samples, int freedom) {
  std::sort(samples.begin(), samples.end(),
            [](const NoiseSample& a, const NoiseSample& b) { return a.mean < b.mean; });
  const size_t count = std::clamp<size_t>(samples.size() / kLeastGroup, 1, kGroups);
  std::vector<Group> groups;
  for (size_t g = 0; g < count; ++g) {
    const auto begin = samples.begin() + static_cast<std::ptrdiff_t>(g * samples.size() / count);
    const auto end =
        samples.begin() + static_cast<std::ptrdiff_t>((g + 1) * samples.size() / count);
    const auto middle = begin + (end - begin) / 2;
    Group group;
    group.mean = middle->mean;
    std::nth_element(begin, middle, end, [](const NoiseSample& a, const NoiseSample& b) {
      return a.variance < b.variance;
    });
    group.variance = middle->variance / MedianOverMean(freedom);
    groups.push_back(group);
  }
  return groups;
}

}  // namespace

FrameNoise FitFrameNoise(std::vector<NoiseSample> samples, int freedom) {
  std::erase_if(samples, [](const NoiseSample& s) {
    return !std::isfinite(s.mean) || !std::isfinite(s.variance) || s.variance < 0;
  });
  if (samples.empty()) return {kLeastVariance, 0};
  // Relative residuals: bright groups would drown the dark ones.
  double w0 = 0, w1 = 0, w2 = 0, y0 = 0, y1 = 0;
  for (const Group& g : MakeGroups(samples, freedom)) {
    const double weight = 1 / std::pow(g.variance + kLeastVariance, 2);
    w0 += weight;
    w1 += weight * g.mean;
    w2 += weight * g.mean * g.mean;
    y0 += weight * g.variance;
    y1 += weight * g.mean * g.variance;
  }
  const double determinant = w0 * w2 - w1 * w1;
  FrameNoise noise{y0 / w0, 0};
  if (determinant > 1e-9 * w0 * w2) {
    const double offset = (w2 * y0 - w1 * y1) / determinant;
    const double slope = (w0 * y1 - w1 * y0) / determinant;
    if (slope > 0) noise = offset >= 0 ? FrameNoise{offset, slope} : FrameNoise{0, y1 / w2};
  }
  noise.offset = std::max(noise.offset, kLeastVariance);
  return noise;
}

}  // namespace lfm
