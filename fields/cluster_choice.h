// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "fields/function_rows.h"
#include "fields/l1_solver.h"

// How rows find their clusters (Yamada 2009, Equation 14). Private to fields.

namespace lfm {

inline constexpr uint16_t kNoCluster = 0xffff;

/// For each row up to `per_row` clusters with its weights and L1 error there.
struct ClusterChoices {
  int per_row = 0, terms = 0;
  std::vector<uint16_t> cluster;  ///< rows x per_row; kNoCluster: nothing there
  std::vector<float> error;       ///< rows x per_row: sum |E|; infinite where nothing is
  std::vector<float> weights;     ///< rows x per_row x terms; 0 beyond a cluster's own terms

  int64_t rows() const { return per_row == 0 ? 0 : static_cast<int64_t>(cluster.size()) / per_row; }
  /// The place of the row's least error, the first of equals.
  int Best(int64_t row) const;
};

/// Bases stacked and orthonormalised, to tell quickly how much of a row's energy each explains.
class ClusterRanking {
 public:
  /// `terms` is the most that a basis has; a basis without rows is never chosen.
  explicit ClusterRanking(const std::vector<FunctionRows>& bases);

  /// For every row the clusters that explain most of its energy (least squares), best first, of
  /// those that it may join; `keep`, unless kNoCluster, is among them whatever it explains.
  /// `allowed(row)`: the clusters a row may join; a null function: all.
  ClusterChoices Rank(RowsView rows, int per_row, const std::vector<uint16_t>& keep,
                      const std::function<std::span<const uint16_t>(int64_t)>& allowed) const;

 private:
  void ScoreAll(RowsView rows, int64_t begin, int64_t end, std::vector<float>& scores) const;
  float Score(const float* row, uint16_t cluster) const;

  int columns_ = 0, terms_ = 0;
  std::vector<int> first_;  // a cluster: of its functions in stacked_; one more at the end
  FunctionRows stacked_;
};

/// Solves every choice for its weights of least absolute error.
void SolveChoices(RowsView rows, const std::vector<FunctionRows>& bases, const L1Options& l1,
                  ClusterChoices& choices);

}  // namespace lfm
