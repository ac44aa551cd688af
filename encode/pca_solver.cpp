// SPDX-License-Identifier: BSD-3-Clause
#include "encode/pca_solver.h"

#include <Eigen/Core>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "encode/paper_factorization.h"

namespace lfm {
namespace {

constexpr int kUnits = 24;                   // unit vectors multiplied at once
constexpr double kDropSingularValue = 1e-7;  // of the first, as ComputePca

/// Unit left vectors of what was found; more are left out.
struct Triplets {
  Eigen::MatrixXd left;
  Eigen::VectorXd values;  // of F / max_abs
  int iterations = 0;
};

Triplets ByPaper(const Eigen::MatrixXf& f, int terms) {
  const PaperFactors<float> factors = PaperPca<float>(f, {.terms = terms});
  Triplets triplets;
  triplets.left = factors.left.cast<double>().colwise().normalized();
  triplets.values = Eigen::Map<const Eigen::VectorXd>(
      factors.singular_values.data(), static_cast<Eigen::Index>(factors.singular_values.size()));
  triplets.iterations = std::accumulate(factors.iterations.begin(), factors.iterations.end(), 0);
  return triplets;
}

Triplets ByDenseSvd(const Eigen::MatrixXf& f, int directions) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(f.cast<double>(), Eigen::ComputeThinU);
  const Eigen::VectorXd& values = svd.singularValues();
  int count = 0;
  while (count < directions && values(count) > kDropSingularValue * values(0)) ++count;
  return {svd.matrixU().leftCols(count), values.head(count), 0};
}

}  // namespace

Eigen::MatrixXf FormMatrix(const LinearMap& map) {
  Eigen::MatrixXf f(map.rows, map.cols);
  std::vector<float> units(static_cast<size_t>(map.cols) * kUnits);
  std::vector<float> columns(static_cast<size_t>(map.rows) * kUnits);
  const auto scale = static_cast<float>(1 / map.max_abs);
  for (int first = 0; first < map.cols; first += kUnits) {
    const int count = std::min(kUnits, map.cols - first);
    std::fill(units.begin(), units.end(), 0.F);
    for (int c = 0; c < count; ++c) units[static_cast<size_t>(first + c) * kUnits + c] = scale;
    map.multiply(units.data(), kUnits, columns.data());
    for (int row = 0; row < map.rows; ++row) {
      for (int c = 0; c < count; ++c) f(row, first + c) = columns[size_t{1} * row * kUnits + c];
    }
  }
  return f;
}

PcaResult SolvePca(const LinearMap& map, const PcaOptions& options, PcaSolver solver) {
  if (solver == PcaSolver::kFactored) return ComputePca(map, options);
  if (!std::isfinite(map.max_abs)) throw Error("PCA: the matrix holds values that are not finite");
  if (options.terms < 0 || options.terms > 16) throw Error("PCA: terms must lie in [0, 16]");
  const int directions = std::min({std::max(16, options.terms + 8), map.rows, map.cols});
  PcaResult result;
  result.width = std::max(1, (directions + 7) / 8) * 8;
  result.left.assign(static_cast<size_t>(map.rows) * result.width, 0.F);
  result.right.assign(static_cast<size_t>(map.cols) * result.width, 0.F);
  if (directions == 0 || map.max_abs <= 0 || options.terms == 0) return result;

  const Eigen::MatrixXf f = FormMatrix(map);
  if (!f.allFinite()) throw Error("PCA: the matrix holds values that are not finite");
  const Triplets triplets = solver == PcaSolver::kPaper
                                ? ByPaper(f, std::min(options.terms, directions))
                                : ByDenseSvd(f, directions);
  result.rank = static_cast<int>(triplets.left.cols());
  result.terms = std::min(options.terms, result.rank);
  result.passes = triplets.iterations;
  const Eigen::MatrixXd right = f.cast<double>().transpose() * triplets.left * map.max_abs;
  for (int k = 0; k < result.rank; ++k) {
    result.singular_values.push_back(triplets.values(k) * map.max_abs);
    for (int row = 0; row < map.rows; ++row) {
      result.left[size_t{1} * row * result.width + k] = static_cast<float>(triplets.left(row, k));
    }
    for (int col = 0; col < map.cols; ++col) {
      result.right[size_t{1} * col * result.width + k] = static_cast<float>(right(col, k));
    }
  }
  return result;
}

}  // namespace lfm
