// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Pixels without neighbours, part of gray_kernel_body.h: compiled once for each instruction set,
// so all of it is without linkage.
#include <cstdint>

#include "scan/gray_bits.h"
#include "scan/gray_kernel.h"

namespace lfm::kernels {
namespace {

LFM_INLINE bool IsNear(float a, float b, float reach) { return __builtin_fabsf(a - b) <= reach; }
LFM_INLINE Ints IsNear(Floats a, const float* b, float reach) {
  return Abs(a - Load<Floats>(b)) <= reach;
}

// Sets kept to -1 at the pixels of a row that have a neighbour within `reach`, else to 0. Rows
// above and below may be absent.
LFM_INLINE void MarkNeighbours(const float* above, const float* row, const float* below, long width,
                               float reach, int32_t* __restrict kept) {
  // An absent row is asked for by the other one; without any, the pixel to the right is.
  const float* up = above != nullptr ? above : below != nullptr ? below : row + 1;
  const float* down = below != nullptr ? below : above != nullptr ? above : row + 1;
  long x = 1;
  for (; x + kFloatLanes < width; x += kFloatLanes) {
    const Floats here = Load<Floats>(row + x);
    const Ints near = IsNear(here, row + x - 1, reach) | IsNear(here, row + x + 1, reach) |
                      IsNear(here, up + x, reach) | IsNear(here, down + x, reach);
    Store(near & (here > kNowhere), kept + x);
  }
  const auto one = [&](long i) {
    bool near = i > 0 && IsNear(row[i], row[i - 1], reach);
    near |= i + 1 < width && IsNear(row[i], row[i + 1], reach);
    near |= above != nullptr && IsNear(row[i], above[i], reach);
    near |= below != nullptr && IsNear(row[i], below[i], reach);
    kept[i] = -static_cast<int32_t>(near && row[i] > kNowhere);
  };
  one(0);
  for (; x < width; ++x) one(x);
}

LFM_INLINE void Clear(const int32_t* kept, long width, float* __restrict position,
                      float* __restrict sigma, float* __restrict confidence) {
  long x = 0;
  for (; x + kFloatLanes <= width; x += kFloatLanes) {
    const Ints mask = Load<Ints>(kept + x);
    Store(Only(mask, Load<Floats>(position + x)), position + x);
    Store(Only(mask, Load<Floats>(sigma + x)), sigma + x);
    Store(Only(mask, Load<Floats>(confidence + x)), confidence + x);
  }
  for (; x < width; ++x) {
    if (kept[x] == 0) position[x] = sigma[x] = confidence[x] = 0;
  }
}

// A row is cleared once the next one has been compared with it.
LFM_INLINE void Reject(const GrayRaster& raster, long begin, long end, float reach, int32_t* kept) {
  const long width = raster.width, height = raster.height;
  for (long y = begin; y < end; ++y) {
    if (y < height) {
      const float* row = raster.position + y * width;
      MarkNeighbours(y > 0 ? row - width : nullptr, row, y + 1 < height ? row + width : nullptr,
                     width, reach, kept + (y % 2) * width);
    }
    if (y > 0) {
      const long at = (y - 1) * width;
      Clear(kept + ((y - 1) % 2) * width, width, raster.position + at, raster.sigma + at,
            raster.confidence + at);
    }
  }
}

}  // namespace
}  // namespace lfm::kernels
