// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Vectors of the Gray kernel: the compiler's own, and instructions by name where it does not find
// them. Compiled once for each instruction set, so all of it is without linkage.
#include <cstdint>
#include <cstring>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

#define LFM_INLINE [[gnu::always_inline]] inline

namespace lfm::kernels {
namespace {

// Where registers are narrower, the compiler takes several for one.
constexpr int kVectorBytes = 32;
using Bytes = uint8_t __attribute__((vector_size(kVectorBytes)));
using ByteMask = int8_t __attribute__((vector_size(kVectorBytes)));
using Floats = float __attribute__((vector_size(kVectorBytes)));
using Ints = int32_t __attribute__((vector_size(kVectorBytes)));

template <typename T>
struct VectorsOf;
template <>
struct VectorsOf<uint8_t> {
  using Values = Bytes;
  using Mask = ByteMask;
};
template <>
struct VectorsOf<float> {
  using Values = Floats;
  using Mask = Ints;
};

constexpr int kFloatLanes = kVectorBytes / 4;

/// The first `count` lanes from memory; the rest are 0.
template <typename V, typename T>
LFM_INLINE V Load(const T* from, int count = static_cast<int>(sizeof(V) / sizeof(T))) {
  V v{};
  std::memcpy(&v, from, static_cast<size_t>(count) * sizeof(T));
  return v;
}

template <typename V, typename T>
LFM_INLINE void Store(const V& v, T* to) {
  std::memcpy(to, &v, sizeof(V));
}

LFM_INLINE Bytes Max(Bytes a, Bytes b) { return a > b ? a : b; }
LFM_INLINE Bytes Min(Bytes a, Bytes b) { return a > b ? b : a; }

/// Masks have all or none of a lane's bits set.
#if defined(__AVX2__)

LFM_INLINE Bytes Select(ByteMask mask, Bytes a, Bytes b) {
  return Bytes(_mm256_blendv_epi8(__m256i(b), __m256i(a), __m256i(mask)));
}
LFM_INLINE Floats Select(Ints mask, Floats a, Floats b) {
  return _mm256_blendv_ps(b, a, _mm256_castsi256_ps(__m256i(mask)));
}
/// b where either is not a number.
LFM_INLINE Floats Max(Floats a, Floats b) { return _mm256_max_ps(a, b); }
LFM_INLINE Floats Min(Floats a, Floats b) { return _mm256_min_ps(a, b); }
LFM_INLINE Floats Sqrt(Floats x) { return _mm256_sqrt_ps(x); }
LFM_INLINE Ints Whole(const uint8_t* from) {
  return Ints(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from))));
}
LFM_INLINE Ints MaskOf(const uint8_t* from) {
  return Ints(_mm256_cvtepi8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from))));
}
LFM_INLINE Ints Whole(const uint16_t* from) {
  return Ints(_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from))));
}

#else

LFM_INLINE Bytes Select(ByteMask mask, Bytes a, Bytes b) {
  return (a & Bytes(mask)) | (b & ~Bytes(mask));
}
LFM_INLINE Floats Select(Ints mask, Floats a, Floats b) {
  return Floats((Ints(a) & mask) | (Ints(b) & ~mask));
}
LFM_INLINE Floats Max(Floats a, Floats b) { return a > b ? a : b; }
LFM_INLINE Floats Min(Floats a, Floats b) { return a < b ? a : b; }
LFM_INLINE Floats Sqrt(Floats x) {
  for (int i = 0; i < kFloatLanes; ++i) x[i] = __builtin_sqrtf(x[i]);
  return x;
}
template <typename N>
LFM_INLINE Ints Whole(const N* from) {
  Ints whole;
  for (int i = 0; i < kFloatLanes; ++i) whole[i] = from[i];
  return whole;
}
LFM_INLINE Ints MaskOf(const uint8_t* from) { return -(Whole(from) & 1); }

#endif

LFM_INLINE Floats Values(const uint8_t* from) {
  return __builtin_convertvector(Whole(from), Floats);
}
LFM_INLINE Floats Values(const float* from) { return Load<Floats>(from); }

LFM_INLINE Floats Only(Ints where, Floats x) { return Floats(Ints(x) & where); }
LFM_INLINE Floats FlipSign(Floats x, Ints sign) { return Floats(Ints(x) ^ sign); }
LFM_INLINE Floats Abs(Floats x) { return Floats(Ints(x) & 0x7fffffff); }

LFM_INLINE Floats AtMost(Floats x, float most) { return Min(x, most + Floats{}); }

LFM_INLINE void StoreBytes(ByteMask mask, uint8_t* to) { Store(mask, to); }
LFM_INLINE void StoreBytes(Ints mask, uint8_t* to) {
  for (int i = 0; i < kFloatLanes; ++i) to[i] = static_cast<uint8_t>(mask[i]);
}
LFM_INLINE void StoreWords(ByteMask low, ByteMask high, uint16_t* to) {
  uint8_t l[kVectorBytes], h[kVectorBytes];
  Store(low, l);
  Store(high, h);
  for (int i = 0; i < kVectorBytes; ++i) to[i] = static_cast<uint16_t>(l[i] | (h[i] << 8));
}
LFM_INLINE void StoreWords(Ints whole, uint16_t* to) {
  for (int i = 0; i < kFloatLanes; ++i) to[i] = static_cast<uint16_t>(whole[i]);
}

/// table[index[i] modulo 16] for each lane.
LFM_INLINE Floats LookUp(const float (&table)[16], Ints index) {
#if defined(__AVX2__)
  // Entries stay in registers; gathering is slow on many processors.
  const Floats low = _mm256_permutevar8x32_ps(_mm256_load_ps(table), __m256i(index));
  const Floats high = _mm256_permutevar8x32_ps(_mm256_load_ps(table + 8), __m256i(index));
  return Select(index << 28, high, low);
#else
  Floats found;
  for (int i = 0; i < kFloatLanes; ++i) found[i] = table[index[i] & 15];
  return found;
#endif
}

}  // namespace
}  // namespace lfm::kernels
