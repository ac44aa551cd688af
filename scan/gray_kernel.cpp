// SPDX-License-Identifier: BSD-3-Clause
// Plain loops over short arrays, which the compiler turns into vector code; each public function
// picks one of several compilations of the same always-inlined body. Explicit dispatch rather than
// target_clones: those resolve before the sanitizers are up.
#include "scan/gray_kernel.h"

#define LFM_INLINE [[gnu::always_inline]] inline

namespace lfm::kernels {
namespace {

constexpr uint8_t kCeiling = 254;  // a level of 254 may be a clipped one and its noise

template <typename T>
struct MaskOf;
template <>
struct MaskOf<uint8_t> {
  using Type = uint8_t;
};
template <>
struct MaskOf<float> {
  using Type = uint32_t;
};

LFM_INLINE uint8_t Select(uint8_t mask, uint8_t a, uint8_t b) {
  return static_cast<uint8_t>((a & mask) | (b & ~mask));
}
LFM_INLINE float Select(uint32_t mask, float a, float b) { return mask ? a : b; }

LFM_INLINE uint8_t Distance(uint8_t a, uint8_t b) {
  return static_cast<uint8_t>((a > b ? a : b) - (a > b ? b : a));
}
LFM_INLINE float Distance(float a, float b) { return __builtin_fabsf(a - b); }

// sRGB decoding, to 3e-4 (minimax over the 256 levels).
LFM_INLINE float Linear(uint8_t level) {
  const float c = static_cast<float>(level) * (1.0F / 255);
  return c * (0.0557519688F +
              c * (0.372131001F + c * (1.03351182F + c * (-0.695508231F + c * 0.23440627F))));
}
LFM_INLINE float Linear(float value) { return value; }

// |linear a - linear b| to 0.003: the difference of two cubics, divided by a - b beforehand.
LFM_INLINE float RoughDistance(uint8_t level_a, uint8_t level_b) {
  const float a = static_cast<float>(level_a), b = static_cast<float>(level_b);
  constexpr float kOne = 0.0208300992F / 255, kTwo = 0.656301917F / (255 * 255);
  constexpr float kThree = 0.324083545F / (255 * 255 * 255);
  const float sum = a + b;
  return __builtin_fabsf(a - b) * (kOne + sum * (kTwo + kThree * sum) - kThree * (a * b));
}
LFM_INLINE float RoughDistance(float a, float b) { return __builtin_fabsf(a - b); }

// A saturated byte or a float that is not finite cannot be measured.
LFM_INLINE uint8_t Unfit(uint8_t a, uint8_t b) { return a > b ? a : b; }
LFM_INLINE float Unfit(float a, float b) { return (a - b) * 0.0F; }
LFM_INLINE uint8_t Worse(uint8_t a, uint8_t b) { return a > b ? a : b; }
LFM_INLINE float Worse(float a, float b) { return a + b; }
LFM_INLINE bool IsFit(uint8_t worst) { return worst < kCeiling; }
LFM_INLINE bool IsFit(float worst) { return worst == 0.0F; }

// Forty frames are more streams than the processor fetches ahead by itself.
template <typename T>
LFM_INLINE void FetchNextBlock(const T* p, int count) {
  const char* next = reinterpret_cast<const char*>(p + count);
  for (long line = 0; line < long{count} * long{sizeof(T)}; line += 64) {
    __builtin_prefetch(next + line);
  }
}

template <typename T>
struct BitState {
  using Mask = typename MaskOf<T>::Type;
  Mask low[kGrayBlock], high[kGrayBlock];  // bits 0-7 and 8-15 of the Gray code
  Mask seen[kGrayBlock], done[kGrayBlock];
  T finest_p[kGrayBlock], finest_q[kGrayBlock];
  T other_p[kGrayBlock], other_q[kGrayBlock];
  T weak_p[kGrayBlock], weak_q[kGrayBlock], weak[kGrayBlock];
  T strong_p[kGrayBlock], strong_q[kGrayBlock], strong[kGrayBlock];
  T worst[kGrayBlock];
};

// From the finest bit to the coarsest. The cell's other edge belongs to the bit left of the
// rightmost 1 of the Gray code: its value as seen here is taken when it comes by.
template <typename T>
LFM_INLINE void ReadBits(const GrayPlanes<T>& planes, long begin, int count, BitState<T>& s) {
  using Mask = typename BitState<T>::Mask;
  constexpr bool kBytes = sizeof(T) == 1;
  const T* white = planes.white + begin;
  const T* black = planes.black + begin;
  const T* p = planes.pattern[0] + begin;
  const T* q = planes.inverse[0] + begin;
  FetchNextBlock(p, count);
  FetchNextBlock(q, count);
  for (int i = 0; i < count; ++i) {
    const Mask on = static_cast<Mask>(-static_cast<int>(p[i] > q[i]));
    s.low[i] = on & 1;
    s.high[i] = 0;
    s.seen[i] = on;
    s.done[i] = 0;
    s.finest_p[i] = p[i];
    s.finest_q[i] = q[i];
    s.other_p[i] = s.weak_p[i] = white[i];
    s.other_q[i] = s.weak_q[i] = black[i];
    s.weak[i] = Distance(white[i], black[i]);
    s.worst[i] = Worse(Unfit(white[i], black[i]), Unfit(p[i], q[i]));
  }
  for (int bit = 1; bit < planes.bits; ++bit) {
    p = planes.pattern[bit] + begin;
    q = planes.inverse[bit] + begin;
    FetchNextBlock(p, count);
    FetchNextBlock(q, count);
    const Mask digit = static_cast<Mask>(1U << (bit & 7));
    Mask* code = bit < 8 ? s.low : s.high;
    for (int i = 0; i < count; ++i) {
      const T lit = p[i], dark = q[i];
      const Mask on = static_cast<Mask>(-static_cast<int>(lit > dark));
      const Mask take = static_cast<Mask>(s.seen[i] & ~s.done[i]);
      const T apart = Distance(lit, dark);
      const Mask weaker =
          static_cast<Mask>(static_cast<Mask>(-static_cast<int>(apart < s.weak[i])) & ~take);
      code[i] |= static_cast<Mask>(on & digit);
      s.other_p[i] = Select(take, lit, s.other_p[i]);
      s.other_q[i] = Select(take, dark, s.other_q[i]);
      s.weak_p[i] = Select(weaker, lit, s.weak_p[i]);
      s.weak_q[i] = Select(weaker, dark, s.weak_q[i]);
      s.weak[i] = Select(weaker, apart, s.weak[i]);
      s.done[i] |= take;
      s.seen[i] |= on;
      if constexpr (!kBytes) s.worst[i] = Worse(s.worst[i], Unfit(lit, dark));
    }
  }
  if constexpr (kBytes) {
    for (int i = 0; i < count; ++i) {
      s.worst[i] = Worse(s.worst[i], Unfit(s.other_p[i], s.other_q[i]));
    }
  }
}

// Of the bits whose stripes are narrow, but not so narrow that blur takes them, the clearest.
template <typename T>
LFM_INLINE void ReadClearest(const GrayPlanes<T>& planes, long begin, int count, BitState<T>& s) {
  using Mask = typename BitState<T>::Mask;
  const int first = planes.bits > 2 ? 2 : planes.bits - 1;
  for (int i = 0; i < count; ++i) s.strong[i] = s.strong_p[i] = s.strong_q[i] = 0;
  for (int bit = first; bit < planes.bits && bit < first + 3; ++bit) {
    const T* p = planes.pattern[bit] + begin;
    const T* q = planes.inverse[bit] + begin;
    for (int i = 0; i < count; ++i) {
      const T lit = p[i], dark = q[i];
      const T apart = Distance(lit, dark);
      const Mask clearer = static_cast<Mask>(-static_cast<int>(apart >= s.strong[i]));
      s.strong_p[i] = Select(clearer, lit, s.strong_p[i]);
      s.strong_q[i] = Select(clearer, dark, s.strong_q[i]);
      s.strong[i] = Select(clearer, apart, s.strong[i]);
    }
  }
}

template <typename T>
LFM_INLINE void Read(const GrayPlanes<T>& planes, const GrayNoise& noise, const float* contrast,
                     long begin, int count, GrayReading& reading) {
  BitState<T> s;
  ReadBits(planes, begin, count, s);
  ReadClearest(planes, begin, count, s);
  for (int i = 0; i < count; ++i) {
    uint32_t code = static_cast<uint32_t>(s.low[i]) | (static_cast<uint32_t>(s.high[i]) << 8);
    code ^= code >> 1;
    code ^= code >> 2;
    code ^= code >> 4;
    code ^= code >> 8;
    reading.cell[i] = static_cast<uint16_t>(code);
  }
  const float constant = noise.pair_offset * noise.offset;
  for (int i = 0; i < count; ++i) {
    const float fp = Linear(s.finest_p[i]), fq = Linear(s.finest_q[i]);
    const float op = Linear(s.other_p[i]), oq = Linear(s.other_q[i]);
    const float f = Distance(fp, fq), o = Distance(op, oq);
    const float sum = f + o + 1e-12F;
    const float f_variance = constant + noise.slope * (noise.own * fp + noise.both * (fp + fq));
    const float o_variance = constant + noise.slope * (noise.own * op + noise.both * (op + oq));
    const float product = 1 / (sum * contrast[i]);
    const float inverse = product * contrast[i], scale = product * sum;
    const float square = inverse * inverse;
    reading.balance[i] = (o - f) * inverse;
    reading.variance[i] = 4 * (f * f * o_variance + o * o * f_variance) * (square * square);
    const float strength = sum * scale;
    reading.strength[i] = IsFit(s.worst[i]) ? strength : 0.0F;
    reading.weakest[i] = RoughDistance(s.weak_p[i], s.weak_q[i]) * scale;
    reading.direct[i] = RoughDistance(s.strong_p[i], s.strong_q[i]) * scale;
  }
}

LFM_INLINE uint32_t IsNear(float a, float b, float reach) {
  return static_cast<uint32_t>(__builtin_fabsf(a - b) <= reach);
}

// Which pixels of a row have a neighbour within `reach`. Rows above and below may be absent.
LFM_INLINE void MarkNeighbours(const float* above, const float* row, const float* below, long width,
                               float reach, uint32_t* __restrict kept) {
  // An absent row is asked for by the other one; without any, the pixel to the right is.
  const float* up = above != nullptr ? above : below != nullptr ? below : row + 1;
  const float* down = below != nullptr ? below : above != nullptr ? above : row + 1;
  for (long x = 1; x < width - 1; ++x) {
    const float here = row[x];
    const uint32_t near = IsNear(here, row[x - 1], reach) | IsNear(here, row[x + 1], reach) |
                          IsNear(here, up[x], reach) | IsNear(here, down[x], reach);
    kept[x] = near & static_cast<uint32_t>(here > kNowhere);
  }
  for (long end = 0; end < 2; ++end) {
    const long x = end * (width - 1);
    uint32_t near = 0;
    if (x > 0) near |= IsNear(row[x], row[x - 1], reach);
    if (x + 1 < width) near |= IsNear(row[x], row[x + 1], reach);
    if (above != nullptr) near |= IsNear(row[x], above[x], reach);
    if (below != nullptr) near |= IsNear(row[x], below[x], reach);
    kept[x] = near & static_cast<uint32_t>(row[x] > kNowhere);
  }
}

LFM_INLINE void Clear(const uint32_t* kept, long width, float* __restrict position,
                      float* __restrict sigma, float* __restrict confidence) {
  for (long x = 0; x < width; ++x) position[x] = kept[x] ? position[x] : 0.0F;
  for (long x = 0; x < width; ++x) sigma[x] = kept[x] ? sigma[x] : 0.0F;
  for (long x = 0; x < width; ++x) confidence[x] = kept[x] ? confidence[x] : 0.0F;
}

// A row is cleared once the next one has been compared with it.
LFM_INLINE void Reject(long width, long height, float reach, uint32_t* kept, float* position,
                       float* sigma, float* confidence) {
  for (long y = 0; y <= height; ++y) {
    if (y < height) {
      const float* row = position + y * width;
      MarkNeighbours(y > 0 ? row - width : nullptr, row, y + 1 < height ? row + width : nullptr,
                     width, reach, kept + (y % 2) * width);
    }
    if (y > 0) {
      const long at = (y - 1) * width;
      Clear(kept + ((y - 1) % 2) * width, width, position + at, sigma + at, confidence + at);
    }
  }
}

LFM_INLINE float Clamped(float x, float low, float high) {
  const float above = x > low ? x : low;  // NaN becomes low
  return above < high ? above : high;
}

LFM_INLINE void Place(const GrayReading& reading, const GrayPlacing& placing,
                      const uint8_t* __restrict usable, int count, float* __restrict position,
                      float* __restrict sigma, float* __restrict confidence) {
  int32_t interval[kGrayBlock];
  float place[kGrayBlock], slope[kGrayBlock], spread[kGrayBlock];
  for (int i = 0; i < count; ++i) {
    const float at = (Clamped(reading.balance[i], -1, 1) + 1) * (0.5F * kGrayIntervals);
    interval[i] = static_cast<int32_t>(Clamped(at, 0, kGrayIntervals - 1));
  }
  // Apart, since looking up does not vectorise well.
  for (int i = 0; i < count; ++i) {
    const GrayInterval& found = placing.intervals[interval[i]];
    place[i] = found.place;
    slope[i] = found.slope;
    spread[i] = found.spread;
  }
  const float last = static_cast<float>(placing.size) - 0.5F, cell_px = placing.cell_px;
  const float min_weakest = placing.min_weakest, min_strength = placing.min_strength;
  const float min_direct = placing.min_direct;
  for (int i = 0; i < count; ++i) {
    const float start = static_cast<float>(interval[i]) * (2.0F / kGrayIntervals) - 1;
    const float within = Clamped(reading.balance[i], -1, 1) - start;
    const float side = static_cast<float>(1 - 2 * (reading.cell[i] & 1));
    const float in_cell = 0.5F + side * (place[i] + slope[i] * within - 0.5F);
    place[i] = cell_px * (static_cast<float>(reading.cell[i]) + in_cell) - 0.5F;
    const float variance = slope[i] * slope[i] * Clamped(reading.variance[i], 0, 1) + spread[i];
    spread[i] = cell_px * __builtin_sqrtf(variance);
    const float weakest = reading.weakest[i], strength = reading.strength[i];
    const float direct = reading.direct[i];
    slope[i] = Clamped(weakest * 1.25F, 0, 1) * Clamped(strength, 0, 1);
    interval[i] = -(
        static_cast<int32_t>(weakest >= min_weakest) & static_cast<int32_t>(direct >= min_direct) &
        static_cast<int32_t>(strength >= min_strength) & static_cast<int32_t>(place[i] < last));
  }
  for (int i = 0; i < count; ++i) {
    const int32_t good = interval[i] & -static_cast<int32_t>(usable[i] != 0);
    position[i] = good ? place[i] : kNowhere;
    sigma[i] = good ? spread[i] : 0.0F;
    confidence[i] = good ? slope[i] : 0.0F;
  }
}

struct Kernels {
  void (*read_bytes)(const GrayPlanes<uint8_t>&, const GrayNoise&, const float*, long, int,
                     GrayReading&);
  void (*read_floats)(const GrayPlanes<float>&, const GrayNoise&, const float*, long, int,
                      GrayReading&);
  void (*place)(const GrayReading&, const GrayPlacing&, const uint8_t*, int, float*, float*,
                float*);
  void (*reject)(long, long, float, uint32_t*, float*, float*, float*);
};

#define LFM_COMPILE_KERNELS(NAME, TARGET)                                                         \
  TARGET void ReadBytes##NAME(const GrayPlanes<uint8_t>& p, const GrayNoise& n, const float* c,   \
                              long begin, int count, GrayReading& r) {                            \
    Read(p, n, c, begin, count, r);                                                               \
  }                                                                                               \
  TARGET void ReadFloats##NAME(const GrayPlanes<float>& p, const GrayNoise& n, const float* c,    \
                               long begin, int count, GrayReading& r) {                           \
    Read(p, n, c, begin, count, r);                                                               \
  }                                                                                               \
  TARGET void Place##NAME(const GrayReading& r, const GrayPlacing& g, const uint8_t* usable,      \
                          int count, float* position, float* sigma, float* confidence) {          \
    Place(r, g, usable, count, position, sigma, confidence);                                      \
  }                                                                                               \
  TARGET void Reject##NAME(long width, long height, float reach, uint32_t* kept, float* position, \
                           float* sigma, float* confidence) {                                     \
    Reject(width, height, reach, kept, position, sigma, confidence);                              \
  }                                                                                               \
  constexpr Kernels k##NAME = {ReadBytes##NAME, ReadFloats##NAME, Place##NAME, Reject##NAME};

LFM_COMPILE_KERNELS(Baseline, )
#if defined(__x86_64__)
LFM_COMPILE_KERNELS(Avx2, __attribute__((target("arch=x86-64-v3"))))
#endif

const Kernels& Best() {
#if defined(__x86_64__)
  static const Kernels& best = __builtin_cpu_supports("x86-64-v3") ? kAvx2 : kBaseline;
  return best;
#else
  return kBaseline;
#endif
}

}  // namespace

void ReadGray(const GrayPlanes<uint8_t>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading) {
  Best().read_bytes(planes, noise, contrast, begin, count, reading);
}

void ReadGray(const GrayPlanes<float>& planes, const GrayNoise& noise, const float* contrast,
              long begin, int count, GrayReading& reading) {
  Best().read_floats(planes, noise, contrast, begin, count, reading);
}

void PlaceGray(const GrayReading& reading, const GrayPlacing& placing, const uint8_t* usable,
               int count, float* position, float* sigma, float* confidence) {
  Best().place(reading, placing, usable, count, position, sigma, confidence);
}

void RejectIslands(long width, long height, float reach, uint32_t* kept, float* position,
                   float* sigma, float* confidence) {
  Best().reject(width, height, reach, kept, position, sigma, confidence);
}

}  // namespace lfm::kernels
