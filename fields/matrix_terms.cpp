// SPDX-License-Identifier: BSD-3-Clause
#include "fields/matrix_terms.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "fields/matrix_products.h"
#include "fields/subspace_iteration.h"

namespace lfm {
namespace {

// Squared: singular values below 1e-6 of the first are float32 rounding.
constexpr double kLeastEnergy = 1e-12;

enum class Functions { kWanted, kUnwanted };

void CheckOptions(const TermsOptions& options) {
  if (options.max_terms < 0) throw Error("a negative number of terms was asked for");
  if (!(options.energy_share >= 0 && options.energy_share <= 1)) {
    throw Error("the share of the energy must be from 0 to 1");
  }
}

std::vector<float> MeanRow(RowsView a) {
  std::vector<double> sums(static_cast<size_t>(a.columns));
  for (int64_t row = 0; row < a.rows; ++row) {
    for (int j = 0; j < a.columns; ++j) sums[j] += a.Row(row)[j];
  }
  std::vector<float> mean(sums.size());
  for (size_t j = 0; j < mean.size(); ++j) {
    mean[j] = static_cast<float>(sums[j] / static_cast<double>(a.rows));
  }
  return mean;
}

FunctionRows WithoutRow(RowsView a, const std::vector<float>& mean) {
  FunctionRows centred = MakeFunctionRows(a.rows, a.columns);
  for (int64_t row = 0; row < a.rows; ++row) {
    for (int j = 0; j < a.columns; ++j) centred.Row(row)[j] = a.Row(row)[j] - mean[j];
  }
  return centred;
}

int KeptOf(const std::vector<double>& energies, double total, const TermsOptions& options) {
  int rank = 0;
  while (rank < static_cast<int>(energies.size()) && energies[rank] > kLeastEnergy * energies[0]) {
    ++rank;
  }
  return std::min({rank, options.max_terms, TermsHolding(energies, total, options.energy_share)});
}

// Rows of unit length, each without what those before it hold: rounding of small singular vectors
// towards large ones is taken off.
FunctionRows OrthonormalRows(Eigen::MatrixXd rows) {
  rows.rowwise().normalize();
  FunctionRows functions = MakeFunctionRows(rows.rows(), static_cast<int>(rows.cols()));
  for (int64_t i = 0; i < rows.rows(); ++i) {
    for (int64_t j = 0; j < rows.cols(); ++j) functions.Row(i)[j] = static_cast<float>(rows(i, j));
  }
  if (functions.rows == 0) return functions;
  const Eigen::LLT<Eigen::MatrixXd> factor(GramOfRows(functions.View()));
  if (factor.info() != Eigen::Success) return functions;
  const Eigen::MatrixXd inverse =
      factor.matrixL().solve(Eigen::MatrixXd::Identity(rows.rows(), rows.rows()));
  const Eigen::MatrixXd corrected =
      TransposedTimes(Eigen::MatrixXd(inverse.transpose()), functions.View());
  for (int64_t i = 0; i < rows.rows(); ++i) {
    for (int64_t j = 0; j < rows.cols(); ++j) {
      functions.Row(i)[j] = static_cast<float>(corrected(i, j));
    }
  }
  return functions;
}

std::vector<double> Descending(const Eigen::VectorXd& ascending) {
  std::vector<double> values;
  for (auto i = ascending.size(); i-- > 0;) values.push_back(std::max(0.0, ascending(i)));
  return values;
}

Eigen::MatrixXd SmallerGram(RowsView a) {
  return a.rows <= a.columns ? GramOfRows(a) : GramOfColumns(a);
}

void AddExactTerms(RowsView a, const TermsOptions& options, Functions functions,
                   MatrixTerms& result) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      SmallerGram(a),
      functions == Functions::kWanted ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
  result.energies = Descending(solver.eigenvalues());
  const int kept = KeptOf(result.energies, result.energy, options);
  result.energies.resize(kept);
  if (functions == Functions::kUnwanted) return;
  const Eigen::MatrixXd vectors = solver.eigenvectors().rightCols(kept).rowwise().reverse();
  result.functions = OrthonormalRows(a.rows <= a.columns ? TransposedTimes(vectors, a)
                                                         : Eigen::MatrixXd(vectors.transpose()));
}

bool AddSubspaceTerms(RowsView a, const TermsOptions& options, Functions functions,
                      MatrixTerms& result) {
  const int side = static_cast<int>(std::min<int64_t>(a.rows, a.columns));
  const bool automatic = options.method == TermsMethod::kAutomatic;
  const Subspace subspace =
      IterateSubspace(a, {.terms = std::min(options.max_terms, side),
                          .energy = result.energy,
                          .share = options.energy_share,
                          .expected_terms = std::min(options.expected_terms, side),
                          .most_terms = automatic ? side / 3 : side,
                          .tolerance = options.tolerance});
  if (automatic && !subspace.holds_share) return false;
  const int kept = KeptOf(subspace.energies, result.energy, options);
  result.energies.assign(subspace.energies.begin(), subspace.energies.begin() + kept);
  if (functions == Functions::kUnwanted) return true;
  const Eigen::MatrixXd rotation = subspace.rotation.leftCols(kept);
  result.functions = OrthonormalRows(TransposedTimes(rotation, subspace.projected.View()));
  return true;
}

// Whether all eigenvalues are found at once.
bool UsesGram(int64_t side, const TermsOptions& options) {
  if (options.method != TermsMethod::kAutomatic) return options.method == TermsMethod::kExact;
  constexpr int64_t kShort = 400, kFew = 8;
  if (side <= kShort) return side < kFew * options.max_terms;
  return options.energy_share >= 1 && options.max_terms > side / 3;
}

MatrixTerms LeadingTerms(RowsView a, const TermsOptions& options, Functions functions) {
  CheckOptions(options);
  MatrixTerms result;
  FunctionRows centred;
  result.energy = EnergyOf(a);
  if (!std::isfinite(result.energy)) RequireFinite(a, "a matrix to be factored");
  if (options.centring == Centring::kMean && a.rows > 0) {
    result.mean = MeanRow(a);
    centred = WithoutRow(a, result.mean);
    a = centred.View();
    result.energy = EnergyOf(a);
  }
  result.functions = MakeFunctionRows(0, a.columns);
  if (result.energy <= 0 || options.max_terms == 0 || options.energy_share <= 0) return result;
  if (UsesGram(std::min<int64_t>(a.rows, a.columns), options) ||
      !AddSubspaceTerms(a, options, functions, result)) {
    AddExactTerms(a, options, functions, result);
  }
  return result;
}

}  // namespace

double MatrixTerms::CapturedEnergy() const {
  double sum = 0;
  for (const double term : energies) sum += term;
  return sum;
}

MatrixTerms TermsOf(RowsView a, const TermsOptions& options) {
  return LeadingTerms(a, options, Functions::kWanted);
}

MatrixTerms TermEnergiesOf(RowsView a, const TermsOptions& options) {
  return LeadingTerms(a, options, Functions::kUnwanted);
}

std::vector<double> EnergySpectrum(RowsView a, Centring centring) {
  RequireFinite(a, "a matrix to be factored");
  FunctionRows centred;
  if (centring == Centring::kMean && a.rows > 0) {
    centred = WithoutRow(a, MeanRow(a));
    a = centred.View();
  }
  if (a.rows == 0) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(SmallerGram(a),
                                                              Eigen::EigenvaluesOnly);
  return Descending(solver.eigenvalues());
}

int TermsHolding(const std::vector<double>& energies, double total, double share) {
  if (total <= 0) return 0;
  double sum = 0;
  int count = 0;
  while (count < static_cast<int>(energies.size()) && sum < share * total) {
    sum += energies[count++];
  }
  return count;
}

std::vector<float> CoefficientsOf(RowsView rows, RowsView functions) {
  std::vector<float> coefficients(static_cast<size_t>(rows.rows * functions.rows));
  if (coefficients.empty()) return coefficients;
  const FunctionRows product = TimesTransposed(rows, functions);
  for (int64_t row = 0; row < rows.rows; ++row) {
    std::copy_n(product.Row(row), functions.rows, coefficients.data() + row * functions.rows);
  }
  return coefficients;
}

}  // namespace lfm
