// SPDX-License-Identifier: BSD-3-Clause
#include "fields/global_basis.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/matrix_products.h"
#include "fields/matrix_terms.h"

namespace lfm {
namespace {

// Sums of squared weights, a cluster and function.
std::vector<std::vector<double>> WeightEnergies(const ClusteredModel& model) {
  std::vector<std::vector<double>> energies;
  for (const FunctionRows& basis : model.bases) {
    energies.emplace_back(static_cast<size_t>(basis.rows));
  }
  for (int64_t row = 0; row < model.rows; ++row) {
    std::vector<double>& of_cluster = energies[model.cluster[row]];
    const float* weights = model.weights.data() + model.first_weight[row];
    for (size_t t = 0; t < of_cluster.size(); ++t) {
      of_cluster[t] += double{weights[t]} * weights[t];
    }
  }
  return energies;
}

FunctionRows WeighedStack(const ClusteredModel& model) {
  const std::vector<std::vector<double>> energies = WeightEnergies(model);
  int64_t count = 0;
  for (const FunctionRows& basis : model.bases) count += basis.rows;
  FunctionRows stack = MakeFunctionRows(count, model.columns);
  int64_t row = 0;
  for (size_t c = 0; c < model.bases.size(); ++c) {
    for (int64_t t = 0; t < model.bases[c].rows; ++t, ++row) {
      const double length = std::sqrt(energies[c][t]);
      for (int j = 0; j < model.columns; ++j) {
        stack.Row(row)[j] = static_cast<float>(length * model.bases[c].Row(t)[j]);
      }
    }
  }
  return stack;
}

GlobalBasis InFunctions(const ClusteredModel& model, FunctionRows functions) {
  GlobalBasis global;
  global.functions = std::move(functions);
  for (const FunctionRows& basis : model.bases) {
    const bool empty = basis.rows == 0 || global.functions.rows == 0;
    global.local.push_back(empty ? MakeFunctionRows(0, model.columns)
                                 : TimesTransposed(basis.View(), global.functions.View()));
  }
  return global;
}

GlobalBasis FromRows(const ClusteredModel& model, RowsView rows,
                     const GlobalBasisOptions& options) {
  const TermsOptions terms = {.max_terms = options.max_terms, .energy_share = options.energy_share};
  return InFunctions(model, TermsOf(rows, terms).functions);
}

// matrix times vector.
std::vector<float> Applied(RowsView matrix, const float* vector) {
  std::vector<float> result(static_cast<size_t>(matrix.rows));
  for (int64_t row = 0; row < matrix.rows; ++row) {
    const float* values = matrix.Row(row);
    float sums[16] = {};
    int j = 0;
    for (; j + 16 <= matrix.columns; j += 16) {
      for (int i = 0; i < 16; ++i) sums[i] += values[j + i] * vector[j + i];
    }
    float sum = 0;
    for (; j < matrix.columns; ++j) sum += values[j] * vector[j];
    for (const float part : sums) sum += part;
    result[row] = sum;
  }
  return result;
}

std::vector<float> FromLocal(const ClusteredModel& model,
                             const std::vector<std::vector<float>>& local) {
  std::vector<float> radiance(static_cast<size_t>(model.rows));
  ParallelFor(
      0, model.rows,
      [&](int64_t row) {
        const std::vector<float>& lit = local[model.cluster[row]];
        const float* weights = model.weights.data() + model.first_weight[row];
        float sum = 0;
        for (size_t t = 0; t < lit.size(); ++t) sum += weights[t] * lit[t];
        radiance[row] = sum;
      },
      4096);
  return radiance;
}

void RequireLight(const ClusteredModel& model, const std::vector<float>& light) {
  if (static_cast<int>(light.size()) != model.columns) {
    throw Error("the light has another number of directions than the model");
  }
}

}  // namespace

GlobalBasis GlobalBasisOfModel(const ClusteredModel& model, const GlobalBasisOptions& options) {
  return FromRows(model, WeighedStack(model).View(), options);
}

GlobalBasis GlobalBasisOfRows(const ClusteredModel& model, RowsView subset,
                              const GlobalBasisOptions& options) {
  if (subset.columns != model.columns) throw Error("global basis: rows of other directions");
  return FromRows(model, subset, options);
}

ClusteredModel ThroughGlobalBasis(const ClusteredModel& model, const GlobalBasis& global) {
  if (global.local.size() != model.bases.size()) throw Error("global basis: of another model");
  ClusteredModel result = model;
  for (size_t c = 0; c < model.bases.size(); ++c) {
    FunctionRows& basis = result.bases[c];
    if (basis.rows == 0) continue;
    basis = global.local[c].rows == 0 ? MakeFunctionRows(basis.rows, model.columns)
                                      : Times(global.local[c].View(), global.functions.View());
  }
  return result;
}

std::vector<float> Relit(const ClusteredModel& model, const std::vector<float>& light) {
  RequireLight(model, light);
  std::vector<std::vector<float>> local(model.bases.size());
  ParallelFor(0, static_cast<int64_t>(local.size()), [&](int64_t c) {
    if (model.bases[c].rows > 0) local[c] = Applied(model.bases[c].View(), light.data());
  });
  return FromLocal(model, local);
}

std::vector<float> Relit(const ClusteredModel& model, const GlobalBasis& global,
                         const std::vector<float>& light) {
  RequireLight(model, light);
  if (global.local.size() != model.bases.size()) throw Error("global basis: of another model");
  std::vector<std::vector<float>> local(model.bases.size());
  if (global.functions.rows > 0) {
    const std::vector<float> projected = Applied(global.functions.View(), light.data());
    ParallelFor(0, static_cast<int64_t>(local.size()), [&](int64_t c) {
      if (global.local[c].rows > 0) local[c] = Applied(global.local[c].View(), projected.data());
    });
  }
  return FromLocal(model, local);
}

}  // namespace lfm
