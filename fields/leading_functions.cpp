// SPDX-License-Identifier: BSD-3-Clause
#include "fields/leading_functions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/parallel.h"

namespace lfm {
namespace {

// R^T R x of the matrix scaled; rows are summed in chunks whose split nothing else decides.
Eigen::MatrixXd ApplyGram(RowsView matrix, double scale, const Eigen::MatrixXd& x) {
  constexpr int64_t kMostChunks = 32, kLeastChunk = 64;
  const int64_t chunk = std::max(kLeastChunk, (matrix.rows + kMostChunks - 1) / kMostChunks);
  std::vector<Eigen::MatrixXd> sums((matrix.rows + chunk - 1) / chunk);
  ParallelChunks(matrix.rows, chunk, [&](int64_t begin, int64_t end, int64_t index) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(x.rows(), x.cols());
    for (int64_t row = begin; row < end; row += kLeastChunk) {
      const Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>> columns(
          matrix.Row(row), matrix.columns, std::min(end - row, kLeastChunk),
          Eigen::OuterStride<>(matrix.stride));
      const Eigen::MatrixXd block = columns.cast<double>() * scale;
      sum.noalias() += block * (block.transpose() * x);
    }
    sums[index] = std::move(sum);
  });
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (const Eigen::MatrixXd& sum : sums) total += sum;
  return total;
}

Eigen::MatrixXd Orthonormal(const Eigen::MatrixXd& x) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(x).householderQ() *
         Eigen::MatrixXd::Identity(x.rows(), x.cols());
}

Eigen::MatrixXd FixedNoise(int rows, int columns) {
  std::mt19937_64 engine(7);
  Eigen::MatrixXd noise(rows, columns);
  for (double& value : noise.reshaped()) value = std::ldexp(double(engine() >> 11), -52) - 1;
  return noise;
}

float LargestMagnitude(RowsView matrix) {
  float most = 0;
  for (int64_t row = 0; row < matrix.rows; ++row) {
    for (int j = 0; j < matrix.columns; ++j) most = std::max(most, std::abs(matrix.Row(row)[j]));
  }
  return most;
}

}  // namespace

FunctionRows LeadingFunctions(RowsView matrix, int terms) {
  constexpr int kSpare = 8, kIterations = 4;
  constexpr double kLeastStrength = 1e-6;
  RequireFinite(matrix, "the matrix");
  const float most = LargestMagnitude(matrix);
  const int least_side = static_cast<int>(std::min<int64_t>(matrix.rows, matrix.columns));
  const int wanted = std::min(terms, least_side);
  if (most == 0 || wanted < 1) return MakeFunctionRows(0, matrix.columns);
  const double scale = std::ldexp(1.0, -std::ilogb(most));
  Eigen::MatrixXd x = FixedNoise(matrix.columns, std::min(wanted + kSpare, least_side));
  for (int i = 0; i < kIterations; ++i) x = Orthonormal(ApplyGram(matrix, scale, x));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(x.transpose() *
                                                            ApplyGram(matrix, scale, x));
  const Eigen::VectorXd energies = ritz.eigenvalues().reverse();
  int rank = 0;
  while (rank < wanted && energies[rank] > kLeastStrength * kLeastStrength * energies[0]) ++rank;
  FunctionRows result = MakeFunctionRows(rank, matrix.columns);
  for (int t = 0; t < rank; ++t) {
    Eigen::VectorXd function = x * ritz.eigenvectors().col(x.cols() - 1 - t);
    Eigen::Index at;
    function.cwiseAbs().maxCoeff(&at);
    if (function[at] < 0) function = -function;
    Eigen::Map<Eigen::VectorXf>(result.Row(t), matrix.columns) = function.cast<float>();
  }
  return result;
}

}  // namespace lfm
