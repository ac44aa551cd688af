// SPDX-License-Identifier: BSD-3-Clause
#include "fields/sparse_factorization.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <string>

#include "core/error.h"
#include "fields/leading_functions.h"

namespace lfm {
namespace {

struct Factors {
  FunctionRows basis;
  std::vector<float> weights;
  double error = 0;
};

FunctionRows RandomFunctions(int terms, int columns) {
  std::mt19937 engine(11);
  FunctionRows result = MakeFunctionRows(terms, columns);
  for (int t = 0; t < terms; ++t) {
    for (int j = 0; j < columns; ++j) {
      result.Row(t)[j] = std::ldexp(static_cast<float>(engine() >> 8), -24);
    }
  }
  return result;
}

FunctionRows StartingBasis(RowsView r, const SparseFactorizationOptions& options) {
  const int terms =
      static_cast<int>(std::min({int64_t{options.terms}, r.rows, int64_t{r.columns}}));
  if (options.start == FactorStart::kPca) return LeadingFunctions(r, terms);
  return RandomFunctions(terms, r.columns);
}

// To unit length; the weights take the length over. A function of zeros stays.
void Normalize(FunctionRows& basis, std::vector<float>& weights) {
  const int64_t terms = basis.rows;
  for (int64_t t = 0; t < terms; ++t) {
    double energy = 0;
    for (int j = 0; j < basis.columns; ++j) {
      energy += double{basis.Row(t)[j]} * basis.Row(t)[j];
    }
    if (energy == 0) continue;
    const double length = std::sqrt(energy);
    for (int j = 0; j < basis.columns; ++j) {
      basis.Row(t)[j] = static_cast<float>(basis.Row(t)[j] / length);
    }
    for (size_t i = t; i < weights.size(); i += terms) {
      weights[i] = static_cast<float>(weights[i] * length);
    }
  }
}

RowsView WeightRows(const std::vector<float>& weights, int64_t terms) {
  return {weights.data(), static_cast<int64_t>(weights.size()) / terms, static_cast<int>(terms),
          terms};
}

double Sum(const std::vector<double>& errors) {
  return std::accumulate(errors.begin(), errors.end(), 0.0);
}

// All columns of F with W fixed, then all rows of W with that F.
Factors Alternate(RowsView r, RowsView columns, const Factors& before, const L1Options& options) {
  const int64_t terms = before.basis.rows;
  const FunctionRows weights_of_terms = TransposeRows(WeightRows(before.weights, terms));
  std::vector<float> start(static_cast<size_t>(r.columns) * terms);
  for (int j = 0; j < r.columns; ++j) {
    for (int64_t t = 0; t < terms; ++t) start[j * terms + t] = before.basis.Row(t)[j];
  }
  const L1Solution functions = SolveL1(weights_of_terms.View(), columns, options, start);
  Factors after{TransposeRows(WeightRows(functions.weights, terms)), before.weights, 0};
  Normalize(after.basis, after.weights);
  L1Solution rows = SolveL1(after.basis.View(), r, options, after.weights);
  after.weights = std::move(rows.weights);
  after.error = Sum(rows.errors);
  return after;
}

// Terms that no row uses, or that are zero themselves, say nothing.
Factors WithoutIdleTerms(const Factors& factors) {
  const int64_t terms = factors.basis.rows;
  std::vector<int64_t> busy;
  for (int64_t t = 0; t < terms; ++t) {
    const float* function = factors.basis.Row(t);
    bool used = false;
    for (size_t i = t; i < factors.weights.size() && !used; i += terms) {
      used = factors.weights[i] != 0;
    }
    const auto is_zero = [](float value) { return value == 0; };
    if (used && !std::all_of(function, function + factors.basis.columns, is_zero)) {
      busy.push_back(t);
    }
  }
  Factors result{GatherRows(factors.basis.View(), busy), {}, factors.error};
  for (size_t row = 0; row < factors.weights.size(); row += terms) {
    for (int64_t t : busy) result.weights.push_back(factors.weights[row + t]);
  }
  return result;
}

}  // namespace

SparseFactors FactorizeSparse(RowsView r, const SparseFactorizationOptions& options) {
  if (options.terms < 0 || options.terms > 16) {
    throw Error("sparse factorisation: " + std::to_string(options.terms) + " terms, not 0 to 16");
  }
  if (options.max_alternations < 0 || !(options.tolerance >= 0)) {
    throw Error("sparse factorisation: alternations and tolerance must not be negative");
  }
  RequireFinite(r, "sparse factorisation");
  Factors factors{StartingBasis(r, options), {}, 0};
  Normalize(factors.basis, factors.weights);
  L1Solution rows = SolveL1(factors.basis.View(), r, options.l1);
  factors.weights = std::move(rows.weights);
  factors.error = Sum(rows.errors);
  std::vector<double> errors = {factors.error};
  if (factors.basis.rows > 0) {
    const FunctionRows columns = TransposeRows(r);
    for (int i = 0; i < options.max_alternations && factors.error > 0; ++i) {
      Factors next = Alternate(r, columns.View(), factors, options.l1);
      if (next.error >= factors.error) break;
      const bool converged = factors.error - next.error < options.tolerance * factors.error;
      factors = std::move(next);
      errors.push_back(factors.error);
      if (converged) break;
    }
    factors = WithoutIdleTerms(factors);
  }
  return {std::move(factors.basis), std::move(factors.weights), std::move(errors)};
}

}  // namespace lfm
