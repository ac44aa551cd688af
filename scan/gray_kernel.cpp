// SPDX-License-Identifier: BSD-3-Clause
#include "scan/gray_kernel.h"

#include <algorithm>
#include <array>

namespace lfm::kernels {

#if defined(__x86_64__)
extern const GrayKernels kAvx2Gray;
#endif
extern const GrayKernels kBaselineGray;

namespace {

constexpr int kLanes = 8;

/// `count` values with whole vectors to read.
class Padded {
 public:
  Padded(const float* values, int count) : values_(values) {
    if (count % kLanes == 0) return;
    std::copy_n(values, count, copy_.begin());
    std::fill(copy_.begin() + count, copy_.end(), 0.0F);
    values_ = copy_.data();
  }
  Padded(const Padded&) = delete;
  Padded& operator=(const Padded&) = delete;

  const float* data() const { return values_; }

 private:
  const float* values_;
  std::array<float, kGrayBlock> copy_;
};

}  // namespace

const GrayKernels* GrayKernelsHere(int i) {
#if defined(__x86_64__)
  static const bool avx2 = __builtin_cpu_supports("x86-64-v3") != 0;
  if (avx2 && i == 0) return &kAvx2Gray;
  if (avx2) --i;
#endif
  return i == 0 ? &kBaselineGray : nullptr;
}

void SetIntervals(const GrayInterval (&intervals)[kGrayIntervals], GrayPlacing& placing) {
  const float cell_px = placing.cell_px;
  for (int k = 0; k <= kGrayIntervals; ++k) {
    const int i = std::min(k, kGrayIntervals - 1);
    const GrayInterval& interval = intervals[i];
    const float start = static_cast<float>(i) * (2.0F / kGrayIntervals) - 1;
    placing.offset[k] = cell_px * (interval.place - interval.slope * start - 0.5F);
    placing.slope[k] = cell_px * interval.slope;
    placing.spread[k] = cell_px * cell_px * interval.spread;
  }
}

void ReadGray(const GrayPlanes<uint8_t>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading, const GrayKernels& kernels) {
  const Padded padded(contrast, count);
  kernels.read_bytes(planes, noise, padded.data(), begin, count, reading);
}

void ReadGray(const GrayPlanes<float>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading, const GrayKernels& kernels) {
  const Padded padded(contrast, count);
  kernels.read_floats(planes, noise, padded.data(), begin, count, reading);
}

void DecodeGray(const GrayPlanes<uint8_t>& planes, const GrayNoise& noise,
                const GrayPlacing& placing, const float* contrast, const uint8_t* usable,
                long begin, int count, GrayPlaces& places, const GrayKernels& kernels) {
  const Padded padded(contrast, count);
  kernels.decode_bytes(planes, noise, placing, padded.data(), usable, begin, count, places);
}

void DecodeGray(const GrayPlanes<float>& planes, const GrayNoise& noise, const GrayPlacing& placing,
                const float* contrast, const uint8_t* usable, long begin, int count,
                GrayPlaces& places, const GrayKernels& kernels) {
  const Padded padded(contrast, count);
  kernels.decode_floats(planes, noise, placing, padded.data(), usable, begin, count, places);
}

void ReadGrayLight(const float* linear_of_level, const uint8_t* lit, const uint8_t* dark,
                   float min_contrast, int count, GrayLight& light, const GrayKernels& kernels) {
  kernels.light(linear_of_level, lit, dark, min_contrast, count, light);
}

void RejectIslands(const GrayRaster& raster, long begin, long end, float reach, int32_t* kept,
                   const GrayKernels& kernels) {
  kernels.reject(raster, begin, end, reach, kept);
}

}  // namespace lfm::kernels
