// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_solver.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/l1_float64.h"
#include "fields/l1_reweighted.h"

namespace lfm {
namespace {

void CheckProblem(RowsView basis, RowsView targets, const L1Options& options,
                  const std::vector<float>& start) {
  if (basis.columns != targets.columns || basis.columns < 1) {
    throw Error("L1: a basis over " + std::to_string(basis.columns) + " columns for rows of " +
                std::to_string(targets.columns));
  }
  const bool reference = options.solver == L1Solver::kLinearProgramme ||
                         options.solver == L1Solver::kQuadraticProgramme;
  const int most = reference ? 64 : kernels::kL1Terms;
  if (basis.rows > most) {
    throw Error("L1: " + std::to_string(basis.rows) + " basis functions, more than " +
                std::to_string(most));
  }
  if (!start.empty() && static_cast<int64_t>(start.size()) != targets.rows * basis.rows) {
    throw Error("L1: " + std::to_string(start.size()) + " start weights for " +
                std::to_string(targets.rows) + " rows of " + std::to_string(basis.rows));
  }
  if (options.iterations < 0 || options.iterations > 10000) {
    throw Error("L1: " + std::to_string(options.iterations) + " iterations, not 0 to 10000");
  }
  if (!(options.huber_gamma > 0) || !std::isfinite(options.huber_gamma)) {
    throw Error("L1: Huber's gamma is not positive");
  }
  RequireFinite(basis, "L1 basis");
  for (float weight : start) {
    if (!std::isfinite(weight)) throw Error("L1: a start weight is not finite");
  }
}

}  // namespace

L1Solution SolveL1(RowsView basis, RowsView targets, const L1Options& options,
                   const std::vector<float>& start) {
  CheckProblem(basis, targets, options, start);
  const bool reweighted =
      options.solver == L1Solver::kReweighted && options.sign == ResidualSign::kAny;
  L1Solution solution = reweighted ? SolveReweighted(basis, targets, options.iterations, start,
                                                     kernels::BestL1Kernels())
                                   : SolveInFloat64(basis, targets, options, start);
  for (float weight : solution.weights) {
    if (!std::isfinite(weight)) throw Error("L1: a weight is beyond float32");
  }
  return solution;
}

double L1Error(RowsView basis, const std::vector<float>& weights, RowsView targets) {
  if (basis.columns != targets.columns ||
      static_cast<int64_t>(weights.size()) != targets.rows * basis.rows) {
    throw Error("L1 error: sizes do not fit");
  }
  // Fixed chunks, summed in order.
  constexpr int64_t kChunk = 64;
  std::vector<double> sums((targets.rows + kChunk - 1) / kChunk);
  ParallelChunks(targets.rows, kChunk, [&](int64_t begin, int64_t end, int64_t chunk) {
    std::vector<double> rest(targets.columns);
    for (int64_t row = begin; row < end; ++row) {
      for (int j = 0; j < targets.columns; ++j) rest[j] = targets.Row(row)[j];
      for (int64_t t = 0; t < basis.rows; ++t) {
        const double weight = weights[row * basis.rows + t];
        for (int j = 0; j < targets.columns; ++j) rest[j] -= weight * basis.Row(t)[j];
      }
      for (double r : rest) sums[chunk] += std::abs(r);
    }
  });
  double total = 0;
  for (double sum : sums) total += sum;
  return total;
}

}  // namespace lfm
