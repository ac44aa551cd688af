// SPDX-License-Identifier: BSD-3-Clause
#include "fields/dimension.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

void RequireShare(double share) {
  if (!(share >= 0 && share <= 1)) {
    throw Error("a share of the energy must lie between 0 and 1, not " + std::to_string(share));
  }
}

double SumOf(const std::vector<double>& energies) {
  double sum = 0;
  for (const double energy : energies) sum += std::max(energy, 0.0);
  return sum;
}

// Rounding must not ask for one more term when all energy is wanted.
double Wanted(double sum, double share) { return share * sum * (1 - 1e-14); }

}  // namespace

std::vector<double> RowEnergies(RowsView rows) {
  RequireFinite(rows, "energies");
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Matrix dense(rows.rows, rows.columns);
  for (int64_t r = 0; r < rows.rows; ++r) {
    for (int c = 0; c < rows.columns; ++c) dense(r, c) = rows.Row(r)[c];
  }
  if (dense.size() == 0) return {};
  const Eigen::Index side = std::min(dense.rows(), dense.cols());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(side, side);
  if (dense.rows() <= dense.cols()) {
    gram.selfadjointView<Eigen::Lower>().rankUpdate(dense);
  } else {
    gram.selfadjointView<Eigen::Lower>().rankUpdate(dense.transpose());
  }
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram, Eigen::EigenvaluesOnly).eigenvalues();
  std::vector<double> energies(values.data(), values.data() + side);
  std::reverse(energies.begin(), energies.end());
  for (double& energy : energies) energy = std::max(energy, 0.0);
  return energies;
}

int64_t TermsHolding(const std::vector<double>& energies, double share) {
  RequireShare(share);
  const double sum = SumOf(energies);
  if (!(sum > 0)) return 0;
  double held = 0;
  for (size_t i = 0; i < energies.size(); ++i) {
    if (held >= Wanted(sum, share)) return static_cast<int64_t>(i);
    held += std::max(energies[i], 0.0);
  }
  return static_cast<int64_t>(energies.size());
}

double FractionalTermsHolding(const std::vector<double>& energies, double share) {
  RequireShare(share);
  const double sum = SumOf(energies);
  if (!(sum > 0)) return 0;
  double held = 0;
  for (size_t i = 0; i < energies.size(); ++i) {
    const double energy = std::max(energies[i], 0.0), missing = Wanted(sum, share) - held;
    if (missing <= energy) {
      return static_cast<double>(i) + (energy > 0 ? std::max(missing, 0.0) / energy : 0);
    }
    held += energy;
  }
  return static_cast<double>(energies.size());
}

int64_t DimensionOf(RowsView rows, double share, int64_t /*expected*/) {
  return TermsHolding(RowEnergies(rows), share);
}

}  // namespace lfm
