// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relight_kernels.h"

#include "core/lanes.h"
#include "fields/relight_kernel_body.h"
#include "fields/relight_kernel_sets.h"

namespace lfm::kernels {
namespace {

// Float16 by integers: shifted into place, an exponent is too small by 112, which a product makes
// good for subnormal numbers too. There are no infinities.
struct Baseline {
  using Lane = Float4;
  static constexpr int kWidth = 4;
  LFM_INLINE static Lane Half(const uint16_t* p) {
    using Int4 = int32_t __attribute__((vector_size(16), may_alias));
    const Int4 bits = {p[0], p[1], p[2], p[3]};
    const Int4 magnitude = (bits & 0x7fff) << 13, sign = (bits & 0x8000) << 16;
    const Float4 value = reinterpret_cast<const Float4&>(magnitude) * 0x1p112f;
    const Int4 result = reinterpret_cast<const Int4&>(value) | sign;
    return reinterpret_cast<const Float4&>(result);
  }
  template <typename Index>
  LFM_INLINE static Lane Gather(const float* table, const Index* i) {
    return Lane{table[i[0]], table[i[1]], table[i[2]], table[i[3]]};
  }
};

void WeighProductsBaseline(const GroupWeights& groups, int64_t first, int64_t count,
                           const float* products, int clusters, float* sums) {
  WeighProductsWith<Baseline>(groups, first, count, products, clusters, sums);
}
void AddResidualsBaseline(const GroupResiduals& groups, int64_t first, int64_t count,
                          const float* light, int most, float* sums) {
  AddResidualsWith<Baseline>(groups, first, count, light, most, sums);
}
void HalfProductsBaseline(const uint16_t* matrix, int64_t rows, int length, const float* light,
                          float* out) {
  HalfProductsWith<Baseline>(matrix, rows, length, light, out);
}
constexpr RelightKernels kBaseline = {WeighProductsBaseline, AddResidualsBaseline,
                                      HalfProductsBaseline};

const RelightKernels& KernelsOf(RelightLevel level) {
#ifdef LFM_RELIGHT_LEVELS
  if (level == RelightLevel::kAvx2) return kRelightAvx2;
  if (level == RelightLevel::kAvx512) return kRelightAvx512;
#endif
  return kBaseline;
}

}  // namespace

const char* NameOf(RelightLevel level) {
  return level == RelightLevel::kAvx512 ? "x86-64-v4"
         : level == RelightLevel::kAvx2 ? "x86-64-v3"
                                        : "baseline";
}

bool Runs(RelightLevel level) {
#ifdef LFM_RELIGHT_LEVELS
  if (level == RelightLevel::kAvx512) return RunsLevel4();
  if (level == RelightLevel::kAvx2) return RunsLevel3();
#endif
  return level == RelightLevel::kBaseline;
}

RelightLevel BestRelightLevel() {
  static const RelightLevel best = Runs(RelightLevel::kAvx512) ? RelightLevel::kAvx512
                                   : Runs(RelightLevel::kAvx2) ? RelightLevel::kAvx2
                                                               : RelightLevel::kBaseline;
  return best;
}

void WeighProducts(RelightLevel level, const GroupWeights& groups, int64_t first, int64_t count,
                   const float* products, int clusters, float* sums) {
  KernelsOf(level).weigh(groups, first, count, products, clusters, sums);
}

void AddResiduals(RelightLevel level, const GroupResiduals& groups, int64_t first, int64_t count,
                  const float* light, int most, float* sums) {
  KernelsOf(level).add(groups, first, count, light, most, sums);
}

void HalfProducts(RelightLevel level, const uint16_t* matrix, int64_t rows, int length,
                  const float* light, float* out) {
  KernelsOf(level).half_products(matrix, rows, length, light, out);
}

}  // namespace lfm::kernels
