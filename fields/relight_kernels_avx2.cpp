// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relight_kernel_sets.h"

#ifdef LFM_RELIGHT_LEVELS
#include <immintrin.h>
#pragma GCC target("arch=x86-64-v3")
#include "fields/relight_kernel_body.h"

namespace lfm::kernels {
namespace {

struct Avx2 {
  using Lane = Float8;
  static constexpr int kWidth = 8;
  LFM_INLINE static Lane Half(const uint16_t* p) {
    return _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i_u*>(p)));
  }
  // Eight loads: the instruction that gathers is slower on the machines that have no more than this
  // set.
  template <typename Index>
  LFM_INLINE static Lane Gather(const float* table, const Index* i) {
    return Lane{table[i[0]], table[i[1]], table[i[2]], table[i[3]],
                table[i[4]], table[i[5]], table[i[6]], table[i[7]]};
  }
};

void WeighProducts(const GroupWeights& groups, int64_t first, int64_t count, const float* products,
                   int clusters, float* sums) {
  WeighProductsWith<Avx2>(groups, first, count, products, clusters, sums);
}
void AddResiduals(const GroupResiduals& groups, int64_t first, int64_t count, const float* light,
                  int most, float* sums) {
  AddResidualsWith<Avx2>(groups, first, count, light, most, sums);
}
void HalfProducts(const uint16_t* matrix, int64_t rows, int length, const float* light,
                  float* out) {
  HalfProductsWith<Avx2>(matrix, rows, length, light, out);
}

}  // namespace

const RelightKernels kRelightAvx2 = {WeighProducts, AddResiduals, HalfProducts};

}  // namespace lfm::kernels
#endif
