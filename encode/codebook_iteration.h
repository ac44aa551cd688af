// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "encode/vector_quantization.h"

namespace lfm {

/// The generalised Lloyd iteration over one set of vectors, and the state that its starts share.
class CodebookIteration {
 public:
  explicit CodebookIteration(const WeightedVectors& vectors);

  /// The best single code.
  Codebook OneCode() const;
  /// The codebook of given cells: every index in [0, codes) used at least once.
  Codebook FromCells(std::vector<int> indices, int codes) const;
  /// Splits the cells with the largest distortion until there are `codes`, or nothing is left to
  /// split.
  Codebook Split(Codebook book, int codes) const;
  /// Nearest codes, empty cells filled, codes to centroids; at most `iterations` times.
  Codebook Improve(Codebook book, int iterations, double tolerance) const;

  const WeightedVectors& vectors() const { return vectors_; }

 private:
  double Distance(int64_t vector, const float* code) const;
  std::vector<double> Distances(const Codebook& book) const;
  void Assign(Codebook& book) const;
  void FillEmptyCells(Codebook& book) const;
  void MoveToCentroids(Codebook& book) const;
  std::vector<double> MainAxis(const std::vector<int>& members, const float* code) const;
  bool SplitCell(Codebook& book, int code, const std::vector<int>& members) const;

  const WeightedVectors& vectors_;
  std::vector<float> mean_;    // D
  std::vector<float> scaled_;  // count x (D + S): weight * (value - mean), then the weights
};

/// The vectors of each cell, ascending.
std::vector<std::vector<int>> CellMembers(const Codebook& book);

}  // namespace lfm
