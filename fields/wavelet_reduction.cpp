// SPDX-License-Identifier: BSD-3-Clause
#include "fields/wavelet_reduction.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr float kHalfRoot = 0.70710678f;

// Samples `step` apart; scratch holds `length`.
void ForwardLine(float* line, int length, int64_t step, float* scratch) {
  const int pairs = length / 2, low = length - pairs;
  for (int i = 0; i < pairs; ++i) {
    const float a = line[2 * i * step], b = line[(2 * i + 1) * step];
    scratch[i] = (a + b) * kHalfRoot;
    scratch[low + i] = (a - b) * kHalfRoot;
  }
  if (low > pairs) scratch[pairs] = line[(length - 1) * step];
  for (int i = 0; i < length; ++i) line[i * step] = scratch[i];
}

void InverseLine(float* line, int length, int64_t step, float* scratch) {
  const int pairs = length / 2, low = length - pairs;
  for (int i = 0; i < pairs; ++i) {
    const float a = line[i * step], b = line[(low + i) * step];
    scratch[2 * i] = (a + b) * kHalfRoot;
    scratch[2 * i + 1] = (a - b) * kHalfRoot;
  }
  if (low > pairs) scratch[length - 1] = line[pairs * step];
  for (int i = 0; i < length; ++i) line[i * step] = scratch[i];
}

struct Level {
  int height, width;
};

std::vector<Level> LevelsOf(const ColumnGrid& grid) {
  std::vector<Level> levels;
  for (Level level = {grid.height, grid.width}; level.height > 1 || level.width > 1;
       level = {(level.height + 1) / 2, (level.width + 1) / 2}) {
    levels.push_back(level);
  }
  return levels;
}

void RequireGrid(RowsView rows, const ColumnGrid& grid) {
  if (grid.faces < 1 || grid.height < 1 || grid.width < 1 || grid.columns() != rows.columns) {
    throw Error("a grid of " + std::to_string(grid.faces) + " x " + std::to_string(grid.height) +
                " x " + std::to_string(grid.width) + " does not have " +
                std::to_string(rows.columns) + " columns");
  }
}

std::vector<double> CoefficientEnergies(RowsView rows, const ColumnGrid& grid) {
  constexpr int64_t kChunk = 512;
  std::vector<std::vector<double>> sums(static_cast<size_t>((rows.rows + kChunk - 1) / kChunk));
  ParallelChunks(rows.rows, kChunk, [&](int64_t begin, int64_t end, int64_t chunk) {
    std::vector<float> row(static_cast<size_t>(rows.columns));
    sums[chunk].resize(row.size());
    for (int64_t i = begin; i < end; ++i) {
      std::copy_n(rows.Row(i), rows.columns, row.data());
      TransformHaar(grid, row.data());
      for (size_t j = 0; j < row.size(); ++j) sums[chunk][j] += double{row[j]} * row[j];
    }
  });
  std::vector<double> energies(static_cast<size_t>(rows.columns));
  for (const std::vector<double>& sum : sums) {
    for (size_t j = 0; j < energies.size(); ++j) energies[j] += sum[j];
  }
  return energies;
}

}  // namespace

ColumnGrid GridOfColumns(int columns) {
  const int side = static_cast<int>(std::lround(std::sqrt(columns / 6.0)));
  if (side > 1 && 6 * side * side == columns) return {6, side, side};
  return {1, 1, columns};
}

void TransformHaar(const ColumnGrid& grid, float* row) {
  std::vector<float> scratch(static_cast<size_t>(std::max(grid.height, grid.width)));
  const std::vector<Level> levels = LevelsOf(grid);
  for (int face = 0; face < grid.faces; ++face, row += int64_t{grid.height} * grid.width) {
    for (const Level& level : levels) {
      for (int y = 0; y < level.height; ++y) {
        ForwardLine(row + int64_t{y} * grid.width, level.width, 1, scratch.data());
      }
      for (int x = 0; x < level.width; ++x) {
        ForwardLine(row + x, level.height, grid.width, scratch.data());
      }
    }
  }
}

void InvertHaar(const ColumnGrid& grid, float* row) {
  std::vector<float> scratch(static_cast<size_t>(std::max(grid.height, grid.width)));
  const std::vector<Level> levels = LevelsOf(grid);
  for (int face = 0; face < grid.faces; ++face, row += int64_t{grid.height} * grid.width) {
    for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
      for (int x = 0; x < level->width; ++x) {
        InverseLine(row + x, level->height, grid.width, scratch.data());
      }
      for (int y = 0; y < level->height; ++y) {
        InverseLine(row + int64_t{y} * grid.width, level->width, 1, scratch.data());
      }
    }
  }
}

WaveletReduction ReduceByWavelets(RowsView rows, const ColumnGrid& grid, int coefficients) {
  RequireGrid(rows, grid);
  if (coefficients < 1) throw Error("at least one wavelet coefficient must be kept");
  const std::vector<double> energies = CoefficientEnergies(rows, grid);
  const double total = std::accumulate(energies.begin(), energies.end(), 0.0);
  if (!std::isfinite(total)) RequireFinite(rows, "rows to be transformed");
  WaveletReduction result;
  result.kept.resize(energies.size());
  std::iota(result.kept.begin(), result.kept.end(), 0);
  std::stable_sort(result.kept.begin(), result.kept.end(),
                   [&](int a, int b) { return energies[a] > energies[b]; });
  result.kept.resize(std::min(energies.size(), static_cast<size_t>(coefficients)));
  std::sort(result.kept.begin(), result.kept.end());
  double kept = 0;
  for (const int j : result.kept) kept += energies[j];
  if (total > 0) result.kept_share = kept / total;
  result.rows = MakeFunctionRows(rows.rows, static_cast<int>(result.kept.size()));
  ParallelChunks(rows.rows, 64, [&](int64_t begin, int64_t end, int64_t) {
    std::vector<float> row(static_cast<size_t>(rows.columns));
    for (int64_t i = begin; i < end; ++i) {
      std::copy_n(rows.Row(i), rows.columns, row.data());
      TransformHaar(grid, row.data());
      float* out = result.rows.Row(i);
      for (size_t j = 0; j < result.kept.size(); ++j) out[j] = row[result.kept[j]];
    }
  });
  return result;
}

}  // namespace lfm
