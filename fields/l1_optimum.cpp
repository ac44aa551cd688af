// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_optimum.h"

#include <cmath>

#include "core/error.h"
#include "fields/l1_edge_descent.h"
#include "fields/l1_float64.h"
#include "fields/l1_one_sided.h"

namespace lfm {

L1Optimum FindL1Optimum(RowsView basis, const float* target, ResidualSign sign) {
  const RowsView targets{target, 1, basis.columns, basis.columns};
  const L1Solution start = SolveL1(basis, targets, {});
  const Float64Basis shared = ShareInFloat64(basis);
  const Float64Row row = ScaledRow(target, basis.columns);
  const std::optional<L1Vertex> vertex =
      sign == ResidualSign::kPositive
          ? DescendOneSided(shared.functions, row.target)
          : DescendEdges(shared.functions, row.target, ToShared(shared, row, start.weights.data()));
  if (!vertex)
    throw Error("no least absolute error was found: no weights are feasible, or all too close");
  L1Optimum optimum;
  const Eigen::VectorXd weights = FromShared(shared, row, vertex->weights);
  optimum.weights.assign(weights.begin(), weights.end());
  optimum.dual.assign(vertex->dual.begin(), vertex->dual.end());
  optimum.steps = vertex->steps;
  for (int j = 0; j < basis.columns; ++j) {
    double rest = target[j];
    for (int64_t t = 0; t < basis.rows; ++t) rest -= weights[t] * basis.Row(t)[j];
    optimum.error += std::abs(rest);
    optimum.bound += target[j] * optimum.dual[j];
  }
  return optimum;
}

}  // namespace lfm
