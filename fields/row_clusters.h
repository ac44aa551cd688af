// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "fields/cluster_choice.h"
#include "fields/function_rows.h"
#include "fields/sparse_factorization.h"

// Rows in clusters, while they are being factorised (Yamada 2009, Section 3.3). Private to fields.

namespace lfm {

/// The rows that take part: those with energy.
struct ActiveRows {
  RowsView all;
  std::vector<int64_t> which;

  int64_t count() const { return static_cast<int64_t>(which.size()); }
  FunctionRows Gather(std::span<const int64_t> active) const;  ///< by number among the active
};
/// Every row with a number other than zero.
ActiveRows RowsWithEnergy(RowsView all);

/// Where every active row is, and where else it might be.
struct RowClusters {
  int terms = 0;                  ///< the most that a cluster may have
  std::vector<uint16_t> cluster;  ///< an active row
  std::vector<float> error;       ///< an active row: sum |E|
  std::vector<float> weights;     ///< active rows x terms
  int alternatives = 0;
  std::vector<uint16_t> other;     ///< active rows x alternatives; kNoCluster: nothing there
  std::vector<float> other_error;  ///< the same: sum |E| there

  double TotalError() const;
};

/// The active rows of each cluster, ascending.
std::vector<std::vector<int64_t>> MembersOf(const RowClusters& rows, size_t clusters);

/// Clusters that an active row may join; a null function: all.
using AllowedClusters = std::function<std::span<const uint16_t>(int64_t active)>;

struct ClusterChoiceOptions {
  int terms = 4;         ///< room for the weights of so many; no basis has more
  int alternatives = 8;  ///< clusters that a row is tried in
  L1Options l1;
};

/// Puts every row where its L1 error is least among the clusters that explain most of its energy
/// and the one it is in (Equation 14). `now`: that one; empty: none. Works in blocks of rows;
/// advances `progress` by rows.
RowClusters ChooseClusters(const ActiveRows& rows, const std::vector<FunctionRows>& bases,
                           const std::vector<uint16_t>& now, const AllowedClusters& allowed,
                           const ClusterChoiceOptions& options, Progress& progress);

/// A basis for these members (at least one) from nothing, with a function at least.
SparseFactors FactorizeMembers(const ActiveRows& rows, std::span<const int64_t> members,
                               const SparseFactorizationOptions& options);
/// Every cluster's basis anew with its members' weights as they stand: Equation 7 for the columns
/// of F. Functions get unit L2 norm; those of no use are dropped, but
/// a cluster with members keeps what it had when none is of use.
std::vector<FunctionRows> RefitBases(const ActiveRows& rows, const RowClusters& clusters,
                                     const std::vector<FunctionRows>& bases, const L1Options& l1);

}  // namespace lfm
