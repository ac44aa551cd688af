// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "encode/codebook_iteration.h"

namespace lfm {

/// The order in which pairs of cells become one (Equitz 1989): the pair first whose union raises
/// the distortion least,
///
///   sum_s W_a,s W_b,s / (W_a,s + W_b,s) |y_a,s - y_b,s|^2,
///
/// measured on the 16 leading principal components of each segment (the order is a start; what it
/// misses the Lloyd iteration mends). Above 4096 vectors, cells of the splitting start are merged.
class PairwiseMerging {
 public:
  explicit PairwiseMerging(const CodebookIteration& iteration);
  /// The cells when there are `codes` of them (or as many as there were in the beginning, if less).
  Codebook Cells(int codes) const;

 private:
  struct Merge {
    int kept = 0, gone = 0;
  };
  const CodebookIteration& iteration_;
  std::vector<int> first_cells_;  // of each vector
  int first_count_ = 0;
  std::vector<Merge> merges_;
};

}  // namespace lfm
