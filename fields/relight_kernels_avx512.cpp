// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relight_kernel_sets.h"

#ifdef LFM_RELIGHT_LEVELS
#include <immintrin.h>
// GCC 12 takes the intrinsics' own undefined operands for faults of ours (its bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC target("arch=x86-64-v4")
#include "fields/relight_kernel_body.h"

namespace lfm::kernels {
namespace {

struct Avx512 {
  using Lane = Float16;
  static constexpr int kWidth = 16;
  LFM_INLINE static Lane Half(const uint16_t* p) {
    return _mm512_cvtph_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(p)));
  }
  LFM_INLINE static Lane Gather(const float* table, const uint8_t* i) {
    return Look(table,
                _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i_u*>(i))));
  }
  LFM_INLINE static Lane Gather(const float* table, const uint16_t* i) {
    return Look(table,
                _mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(i))));
  }

 private:
  LFM_INLINE static Lane Look(const float* table, __m512i indices) {
    return _mm512_i32gather_ps(indices, table, 4);
  }
};

void WeighProducts(const GroupWeights& groups, int64_t first, int64_t count, const float* products,
                   int clusters, float* sums) {
  WeighProductsWith<Avx512>(groups, first, count, products, clusters, sums);
}
void AddResiduals(const GroupResiduals& groups, int64_t first, int64_t count, const float* light,
                  int most, float* sums) {
  AddResidualsWith<Avx512>(groups, first, count, light, most, sums);
}
void HalfProducts(const uint16_t* matrix, int64_t rows, int length, const float* light,
                  float* out) {
  HalfProductsWith<Avx512>(matrix, rows, length, light, out);
}

}  // namespace

const RelightKernels kRelightAvx512 = {WeighProducts, AddResiduals, HalfProducts};

}  // namespace lfm::kernels
#endif
