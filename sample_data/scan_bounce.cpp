// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_bounce.h"

#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

constexpr float kSameNormal_cos = 0.906f, kSamePlane_mm = 1, kSamePlane_rel = 0.2f;
constexpr float kLeastAlbedo = 1e-3f;

bool LitAlike(const ScanGuide& pixel, const ScanGuide& other) {
  const Eigen::Vector3f step = other.point - pixel.point;
  return other.whole && other.albedo > kLeastAlbedo &&
         pixel.normal.dot(other.normal) > kSameNormal_cos &&
         std::abs(pixel.normal.dot(step)) < kSamePlane_mm + kSamePlane_rel * step.norm();
}

}  // namespace

ScanBand::ScanBand(int width_in, int first_row_in, int rows_in, int frames_in)
    : width(width_in), first_row(first_row_in), rows(rows_in), frames(frames_in) {
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(rows);
  direct.assign(pixels * static_cast<size_t>(frames), 0.0f);
  bounce.assign(direct.size(), 0.0f);
  guides.resize(pixels);
}

void ScanBand::CopyRows(const ScanBand& other) {
  const int begin = std::max(first_row, other.first_row);
  const int end = std::min(first_row + rows, other.first_row + other.rows);
  if (begin >= end) return;
  const auto copy = [](const auto& from, size_t at, size_t count, auto& to, size_t to_at) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(at), count,
                to.begin() + static_cast<std::ptrdiff_t>(to_at));
  };
  const size_t pixels = static_cast<size_t>(end - begin) * static_cast<size_t>(width);
  const size_t values = pixels * static_cast<size_t>(frames);
  copy(other.direct, other.Offset(0, begin), values, direct, Offset(0, begin));
  copy(other.bounce, other.Offset(0, begin), values, bounce, Offset(0, begin));
  copy(other.guides, other.Pixel(0, begin), pixels, guides, Pixel(0, begin));
}

void AddFilteredBounce(const ScanBand& band, int x, int y, float* out) {
  const auto frames = static_cast<size_t>(band.frames);
  const float* direct = &band.direct[band.Offset(x, y)];
  const float* own = &band.bounce[band.Offset(x, y)];
  const ScanGuide& guide = band.guides[band.Pixel(x, y)];
  if (!LitAlike(guide, guide)) {
    for (size_t f = 0; f < frames; ++f) out[f] = direct[f] + own[f];
    return;
  }
  std::fill(out, out + frames, 0.0f);
  int count = 0;
  const int top = std::max(band.first_row, y - kBounceReach);
  const int bottom = std::min(band.first_row + band.rows - 1, y + kBounceReach);
  for (int row = top; row <= bottom; ++row) {
    for (int column = std::max(0, x - kBounceReach);
         column <= std::min(band.width - 1, x + kBounceReach); ++column) {
      const ScanGuide& other = band.guides[band.Pixel(column, row)];
      if (!LitAlike(guide, other)) continue;
      const float* values = &band.bounce[band.Offset(column, row)];
      const float scale = guide.albedo / other.albedo;
      for (size_t f = 0; f < frames; ++f) out[f] += scale * values[f];
      ++count;
    }
  }
  for (size_t f = 0; f < frames; ++f) out[f] = direct[f] + out[f] / static_cast<float>(count);
}

}  // namespace lfm
