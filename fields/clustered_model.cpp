// SPDX-License-Identifier: BSD-3-Clause
#include "fields/clustered_model.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

void CheckRow(const ClusteredModel& model, int64_t row) {
  const auto fail = [row](const char* what) {
    throw Error("clustered model: row " + std::to_string(row) + " " + what);
  };
  if (model.cluster[row] >= model.bases.size()) fail("belongs to a cluster that is not there");
  const int64_t first = model.first_weight[row];
  const auto weights = static_cast<int64_t>(model.weights.size());
  if (first < 0 || first > weights || model.Terms(row) > weights - first) fail("lacks weights");
  if (model.first_residual.empty()) return;
  const int64_t begin = model.first_residual[row], end = model.first_residual[row + 1];
  if (begin < 0 || end < begin || end > static_cast<int64_t>(model.residual_value.size())) {
    fail("has residuals that are not there");
  }
  if (end - begin > model.columns) fail("has more residuals than columns");
  for (int64_t i = begin; i < end; ++i) {
    if (model.residual_column[i] >= model.columns) fail("has a residual beyond its columns");
  }
}

bool AllFinite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

void CheckModel(const ClusteredModel& model) {
  const auto rows = static_cast<size_t>(model.rows);
  if (model.rows < 0 || model.cluster.size() != rows || model.first_weight.size() != rows ||
      model.residual_column.size() != model.residual_value.size() ||
      (!model.first_residual.empty() && model.first_residual.size() != rows + 1)) {
    throw Error("clustered model: its tables do not fit together");
  }
  for (const FunctionRows& basis : model.bases) {
    if (basis.rows > 0 && basis.columns != model.columns) {
      throw Error("clustered model: a basis has another number of columns");
    }
    if (basis.rows > model.columns) {
      throw Error("clustered model: a basis has more functions than columns");
    }
    if (!AllFinite(basis.values)) throw Error("clustered model: a basis is not finite");
  }
  for (int64_t row = 0; row < model.rows; ++row) CheckRow(model, row);
  if (!AllFinite(model.weights) || !AllFinite(model.residual_value)) {
    throw Error("clustered model: a weight or residual is not finite");
  }
}

void EvaluateRow(const ClusteredModel& model, int64_t row, int residuals, float* out) {
  const FunctionRows& basis = model.bases[model.cluster[row]];
  const float* weights = model.weights.data() + model.first_weight[row];
  std::fill_n(out, model.columns, 0.0f);
  for (int64_t t = 0; t < basis.rows; ++t) {
    const float* function = basis.Row(t);
    for (int i = 0; i < model.columns; ++i) out[i] += weights[t] * function[i];
  }
  if (model.first_residual.empty()) return;
  const int64_t begin = model.first_residual[row];
  int64_t end = model.first_residual[row + 1];
  if (residuals >= 0) end = std::min(end, begin + residuals);
  for (int64_t i = begin; i < end; ++i) out[model.residual_column[i]] += model.residual_value[i];
}

double RelativeError(const ClusteredModel& model, RowsView truth, int residuals,
                     const std::vector<int64_t>& which) {
  if (truth.rows != model.rows || truth.columns != model.columns) {
    throw Error("clustered model: compared with a matrix of another size");
  }
  const int64_t count = which.empty() ? model.rows : static_cast<int64_t>(which.size());
  constexpr int64_t kChunk = 256;
  const auto chunks = static_cast<size_t>((count + kChunk - 1) / kChunk);
  std::vector<double> sums(chunks);
  std::vector<int64_t> counted(chunks);
  ParallelChunks(count, kChunk, [&](int64_t begin, int64_t end, int64_t chunk) {
    std::vector<float> row_values(static_cast<size_t>(model.columns));
    for (int64_t i = begin; i < end; ++i) {
      const int64_t row = which.empty() ? i : which[i];
      const float* true_row = truth.Row(row);
      EvaluateRow(model, row, residuals, row_values.data());
      double difference = 0, energy = 0;
      for (int j = 0; j < model.columns; ++j) {
        const double d = double{true_row[j]} - row_values[j];
        difference += d * d;
        energy += double{true_row[j]} * true_row[j];
      }
      if (energy <= 0) continue;
      sums[chunk] += difference / energy;
      ++counted[chunk];
    }
  });
  double sum = 0;
  int64_t rows = 0;
  for (size_t i = 0; i < chunks; ++i) {
    sum += sums[i];
    rows += counted[i];
  }
  return rows == 0 ? 0 : sum / static_cast<double>(rows);
}

}  // namespace lfm
