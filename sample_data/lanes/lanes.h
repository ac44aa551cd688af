// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <immintrin.h>
#endif

/// Several light paths at once. Formulas are templates over the number `F`: `float` for one path,
/// `Floats` for as many side by side (a lane each) as a register holds; both give the same bits,
/// and so do all instruction sets, since every operation here is exactly rounded and none is
/// contracted.
///
/// A file that runs lanes is compiled once for each instruction set, with LFM_LANE_SET naming the
/// set: all that is declared between the lanes' namespace braces then has a name of its own, and
/// code for a newer machine cannot end up in what an older one runs. Nothing that belongs to other
/// libraries (containers, Eigen) may be used there.
#ifndef LFM_LANE_SET
#define LFM_LANE_SET lanes_baseline
#endif
#define LFM_LANE [[gnu::always_inline]] inline
/// For what is too large to be copied to every place of use; vectors are handed over in memory.
#define LFM_LANE_CALL [[gnu::noinline]] inline

namespace lfm {
inline namespace LFM_LANE_SET {

#ifdef __AVX2__
inline constexpr int kLaneCount = 8;
#else
inline constexpr int kLaneCount = 4;
#endif

using Floats = float __attribute__((vector_size(4 * kLaneCount)));
using Ints = int32_t __attribute__((vector_size(4 * kLaneCount)));  // a mask holds 0 or -1 a lane
using UInts = uint32_t __attribute__((vector_size(4 * kLaneCount)));
using ULongs = uint64_t __attribute__((vector_size(8 * kLaneCount)));

template <typename F>
struct LaneTypes;
template <>
struct LaneTypes<float> {
  using Int = int32_t;
  using UInt = uint32_t;
  using ULong = uint64_t;
  using Mask = bool;
};
template <>
struct LaneTypes<Floats> {
  using Int = Ints;
  using UInt = UInts;
  using ULong = ULongs;
  using Mask = Ints;
};
template <typename F>
using IntOf = typename LaneTypes<F>::Int;
template <typename F>
using UIntOf = typename LaneTypes<F>::UInt;
template <typename F>
using ULongOf = typename LaneTypes<F>::ULong;
template <typename F>
using MaskOf = typename LaneTypes<F>::Mask;

/// The same value in every lane.
template <typename T>
LFM_LANE T Splat(float value) {
  return value - T{};
}
template <typename T>
LFM_LANE T SplatInt(int32_t value) {
  return value + T{};
}

LFM_LANE float Select(bool mask, float yes, float no) { return mask ? yes : no; }
LFM_LANE int32_t Select(bool mask, int32_t yes, int32_t no) { return mask ? yes : no; }
LFM_LANE Floats Select(Ints mask, Floats yes, Floats no) { return mask ? yes : no; }
LFM_LANE Floats Select(Ints mask, Floats yes, float no) { return mask ? yes : Splat<Floats>(no); }
LFM_LANE Ints Select(Ints mask, Ints yes, Ints no) { return mask ? yes : no; }

/// A bit a lane of a mask.
LFM_LANE unsigned MaskBits(Ints mask) {
#if defined(__AVX2__)
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
  unsigned bits = 0;
  for (int lane = 0; lane < kLaneCount; ++lane) bits |= (mask[lane] < 0 ? 1u : 0u) << lane;
  return bits;
#endif
}
LFM_LANE bool Any(bool mask) { return mask; }
LFM_LANE bool Any(Ints mask) { return MaskBits(mask) != 0; }
LFM_LANE bool All(bool mask) { return mask; }
LFM_LANE bool All(Ints mask) { return MaskBits(mask) == (1u << kLaneCount) - 1; }

/// Where `a` is no number, they are `b`.
LFM_LANE float Min(float a, float b) { return a < b ? a : b; }
LFM_LANE float Max(float a, float b) { return a > b ? a : b; }
LFM_LANE Floats Min(Floats a, Floats b) { return a < b ? a : b; }
LFM_LANE Floats Max(Floats a, Floats b) { return a > b ? a : b; }
LFM_LANE Floats Min(Floats a, float b) { return Min(a, Splat<Floats>(b)); }
LFM_LANE Floats Max(Floats a, float b) { return Max(a, Splat<Floats>(b)); }
template <typename F>
LFM_LANE F Clamp(F x, float low, float high) {
  return Min(Max(x, low), high);
}

LFM_LANE float Sqrt(float x) { return __builtin_sqrtf(x); }
LFM_LANE Floats Sqrt(Floats x) {
#if defined(__AVX2__)
  return reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(x)));
#elif defined(__SSE2__)
  return reinterpret_cast<Floats>(_mm_sqrt_ps(reinterpret_cast<__m128>(x)));
#else
  for (int lane = 0; lane < kLaneCount; ++lane) x[lane] = __builtin_sqrtf(x[lane]);
  return x;
#endif
}

LFM_LANE int32_t FirstLane(int32_t x) { return x; }
LFM_LANE int32_t FirstLane(Ints x) { return x[0]; }
LFM_LANE int32_t BitsOf(float x) { return __builtin_bit_cast(int32_t, x); }
LFM_LANE Ints BitsOf(Floats x) { return reinterpret_cast<Ints>(x); }
LFM_LANE float FromBits(int32_t x) { return __builtin_bit_cast(float, x); }
LFM_LANE Floats FromBits(Ints x) { return reinterpret_cast<Floats>(x); }
LFM_LANE float ToFloat(int32_t x) { return static_cast<float>(x); }
LFM_LANE Floats ToFloat(Ints x) { return __builtin_convertvector(x, Floats); }
/// Towards zero; |x| must be below 2^31.
LFM_LANE int32_t ToInt(float x) { return static_cast<int32_t>(x); }
LFM_LANE Ints ToInt(Floats x) { return __builtin_convertvector(x, Ints); }
LFM_LANE uint32_t LowBits(uint64_t x) { return static_cast<uint32_t>(x); }
LFM_LANE UInts LowBits(ULongs x) { return __builtin_convertvector(x, UInts); }
LFM_LANE uint64_t Widen(uint32_t x) { return x; }
LFM_LANE ULongs Widen(UInts x) { return __builtin_convertvector(x, ULongs); }
LFM_LANE int32_t AsInt(uint32_t x) { return static_cast<int32_t>(x); }
LFM_LANE Ints AsInt(UInts x) { return reinterpret_cast<Ints>(x); }

template <typename F>
LFM_LANE F Abs(F x) {
  return FromBits(BitsOf(x) & 0x7fffffff);
}
/// |x| must be below 2^31.
template <typename F>
LFM_LANE F Floor(F x) {
  const F whole = ToFloat(ToInt(x));
  return Select(whole > x, whole - 1.0f, whole);
}

/// base[index] a lane.
LFM_LANE float Gather(const float* base, int32_t index) { return base[index]; }
LFM_LANE int32_t Gather(const int32_t* base, int32_t index) { return base[index]; }
LFM_LANE Floats Gather(const float* base, Ints index) {
  Floats values;
  for (int lane = 0; lane < kLaneCount; ++lane) values[lane] = base[index[lane]];
  return values;
}
LFM_LANE Ints Gather(const int32_t* base, Ints index) {
  Ints values;
  for (int lane = 0; lane < kLaneCount; ++lane) values[lane] = base[index[lane]];
  return values;
}

/// Eight values that follow each other in memory from base[index] on, a lane.
template <typename F>
struct Row {
  F at[8];
};
LFM_LANE Row<float> GatherRow(const float* base, int32_t index) {
  Row<float> row;
  for (int i = 0; i < 8; ++i) row.at[i] = base[index + i];
  return row;
}
LFM_LANE Row<Floats> GatherRow(const float* base, Ints index) {
#if defined(__AVX2__)
  // Eight loads, and a transposition by halves, quarters and eighths.
  __m256 r[8], t[8];
  for (int lane = 0; lane < 8; ++lane) r[lane] = _mm256_loadu_ps(base + index[lane]);
  for (int i = 0; i < 4; ++i) {
    t[i] = _mm256_permute2f128_ps(r[i], r[i + 4], 0x20);
    t[i + 4] = _mm256_permute2f128_ps(r[i], r[i + 4], 0x31);
  }
  Row<Floats> row;
  for (int half = 0; half < 8; half += 4) {
    const __m256 a = _mm256_unpacklo_ps(t[half], t[half + 2]);
    const __m256 b = _mm256_unpackhi_ps(t[half], t[half + 2]);
    const __m256 c = _mm256_unpacklo_ps(t[half + 1], t[half + 3]);
    const __m256 d = _mm256_unpackhi_ps(t[half + 1], t[half + 3]);
    row.at[half] = reinterpret_cast<Floats>(_mm256_unpacklo_ps(a, c));
    row.at[half + 1] = reinterpret_cast<Floats>(_mm256_unpackhi_ps(a, c));
    row.at[half + 2] = reinterpret_cast<Floats>(_mm256_unpacklo_ps(b, d));
    row.at[half + 3] = reinterpret_cast<Floats>(_mm256_unpackhi_ps(b, d));
  }
  return row;
#else
  Row<Floats> row;
  for (int lane = 0; lane < kLaneCount; ++lane) {
    for (int i = 0; i < 8; ++i) row.at[i][lane] = base[index[lane] + i];
  }
  return row;
#endif
}

/// kLaneCount consecutive values; `from` and `to` need no alignment.
LFM_LANE Floats LoadLanes(const float* from) {
  Floats values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
LFM_LANE Ints LoadLanes(const int32_t* from) {
  Ints values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
LFM_LANE ULongs LoadLanes(const uint64_t* from) {
  ULongs values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
template <typename T, typename V>
LFM_LANE void StoreLanes(T* to, V values) {
  static_assert(sizeof(T) * kLaneCount == sizeof(V));
  std::memcpy(to, &values, sizeof values);
}

#ifdef __AVX2__
/// For each mask's bits the numbers of its lanes, then those of the others.
struct LaneOrders {
  alignas(64) uint8_t of_bits[256][8] = {};
  constexpr LaneOrders() {
    for (int bits = 0; bits < 256; ++bits) {
      int n = 0;
      for (int wanted = 1; wanted >= 0; --wanted) {
        for (int lane = 0; lane < 8; ++lane) {
          if ((bits >> lane & 1) == wanted) of_bits[bits][n++] = static_cast<uint8_t>(lane);
        }
      }
    }
  }
};
inline constexpr LaneOrders kLaneOrders;
#endif

/// Writes the lanes of a mask one after the other. kLaneCount values may be written at `to`,
/// whatever the mask: what lies beyond the counted ones is rubbish.
class LanePacker {
 public:
  LFM_LANE explicit LanePacker(Ints mask) : bits_(MaskBits(mask)) {
#ifdef __AVX2__
    order_ = _mm256_cvtepu8_epi32(
        _mm_loadl_epi64(reinterpret_cast<const __m128i*>(kLaneOrders.of_bits[bits_])));
#endif
  }
  LFM_LANE int count() const { return __builtin_popcount(bits_); }
  LFM_LANE void Write(float* to, Floats values) const { WriteEach(to, values); }
  LFM_LANE void Write(int32_t* to, Ints values) const { WriteEach(to, values); }
  LFM_LANE void Write(uint64_t* to, ULongs values) const { WriteOneByOne(to, values); }

 private:
#ifdef __AVX2__
  template <typename T, typename V>
  LFM_LANE void WriteEach(T* to, V values) const {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values), order_));
  }
#else
  template <typename T, typename V>
  LFM_LANE void WriteEach(T* to, V values) const {
    WriteOneByOne(to, values);
  }
#endif
  template <typename T, typename V>
  LFM_LANE void WriteOneByOne(T* to, V values) const {
    T lanes[kLaneCount];
    StoreLanes(lanes, values);
    int n = 0;
    for (int lane = 0; lane < kLaneCount; ++lane) {
      to[n] = lanes[lane];
      n += static_cast<int>(bits_ >> lane & 1u);
    }
  }
  unsigned bits_;
#ifdef __AVX2__
  __m256i order_;
#endif
};

}  // namespace LFM_LANE_SET
}  // namespace lfm
