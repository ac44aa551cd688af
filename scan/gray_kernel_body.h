// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Reading and placing, and the table of them, compiled once for each instruction set by
// gray_kernel_INSTRUCTIONS.cpp.
#include "scan/gray_bits.h"
#include "scan/gray_islands.h"
#include "scan/gray_kernel.h"

namespace lfm::kernels {
namespace {

// sRGB decoding, to 3e-4 (minimax over the 256 levels); grows from level to level.
template <typename T>
LFM_INLINE Floats Linear(const T* from) {
  const Floats c = Values(from);
  if constexpr (sizeof(T) > 1) return c;
  constexpr double k = 1.0 / 255, k2 = k * k, k3 = k2 * k, k4 = k3 * k, k5 = k4 * k;
  constexpr float kOne = static_cast<float>(0.0557519688 * k);
  constexpr float kTwo = static_cast<float>(0.372131001 * k2);
  constexpr float kThree = static_cast<float>(1.03351182 * k3);
  constexpr float kFour = static_cast<float>(-0.695508231 * k4);
  constexpr float kFive = static_cast<float>(0.23440627 * k5);
  return c * (kOne + c * (kTwo + c * (kThree + c * (kFour + c * kFive))));
}

// |linear a - linear b| to 0.003: the difference of two cubics, divided by a - b beforehand.
template <typename T>
LFM_INLINE Floats RoughDistance(const T* bright, const T* apart) {
  const Floats a = Values(bright), distance = Values(apart);
  if constexpr (sizeof(T) > 1) return distance;
  constexpr float kOne = 0.0208300992F / 255, kTwo = 0.656301917F / (255 * 255);
  constexpr float kThree = 0.324083545F / (255 * 255 * 255);
  const Floats b = a - distance, sum = a + b;
  return distance * (kOne + sum * (kTwo + kThree * sum) - kThree * (a * b));
}

/// Of bytes the first is the brighter one.
template <typename T>
LFM_INLINE Floats Difference(Floats p, Floats q) {
  if constexpr (sizeof(T) > 1) return Abs(p - q);
  return p - q;
}

/// Short loops one after the other: in a long one, each step would wait for the one before.
template <typename T>
LFM_INLINE void Read(const GrayPlanes<T>& planes, const GrayNoise& noise, const float* contrast,
                     long begin, int count, GrayReading& reading) {
  BitBlock<T> bits;
  ReadBlock(planes, begin, count, bits, reading);
  const float constant = noise.pair_offset * noise.offset;
  const float own = noise.slope * noise.own, both = noise.slope * noise.both;
  Floats sums[kGrayBlock / kFloatLanes];
  for (int i = 0; i < count; i += kFloatLanes) {
    const Floats fp = Linear(bits.finest_p + i), fq = Linear(bits.finest_q + i);
    const Floats op = Linear(bits.other_p + i), oq = Linear(bits.other_q + i);
    const Floats f = Difference<T>(fp, fq), o = Difference<T>(op, oq);
    Floats f_variance = constant + both * (fp + fq), o_variance = constant + both * (op + oq);
    if constexpr (sizeof(T) > 1) {
      f_variance += own * fp;
      o_variance += own * op;
    }
    sums[i / kFloatLanes] = f + o + 1e-12F;
    Store(o - f, reading.balance + i);
    Store(f * f * o_variance + o * o * f_variance, reading.variance + i);
  }
  for (int i = 0; i < count; i += kFloatLanes) {
    const Floats sum = sums[i / kFloatLanes], of = Load<Floats>(contrast + i);
    const Floats product = 1 / (sum * of);
    const Floats inverse = product * of, scale = product * sum;
    const Floats square = inverse * inverse;
    Store(Load<Floats>(reading.balance + i) * inverse, reading.balance + i);
    Store(4 * Load<Floats>(reading.variance + i) * (square * square), reading.variance + i);
    Store(sum * scale, reading.strength + i);
    const Floats weakest = RoughDistance(bits.weak_bright + i, bits.weak + i);
    const Floats direct = RoughDistance(bits.strong_bright + i, bits.strong + i);
    Store(weakest * scale, reading.weakest + i);
    Store(direct * scale, reading.direct + i);
  }
}

template <typename T>
LFM_INLINE void Decode(const GrayPlanes<T>& planes, const GrayNoise& noise,
                       const GrayPlacing& placing, const float* contrast, const uint8_t* usable,
                       long begin, int count, GrayPlaces& places) {
  GrayReading reading;
  Read(planes, noise, contrast, begin, count, reading);
  for (int i = 0; i < count; ++i) reading.fit[i] &= static_cast<uint8_t>(-(usable[i] != 0));
  const float cell_px = placing.cell_px, middle = 0.5F * cell_px - 0.5F;
  const float last = static_cast<float>(placing.size) - 0.5F;
  const float min_weakest = placing.min_weakest, min_strength = placing.min_strength;
  const float min_direct = placing.min_direct;
  for (int i = 0; i < count; i += kFloatLanes) {
    const Floats balance = Load<Floats>(reading.balance + i);
    const Floats strength = Load<Floats>(reading.strength + i);
    const Floats weakest = Load<Floats>(reading.weakest + i);
    const Floats direct = Load<Floats>(reading.direct + i);
    const Floats at = balance * (0.5F * kGrayIntervals) + 0.5F * kGrayIntervals;
    const Ints interval = __builtin_convertvector(at, Ints);
    const Floats slope = LookUp(placing.slope, interval);
    const Floats in_cell = LookUp(placing.offset, interval) + slope * balance;
    const Ints cell = Whole(reading.cell + i);
    // Every other cell has its edges the other way round.
    const Floats place =
        cell_px * __builtin_convertvector(cell, Floats) + middle + FlipSign(in_cell, cell << 31);
    const Floats variance = slope * slope * AtMost(Load<Floats>(reading.variance + i), 1) +
                            LookUp(placing.spread, interval);
    const Ints good = MaskOf(reading.fit + i) & (weakest >= min_weakest) & (direct >= min_direct) &
                      (strength >= min_strength) & (place < last);
    Store(Select(good, place, kNowhere + Floats{}), places.position + i);
    Store(Only(good, Sqrt(variance)), places.sigma + i);
    const Floats sure = AtMost(weakest * 1.25F, 1) * AtMost(strength, 1);
    Store(Only(good, sure), places.confidence + i);
  }
}

template <typename T>
void ReadOf(const GrayPlanes<T>& planes, const GrayNoise& noise, const float* contrast, long begin,
            int count, GrayReading& reading) {
  Read(planes, noise, contrast, begin, count, reading);
}

template <typename T>
void DecodeOf(const GrayPlanes<T>& planes, const GrayNoise& noise, const GrayPlacing& placing,
              const float* contrast, const uint8_t* usable, long begin, int count,
              GrayPlaces& places) {
  Decode(planes, noise, placing, contrast, usable, begin, count, places);
}

void LightOf(const float* linear_of_level, const uint8_t* lit, const uint8_t* dark,
             float min_contrast, int count, GrayLight& light) {
  for (int i = 0; i < count; ++i) {
    light.white[i] = linear_of_level[lit[i]];
    light.contrast[i] = light.white[i] - linear_of_level[dark[i]];
  }
  for (int i = 0; i < count; ++i) {
    const uint32_t bright = static_cast<uint32_t>(light.contrast[i] >= min_contrast) &
                            static_cast<uint32_t>(light.contrast[i] > 0);
    const uint8_t level = lit[i] > dark[i] ? lit[i] : dark[i];
    light.usable[i] = static_cast<uint8_t>(bright & static_cast<uint32_t>(level < kCeiling));
  }
}

void RejectOf(const GrayRaster& raster, long begin, long end, float reach, int32_t* kept) {
  Reject(raster, begin, end, reach, kept);
}

constexpr GrayKernels kOfTheseInstructions = {ReadOf<uint8_t>, ReadOf<float>, DecodeOf<uint8_t>,
                                              DecodeOf<float>, LightOf,       RejectOf};

}  // namespace
}  // namespace lfm::kernels
