// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fields/coarse_field.h"
#include "fields/field.h"

namespace lfm {

/// The clusters that a row may join: those of its cell at low resolution and of the cells around,
/// its own channel's first, then the other channels' (Yamada 2009, Section 3.3). All clusters,
/// where there are none. Private to fields; `field` and `coarse` must outlive it.
class ClusterNeighbourhoods {
 public:
  ClusterNeighbourhoods(const Field& field, const CoarseField& coarse);

  /// From the low resolution: the cluster of each of `rows` of the coarse field.
  void SetFromCells(const std::vector<int64_t>& rows, const std::vector<uint16_t>& cluster,
                    size_t clusters);
  /// From the full: the cluster of each of `rows` of the field.
  void SetFromRows(const std::vector<int64_t>& rows, const std::vector<uint16_t>& cluster,
                   size_t clusters);

  std::span<const uint16_t> Of(int64_t row) const;

 private:
  int64_t CellRow(int64_t row) const;
  void Spread(const std::vector<std::vector<uint16_t>>& in_cell, size_t clusters);

  const Field& field_;
  const CoarseField& coarse_;
  std::vector<std::vector<uint16_t>> near_;  // a channel and cell
  std::vector<uint16_t> all_;
};

}  // namespace lfm
