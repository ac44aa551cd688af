// SPDX-License-Identifier: BSD-3-Clause
#include "scan/gray_decoding.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scan/cell_edges.h"
#include "scan/frame_noise.h"
#include "scan/gray_kernel.h"

namespace lfm {
namespace {

using kernels::GrayInterval;
using kernels::GrayNoise;
using kernels::GrayPlaces;
using kernels::GrayPlacing;
using kernels::GrayPlanes;
using kernels::GrayReading;
using kernels::kGrayBlock;
using kernels::kGrayIntervals;

constexpr size_t kSampleBlocks = 32;
constexpr size_t kNoiseStride = 16;
// (o + f) / direct light is 2 / w for a pixel that averages over w cells: above this, w < 2.2.
constexpr double kLeastMeanStrength = 0.9;
constexpr double kPriorPixels = 64;
// Part of a cell in which pixels look alike, beyond which edges are looked for in neighbours.
constexpr double kWidePart = 0.15;
// Steps between neighbours that are steeper than this many projector pixels belong to no surface.
constexpr int kMaxStepPx = 4;

/// Frames of an axis as the kernel wants them, finest bit first.
template <typename T>
struct AxisPlanes {
  const T* white = nullptr;
  const T* black = nullptr;
  std::vector<const T*> pattern, inverse;
  std::vector<std::vector<float>> owned;
  bool measured_inverses = true;

  GrayPlanes<T> Kernel(int left_out) const {
    return {white, black, pattern.data() + left_out, inverse.data() + left_out,
            static_cast<int>(pattern.size()) - left_out};
  }
};

AxisPlanes<uint8_t> BytePlanes(const FramePlanes& planes, const AxisFrames& frames, int white,
                               int black) {
  AxisPlanes<uint8_t> out;
  out.white = planes[white].bytes;
  out.black = planes[black].bytes;
  for (size_t i = frames.gray.size(); i-- > 0;) {
    out.pattern.push_back(planes[frames.gray[i]].bytes);
    out.inverse.push_back(planes[frames.inverse[i]].bytes);
  }
  return out;
}

bool AllBytes(const FramePlanes& planes, const AxisFrames& frames, int white, int black) {
  if (white < 0 || black < 0 || !frames.HasAllInverses()) return false;
  bool bytes = planes[white].bytes != nullptr && planes[black].bytes != nullptr;
  for (size_t i = 0; i < frames.gray.size(); ++i) {
    bytes = bytes && planes[frames.gray[i]].bytes && planes[frames.inverse[i]].bytes;
  }
  return bytes;
}

/// `saturated` is set where a frame's byte is at its ceiling.
AxisPlanes<float> FloatPlanes(const FramePlanes& planes, const AxisFrames& frames,
                              const PixelLight& light, std::vector<uint8_t>& saturated) {
  AxisPlanes<float> out;
  const size_t pixels = planes.pixels();
  out.owned.reserve(2 * frames.gray.size() + 1);
  out.white = light.white.data();
  std::vector<float>& black = out.owned.emplace_back(pixels);
  for (size_t p = 0; p < pixels; ++p) black[p] = light.white[p] - light.contrast[p];
  out.black = black.data();
  const auto read = [&](int frame) {
    out.owned.emplace_back(pixels);
    planes.ReadLinear(frame, 0, pixels, out.owned.back().data(), saturated.data());
    return out.owned.back().data();
  };
  const auto opposite = [&](const float* of) {
    std::vector<float>& values = out.owned.emplace_back(pixels);
    for (size_t p = 0; p < pixels; ++p) values[p] = out.white[p] + out.black[p] - of[p];
    return values.data();
  };
  for (size_t i = frames.gray.size(); i-- > 0;) {
    const float* pattern = frames.gray[i] >= 0 ? read(frames.gray[i]) : nullptr;
    const float* inverse = frames.inverse[i] >= 0 ? read(frames.inverse[i]) : nullptr;
    out.measured_inverses = out.measured_inverses && pattern && inverse;
    out.pattern.push_back(pattern ? pattern : opposite(inverse));
    out.inverse.push_back(inverse ? inverse : opposite(pattern));
  }
  return out;
}

/// Bytes by the table of levels, floats as they are.
struct LinearValue {
  const float* levels = LinearOfLevels();
  float operator()(uint8_t level) const { return levels[level]; }
  float operator()(float value) const { return value; }
};

/// Pattern + inverse is the same for all bits but for noise.
template <typename T>
NoiseSample PairNoise(const AxisPlanes<T>& planes, size_t p) {
  const double bits = static_cast<double>(planes.pattern.size());
  const LinearValue linear;
  double sum = 0, squares = 0;
  const double center = linear(planes.pattern[0][p]) + linear(planes.inverse[0][p]);
  for (size_t i = 0; i < planes.pattern.size(); ++i) {
    const double v = linear(planes.pattern[i][p]) + linear(planes.inverse[i][p]) - center;
    sum += v;
    squares += v * v;
  }
  const double variance = std::max(0.0, squares - sum * sum / bits) / std::max(1.0, bits - 1);
  return {static_cast<float>((center + sum / bits) / 2), static_cast<float>(variance / 2)};
}

/// A frame without inverse is white or black but near its edges; the median leaves those out. One
/// pixel speaks for bright frames, the next for dark ones.
template <typename T>
NoiseSample LitNoise(const AxisPlanes<T>& planes, size_t p) {
  std::array<float, 32> squares{};
  size_t count = 0;
  const LinearValue linear;
  const float white = linear(planes.white[p]), black = linear(planes.black[p]);
  const bool bright = (p / kNoiseStride) % 2 == 0;
  const float level = bright ? white : black;
  // Most pixels see an edge of the finest bits.
  for (size_t i = planes.pattern.size() > 4 ? 2 : 0; i < planes.pattern.size(); ++i) {
    const float v = linear(planes.pattern[i][p]);
    if ((2 * v > white + black) == bright) squares[count++] = (v - level) * (v - level) / 2;
  }
  if (count == 0) return {level, NAN};
  std::nth_element(squares.begin(), squares.begin() + count / 2, squares.begin() + count);
  return {level, squares[count / 2]};
}

/// Blocks that stand for all: evenly spread pairs, since far places of forty frames are slow to
/// come.
std::vector<size_t> SampleBlocks(size_t pixels) {
  const size_t blocks = (pixels + kGrayBlock - 1) / kGrayBlock;
  std::vector<size_t> begins;
  for (size_t i = 0; i < std::min(blocks, kSampleBlocks); ++i) {
    const size_t pair = (2 * (i / 2) + 1) * blocks / kSampleBlocks;
    begins.push_back((blocks > kSampleBlocks ? pair + i % 2 : i) * kGrayBlock);
  }
  return begins;
}

/// Lets a block's pixels come while another is looked at.
template <typename T>
void Fetch(const AxisPlanes<T>& planes, size_t begin, size_t pixels) {
  const size_t end = std::min(begin + kGrayBlock, pixels);
  for (size_t p = begin; p < end; p += 64 / sizeof(T)) {
    for (const T* frame : planes.pattern) __builtin_prefetch(frame + p);
    for (const T* frame : planes.inverse) __builtin_prefetch(frame + p);
  }
}

template <typename T>
GrayNoise EstimateNoise(const AxisPlanes<T>& planes, const std::vector<uint8_t>& usable) {
  std::vector<NoiseSample> samples;
  const std::vector<size_t> begins = SampleBlocks(usable.size());
  for (size_t i = 0; i < begins.size(); ++i) {
    if (i + 1 < begins.size()) Fetch(planes, begins[i + 1], usable.size());
    const size_t begin = begins[i], end = std::min(begin + kGrayBlock, usable.size());
    for (size_t p = begin; p < end; p += kNoiseStride) {
      if (!usable[p]) continue;
      samples.push_back(planes.measured_inverses ? PairNoise(planes, p) : LitNoise(planes, p));
    }
  }
  const int bits = static_cast<int>(planes.pattern.size());
  const FrameNoise noise =
      FitFrameNoise(std::move(samples), planes.measured_inverses ? std::max(1, bits - 1) : 1);
  GrayNoise out{static_cast<float>(noise.offset), static_cast<float>(noise.slope), 2, 0, 1};
  // p - (white + black - p): twice one frame's noise and once white's and black's.
  if (!planes.measured_inverses) out = {out.offset, out.slope, 6, 4, 1};
  return out;
}

/// How the pixels of the sample blocks lie in their cells.
struct CellStatistics {
  double mean_strength = 0, pixels = 0;
  std::array<double, kGrayIntervals> histogram{};
};

template <typename T>
CellStatistics SampleCells(const AxisPlanes<T>& planes, int left_out, const GrayNoise& noise,
                           const PixelLight& light, const GrayPlacing& placing) {
  CellStatistics statistics;
  GrayReading reading;
  for (size_t begin : SampleBlocks(light.usable.size())) {
    const size_t count = std::min<size_t>(kGrayBlock, light.usable.size() - begin);
    kernels::ReadGray(planes.Kernel(left_out), noise, &light.contrast[begin],
                      static_cast<long>(begin), static_cast<int>(count), reading);
    for (size_t i = 0; i < count; ++i) {
      const bool good = light.usable[begin + i] && reading.fit[i] && reading.strength[i] > 0 &&
                        reading.weakest[i] >= placing.min_weakest &&
                        reading.direct[i] >= placing.min_direct;
      if (!good) continue;
      const float at = 0.5F * kGrayIntervals * (std::clamp(reading.balance[i], -1.0F, 1.0F) + 1);
      const int interval = std::min(kGrayIntervals - 1, static_cast<int>(at));
      statistics.histogram[static_cast<size_t>(interval)] += 1;
      statistics.pixels += 1;
      statistics.mean_strength += std::min(reading.strength[i] / reading.direct[i], 2.0F);
    }
  }
  statistics.mean_strength /= std::max(1.0, statistics.pixels);
  return statistics;
}

/// Fills in the places; returns the widest part of a cell in which pixels look alike.
double EqualizePlaces(const CellStatistics& statistics, GrayPlacing& placing) {
  constexpr double kWidth = 2.0 / kGrayIntervals;
  std::array<double, kGrayIntervals> mass{};
  for (size_t i = 0; i < mass.size(); ++i) {
    mass[i] = (statistics.histogram[i] + kPriorPixels / kGrayIntervals) /
              (statistics.pixels + kPriorPixels);
  }
  double before = 0, widest = 0;
  GrayInterval intervals[kGrayIntervals];
  for (size_t i = 0; i < mass.size(); ++i) {
    const double left = mass[i == 0 ? 1 : i - 1];
    const double right = mass[i + 1 == mass.size() ? i - 1 : i + 1];
    // What exceeds the neighbours twice over is a place without an edge: all its pixels alike.
    const double even = std::min(mass[i], left + right);
    const double alike = mass[i] - even;
    GrayInterval& interval = intervals[i];
    interval.place = static_cast<float>(before + alike / 2);
    interval.slope = static_cast<float>(even / kWidth);
    // The shares themselves are counted; even phases count far better than chance.
    interval.spread = static_cast<float>(alike * alike / 12 + 0.05 / (statistics.pixels + 1));
    before += mass[i];
    widest = std::max(widest, alike);
  }
  kernels::SetIntervals(intervals, placing);
  return widest;
}

/// Appends block by block and rejects islands as rows become whole, so that memory is written once.
template <typename T>
void PlaceAll(const AxisPlanes<T>& planes, int left_out, const GrayNoise& noise,
              const PixelLight& light, const GrayPlacing& placing, int width,
              AxisCoordinates& out) {
  const size_t pixels = light.usable.size();
  out.position.reserve(pixels);
  out.sigma.reserve(pixels);
  out.confidence.reserve(pixels);
  const long height = static_cast<long>(pixels) / width;
  const kernels::GrayRaster raster{width, height, out.position.data(), out.sigma.data(),
                                   out.confidence.data()};
  const float reach = std::max<float>(kMaxStepPx, 2 * placing.cell_px);
  std::vector<int32_t> kept(2 * static_cast<size_t>(width));
  long compared = 0;
  GrayPlaces places;
  for (size_t begin = 0; begin < pixels; begin += kGrayBlock) {
    const size_t count = std::min<size_t>(kGrayBlock, pixels - begin);
    // What will be written comes while it is computed.
    for (size_t i = begin; i < begin + count; i += 64 / sizeof(float)) {
      __builtin_prefetch(raster.position + i, 1);
      __builtin_prefetch(raster.sigma + i, 1);
      __builtin_prefetch(raster.confidence + i, 1);
    }
    kernels::DecodeGray(planes.Kernel(left_out), noise, placing, &light.contrast[begin],
                        &light.usable[begin], static_cast<long>(begin), static_cast<int>(count),
                        places);
    out.position.insert(out.position.end(), places.position, places.position + count);
    out.sigma.insert(out.sigma.end(), places.sigma, places.sigma + count);
    out.confidence.insert(out.confidence.end(), places.confidence, places.confidence + count);
    // A row is compared once the next is there, too.
    const long rows = static_cast<long>(begin + count) / width;
    const long comparable = rows == height ? height + 1 : std::max(compared, rows - 1);
    kernels::RejectIslands(raster, compared, comparable, reach, kept.data());
    compared = comparable;
  }
}

template <typename T>
AxisCoordinates DecodePlanes(const FramePlanes& planes, const AxisPlanes<T>& axis_planes,
                             const AxisFrames& frames, PatternAxis axis, const PixelLight& light,
                             const DecodeOptions& options) {
  AxisCoordinates out;
  GrayPlacing placing{};
  placing.size = frames.size;
  placing.min_weakest = placing.min_strength = placing.min_direct =
      static_cast<float>(options.min_modulation);
  const GrayNoise noise = EstimateNoise(axis_planes, light.usable);
  const int bits = static_cast<int>(axis_planes.pattern.size());
  int left_out = 0;
  CellStatistics statistics = SampleCells(axis_planes, 0, noise, light, placing);
  while (statistics.mean_strength < kLeastMeanStrength && left_out + 3 < bits) {
    const CellStatistics next = SampleCells(axis_planes, left_out + 1, noise, light, placing);
    if (!(next.mean_strength > statistics.mean_strength)) break;
    statistics = next;
    ++left_out;
  }
  placing.cell_px = static_cast<float>(frames.CellPx() << left_out);
  const double widest = EqualizePlaces(statistics, placing);

  PlaceAll(axis_planes, left_out, noise, light, placing, planes.width(), out);
  if (widest > kWidePart) {
    InterpolateBetweenEdges(planes.width(), planes.height(), placing.cell_px, axis, out);
  }
  return out;
}

}  // namespace

AxisCoordinates DecodeGrayAxis(const FramePlanes& planes, const AxisFrames& frames,
                               PatternAxis axis, int white_frame, int black_frame,
                               const PixelLight& light, const DecodeOptions& options) {
  if (AllBytes(planes, frames, white_frame, black_frame)) {
    return DecodePlanes(planes, BytePlanes(planes, frames, white_frame, black_frame), frames, axis,
                        light, options);
  }
  PixelLight masked = light;
  std::vector<uint8_t> saturated(planes.pixels(), 0);
  const AxisPlanes<float> floats = FloatPlanes(planes, frames, light, saturated);
  for (size_t p = 0; p < saturated.size(); ++p) masked.usable[p] &= saturated[p] ? 0 : 1;
  return DecodePlanes(planes, floats, frames, axis, masked, options);
}

}  // namespace lfm
