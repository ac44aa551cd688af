// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fields/clp_oracle.h"

#include <ClpSimplex.hpp>
#include <vector>

namespace lfm {
namespace {

// A programme in Clp's terms, column by column.
struct Programme {
  std::vector<CoinBigIndex> start = {0};
  std::vector<int> row;
  std::vector<double> value, lower, upper, objective;

  void Column(double least, double most, double cost) {
    start.push_back(static_cast<CoinBigIndex>(row.size()));
    lower.push_back(least);
    upper.push_back(most);
    objective.push_back(cost);
  }
  void Entry(Eigen::Index at, double number) {
    row.push_back(static_cast<int>(at));
    value.push_back(number);
  }
};

double Solve(const Programme& programme, const std::vector<double>& rows, ClpForm form) {
  ClpSimplex simplex;
  simplex.setLogLevel(0);
  simplex.setPrimalTolerance(1e-9);
  simplex.setDualTolerance(1e-9);
  simplex.loadProblem(static_cast<int>(programme.lower.size()), static_cast<int>(rows.size()),
                      programme.start.data(), programme.row.data(), programme.value.data(),
                      programme.lower.data(), programme.upper.data(), programme.objective.data(),
                      rows.data(), rows.data());
  form == ClpForm::kDual ? simplex.dual() : simplex.primal();
  return simplex.objectiveValue();
}

}  // namespace

double LeastErrorByClp(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                       ClpForm form) {
  Programme programme;
  if (form == ClpForm::kDual) {
    for (Eigen::Index j = 0; j < target.size(); ++j) {
      for (Eigen::Index t = 0; t < functions.rows(); ++t) programme.Entry(t, functions(t, j));
      programme.Column(-1, 1, -target[j]);
    }
    return -Solve(programme, std::vector<double>(static_cast<size_t>(functions.rows())), form);
  }
  for (Eigen::Index t = 0; t < functions.rows(); ++t) {
    for (Eigen::Index j = 0; j < target.size(); ++j) programme.Entry(j, functions(t, j));
    programme.Column(-COIN_DBL_MAX, COIN_DBL_MAX, 0);
  }
  for (double sign : {1.0, -1.0}) {
    for (Eigen::Index j = 0; j < target.size(); ++j) {
      programme.Entry(j, sign);
      programme.Column(0, COIN_DBL_MAX, 1);
    }
  }
  return Solve(programme, std::vector<double>(target.begin(), target.end()), form);
}

}  // namespace lfm
