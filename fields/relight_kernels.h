// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// The hot loops of relighting (Yamada 2009, Equation 15), compiled for several instruction sets
/// and dispatched at run time. Plain pointers only. Results are the same from run to run and for
/// every number of threads on one instruction set; they differ in the last bits between instruction
/// sets.
namespace lfm::kernels {

/// Instruction sets: what every machine has, x86-64-v3 and x86-64-v4.
enum class RelightLevel { kBaseline, kAvx2, kAvx512 };
constexpr RelightLevel kRelightLevels[] = {RelightLevel::kBaseline, RelightLevel::kAvx2,
                                           RelightLevel::kAvx512};
const char* NameOf(RelightLevel level);
/// Whether this machine runs it, and this program has it.
bool Runs(RelightLevel level);
RelightLevel BestRelightLevel();

/// Rows of a group, which lie side by side: lane i of a group's vectors belongs to its row i.
constexpr int kGroupRows = 16;

/// Vectors of kGroupRows lanes, so many a group: group g has those from first[g] to first[g + 1].
/// Rows of a group that have fewer than another hold zeros.

/// What rows of one channel take of the products of their clusters.
struct GroupWeights {
  const uint16_t* cluster;  ///< a row
  const int64_t* first;     ///< groups + 1, in vectors
  const uint16_t* weights;  ///< float16, a vector a term
};

/// Residuals of the rows of one channel, from one rank to another.
struct GroupResiduals {
  const int64_t* first;           ///< groups + 1, in vectors
  const uint16_t* values;         ///< float16, a vector a residual
  const uint8_t* narrow_columns;  ///< theirs, in 8 bits; null where they need
  const uint16_t* wide_columns;   ///< 16
};

/// sums[i] (row i of group `first` on, `count` groups) =
///   sum_t weight[t] products[t * clusters + cluster]
void WeighProducts(RelightLevel level, const GroupWeights& groups, int64_t first, int64_t count,
                   const float* products, int clusters, float* sums);

/// sums[i] += sum_j value[j] light[column[j]], over the first `most` vectors of each group.
void AddResiduals(RelightLevel level, const GroupResiduals& groups, int64_t first, int64_t count,
                  const float* light, int most, float* sums);

/// out[f] = the dot product of row f of a float16 matrix with `light`, both of `length` numbers, a
/// multiple of kGroupRows.
void HalfProducts(RelightLevel level, const uint16_t* matrix, int64_t rows, int length,
                  const float* light, float* out);

}  // namespace lfm::kernels
