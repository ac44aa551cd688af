// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cluster_neighbourhoods.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"

namespace lfm {
namespace {

void AddNew(std::vector<uint16_t>& some, uint16_t cluster) {
  if (std::find(some.begin(), some.end(), cluster) == some.end()) some.push_back(cluster);
}

}  // namespace

ClusterNeighbourhoods::ClusterNeighbourhoods(const Field& field, const CoarseField& coarse)
    : field_(field), coarse_(coarse) {}

int64_t ClusterNeighbourhoods::CellRow(int64_t row) const {
  return row / field_.points * coarse_.cells + coarse_.cell[row % field_.points];
}

std::span<const uint16_t> ClusterNeighbourhoods::Of(int64_t row) const {
  const std::vector<uint16_t>& near = near_[CellRow(row)];
  return near.empty() ? all_ : near;
}

void ClusterNeighbourhoods::Spread(const std::vector<std::vector<uint16_t>>& in_cell,
                                   size_t clusters) {
  all_.resize(clusters);
  std::iota(all_.begin(), all_.end(), uint16_t{0});
  near_.assign(in_cell.size(), {});
  ParallelFor(
      0, static_cast<int64_t>(near_.size()),
      [&](int64_t row) {
        const int64_t channel = row / coarse_.cells, cell = row % coarse_.cells;
        for (int c = 0; c < field_.channels; ++c) {
          const int64_t base = (channel + c) % field_.channels * coarse_.cells;
          for (int64_t i = coarse_.first[cell]; i < coarse_.first[cell + 1]; ++i) {
            for (uint16_t k : in_cell[base + coarse_.neighbours[i]]) AddNew(near_[row], k);
          }
        }
      },
      64);
}

void ClusterNeighbourhoods::SetFromCells(const std::vector<int64_t>& rows,
                                         const std::vector<uint16_t>& cluster, size_t clusters) {
  std::vector<std::vector<uint16_t>> in_cell(static_cast<size_t>(field_.channels * coarse_.cells));
  for (size_t i = 0; i < rows.size(); ++i) in_cell[rows[i]].push_back(cluster[i]);
  Spread(in_cell, clusters);
}

void ClusterNeighbourhoods::SetFromRows(const std::vector<int64_t>& rows,
                                        const std::vector<uint16_t>& cluster, size_t clusters) {
  std::vector<std::vector<uint16_t>> in_cell(static_cast<size_t>(field_.channels * coarse_.cells));
  for (size_t i = 0; i < rows.size(); ++i) AddNew(in_cell[CellRow(rows[i])], cluster[i]);
  Spread(in_cell, clusters);
}

}  // namespace lfm
