// SPDX-License-Identifier: BSD-3-Clause
// Cosines of even order are symmetric about the middle of the side, those of odd order
// antisymmetric: sums over both, apart, give the upper and the lower half of the samples at once.
#include "encode/map_kernels.h"

#include "core/lanes.h"

namespace lfm::kernels {
namespace {

// kLanes vectors of one row of C B.
template <typename Lane, int kLanes>
LFM_INLINE void RowTimesBasis(const float* basis, int padded, const float* low, int used,
                              float* out) {
  constexpr int kLane = sizeof(Lane) / sizeof(float);
  Lane sum[kLanes] = {};
  for (int c = 0; c < used; ++c) {
    const float factor = low[c];
    if (factor == 0) continue;
    const float* row = basis + long{c} * padded;
    for (int l = 0; l < kLanes; ++l) sum[l] += factor * At<Lane>(row + l * kLane);
  }
  for (int l = 0; l < kLanes; ++l) At<Lane>(out + l * kLane) = sum[l];
}

// kLanes vectors of row y of the samples, and of the one that mirrors it.
template <typename Lane, int kLanes>
LFM_INLINE void TwoRows(const float* basis, int padded, int used, const float* rows, float* above,
                        float* below) {
  constexpr int kLane = sizeof(Lane) / sizeof(float);
  Lane even[kLanes] = {}, odd[kLanes] = {};
  for (int r = 0; r < used; r += 2) {
    const float factor = basis[long{r} * padded];
    const float* row = rows + long{r} * padded;
    for (int l = 0; l < kLanes; ++l) even[l] += factor * At<Lane>(row + l * kLane);
  }
  for (int r = 1; r < used; r += 2) {
    const float factor = basis[long{r} * padded];
    const float* row = rows + long{r} * padded;
    for (int l = 0; l < kLanes; ++l) odd[l] += factor * At<Lane>(row + l * kLane);
  }
  for (int l = 0; l < kLanes; ++l) {
    At<Lane>(above + l * kLane) = even[l] + odd[l];
    At<Lane>(below + l * kLane) = even[l] - odd[l];
  }
}

template <typename Lane, int kLanes>
LFM_INLINE void Columns(const float* basis, int side, const float* low, int used, int first,
                        float* scratch, float* samples) {
  const int padded = PaddedSide(side);
  for (int r = 0; r < used; ++r) {
    RowTimesBasis<Lane, kLanes>(basis + first, padded, low + long{r} * used, used,
                                scratch + long{r} * padded + first);
  }
  // In an odd side's middle the odd cosines are zero: below is above.
  for (int y = 0; 2 * y < side; ++y) {
    TwoRows<Lane, kLanes>(basis + y, padded, used, scratch + first,
                          samples + long{y} * padded + first,
                          samples + long{side - 1 - y} * padded + first);
  }
}

template <typename Lane>
LFM_INLINE void Inverse(const float* basis, int side, const float* low, int used, float* scratch,
                        float* samples) {
  constexpr int kLane = sizeof(Lane) / sizeof(float), kMany = 32 / kLane;
  const int padded = PaddedSide(side);
  int first = 0;
  for (; first + 32 <= padded; first += 32) {
    Columns<Lane, kMany>(basis, side, low, used, first, scratch, samples);
  }
  for (; first + 16 <= padded; first += 16) {
    Columns<Lane, kMany / 2>(basis, side, low, used, first, scratch, samples);
  }
  for (; first < padded; first += 8) {
    Columns<Lane, kMany / 4>(basis, side, low, used, first, scratch, samples);
  }
}

LFM_INLINE void QuantizeEight(const float* values, float factor, float bias, float steps,
                              uint8_t* codes) {
  const Float8 code = (At<Float8>(values) * factor - bias) * steps;
  const Float8 positive = code > 0 ? code : Float8{};  // of NaN too
  const Float8 bounded = positive < 255 ? positive : Float8{} + 255;
  *reinterpret_cast<Byte8*>(codes) =
      __builtin_convertvector(__builtin_convertvector(bounded + 0.5F, Int8), Byte8);
}

LFM_INLINE void QuantizeAll(const float* values, long count, float factor, float bias, float steps,
                            uint8_t* codes) {
  long i = 0;
  for (; i + 8 <= count; i += 8) QuantizeEight(values + i, factor, bias, steps, codes + i);
  if (i == count) return;
  // The rest through the same code: it must round alike.
  float rest[8] = {};
  uint8_t rest_codes[8];
  for (long k = i; k < count; ++k) rest[k - i] = values[k];
  QuantizeEight(rest, factor, bias, steps, rest_codes);
  for (long k = i; k < count; ++k) codes[k] = rest_codes[k - i];
}

struct Kernels {
  void (*inverse)(const float*, int, const float*, int, float*, float*);
  void (*quantize)(const float*, long, float, float, float, uint8_t*);
};

// The same bodies, compiled for one instruction set.
#define LFM_COMPILE_MAP_KERNELS(NAME, TARGET, LANE)                                     \
  TARGET void Inverse##NAME(const float* basis, int side, const float* low, int used,   \
                            float* scratch, float* samples) {                           \
    Inverse<LANE>(basis, side, low, used, scratch, samples);                            \
  }                                                                                     \
  TARGET void Quantize##NAME(const float* values, long count, float factor, float bias, \
                             float steps, uint8_t* codes) {                             \
    QuantizeAll(values, count, factor, bias, steps, codes);                             \
  }                                                                                     \
  constexpr Kernels k##NAME = {Inverse##NAME, Quantize##NAME};

LFM_COMPILE_MAP_KERNELS(Baseline, , Float4)
#if defined(__x86_64__)
LFM_COMPILE_MAP_KERNELS(Avx2, __attribute__((target("arch=x86-64-v3"))), Float8)
#endif

const Kernels& Best() {
#if defined(__x86_64__)
  static const Kernels& best = kernels::RunsLevel3() ? kAvx2 : kBaseline;
  return best;
#else
  return kBaseline;
#endif
}

}  // namespace

void InverseCosines(const float* basis, int side, const float* low, int used, float* scratch,
                    float* samples) {
  Best().inverse(basis, side, low, used, scratch, samples);
}

void QuantizeCodes(const float* values, long count, float factor, float bias, float steps,
                   uint8_t* codes) {
  Best().quantize(values, count, factor, bias, steps, codes);
}

}  // namespace lfm::kernels
