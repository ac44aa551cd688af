// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/lanes.h"
#include "fields/relight_kernels.h"

/// The loops of fields/relight_kernels.h over what an instruction set offers: `Set` has a `Lane` of
/// floats, Half() widens as many float16, and Gather() looks numbers up. Included by one file an
/// instruction set, which compiles everything here for it, so nothing may be shared.
namespace lfm::kernels {
namespace {

template <typename Set>
LFM_INLINE void WeighProductsWith(const GroupWeights& groups, int64_t first, int64_t count,
                                  const float* products, int clusters, float* sums) {
  using Lane = typename Set::Lane;
  constexpr int kLanes = kGroupRows / Set::kWidth;
  for (int64_t g = first; g < first + count; ++g, sums += kGroupRows) {
    Lane sum[kLanes] = {};
    const int64_t terms = groups.first[g + 1] - groups.first[g];
    const uint16_t* weights = groups.weights + groups.first[g] * kGroupRows;
    const uint16_t* cluster = groups.cluster + g * kGroupRows;
    for (int64_t t = 0; t < terms; ++t) {
      for (int l = 0; l < kLanes; ++l) {
        sum[l] += Set::Half(weights + t * kGroupRows + l * Set::kWidth) *
                  Set::Gather(products + t * clusters, cluster + l * Set::kWidth);
      }
    }
    for (int l = 0; l < kLanes; ++l) At<Lane>(sums + l * Set::kWidth) = sum[l];
  }
}

template <typename Set, typename Column>
LFM_INLINE void AddResidualsOf(const GroupResiduals& groups, const Column* all_columns,
                               int64_t first, int64_t count, const float* light, int most,
                               float* sums) {
  using Lane = typename Set::Lane;
  constexpr int kLanes = kGroupRows / Set::kWidth;
  for (int64_t g = first; g < first + count; ++g, sums += kGroupRows) {
    int64_t vectors = groups.first[g + 1] - groups.first[g];
    if (vectors > most) vectors = most;
    const uint16_t* values = groups.values + groups.first[g] * kGroupRows;
    const Column* columns = all_columns + groups.first[g] * kGroupRows;
    Lane sum[kLanes];
    for (int l = 0; l < kLanes; ++l) sum[l] = At<Lane>(sums + l * Set::kWidth);
    for (int64_t j = 0; j < vectors; ++j) {
      for (int l = 0; l < kLanes; ++l) {
        const int64_t at = j * kGroupRows + l * Set::kWidth;
        sum[l] += Set::Half(values + at) * Set::Gather(light, columns + at);
      }
    }
    for (int l = 0; l < kLanes; ++l) At<Lane>(sums + l * Set::kWidth) = sum[l];
  }
}

template <typename Set>
LFM_INLINE void AddResidualsWith(const GroupResiduals& groups, int64_t first, int64_t count,
                                 const float* light, int most, float* sums) {
  if (groups.narrow_columns != nullptr) {
    AddResidualsOf<Set>(groups, groups.narrow_columns, first, count, light, most, sums);
  } else {
    AddResidualsOf<Set>(groups, groups.wide_columns, first, count, light, most, sums);
  }
}

// Rows four at a time share the loads of the light.
template <typename Set, int kRows>
LFM_INLINE void DotRows(const uint16_t* matrix, int length, const float* light, float* out) {
  using Lane = typename Set::Lane;
  Lane sum[kRows] = {};
  for (int i = 0; i < length; i += Set::kWidth) {
    const Lane factor = At<Lane>(light + i);
    for (int r = 0; r < kRows; ++r) sum[r] += factor * Set::Half(matrix + long{r} * length + i);
  }
  for (int r = 0; r < kRows; ++r) {
    float total = 0;
    for (int i = 0; i < Set::kWidth; ++i) total += sum[r][i];
    out[r] = total;
  }
}

template <typename Set>
LFM_INLINE void HalfProductsWith(const uint16_t* matrix, int64_t rows, int length,
                                 const float* light, float* out) {
  constexpr int kTogether = 4;
  int64_t r = 0;
  for (; r + kTogether <= rows; r += kTogether) {
    DotRows<Set, kTogether>(matrix + r * length, length, light, out + r);
  }
  for (; r < rows; ++r) DotRows<Set, 1>(matrix + r * length, length, light, out + r);
}

}  // namespace
}  // namespace lfm::kernels
