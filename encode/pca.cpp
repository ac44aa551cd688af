// SPDX-License-Identifier: BSD-3-Clause
// Randomised subspace iteration after Halko, Martinsson and Tropp (SIAM Review 2011), on products
// with F and F^T only. Every Gram matrix is summed in float64: its condition number is the square
// of the factor's, which float32 cannot hold beyond 3e3.
#include "encode/pca.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encode/product_kernels.h"
#include "encode/pseudo_random.h"

namespace lfm {
namespace {

// Relative to the largest eigenvalue of a Gram matrix: squares of 1e-6 and 1e-7.
constexpr double kDropFromBasis = 1e-12;
constexpr double kDropSingularValue = 1e-14;

using SmallMatrix = Eigen::MatrixXd;

SmallMatrix GramMatrix(const std::vector<float>& x, int rows, int width) {
  SmallMatrix gram(width, width);
  kernels::Gram(x.data(), rows, width, gram.data());
  if (!gram.allFinite()) {
    throw Error("PCA: the matrix holds values that are not finite, or beyond 1e+25");
  }
  return gram;
}

/// x * mix for a small square matrix.
std::vector<float> Mix(const std::vector<float>& x, int rows, int width, const SmallMatrix& mix) {
  std::vector<float> mix_rows(static_cast<size_t>(width) * width);
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < width; ++j) mix_rows[i * width + j] = static_cast<float>(mix(i, j));
  }
  std::vector<float> out(x.size());
  kernels::Multiply(x.data(), rows, width, mix_rows.data(), width, out.data());
  return out;
}

struct Spectrum {
  Eigen::VectorXd values;  // descending
  SmallMatrix vectors;
};

Spectrum DescendingEigen(const SmallMatrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<SmallMatrix> solver(symmetric);
  return {solver.eigenvalues().reverse(), solver.eigenvectors().rowwise().reverse()};
}

// Columns that turn F^T U into right singular vectors; noise gives zero columns.
SmallMatrix InverseRoots(const Spectrum& eigen) {
  SmallMatrix mix = eigen.vectors;
  for (int i = 0; i < mix.cols(); ++i) {
    const bool noise = eigen.values[i] <= kDropSingularValue * eigen.values[0];
    mix.col(i) *= noise ? 0 : 1 / std::sqrt(eigen.values[i]);
  }
  return mix;
}

int OrthonormalizeOnce(std::vector<float>& x, int rows, int width, const SmallMatrix& gram) {
  Eigen::VectorXd scale(width);
  for (int i = 0; i < width; ++i) scale[i] = gram(i, i) > 0 ? 1 / std::sqrt(gram(i, i)) : 0;
  const Spectrum eigen = DescendingEigen(scale.asDiagonal() * gram * scale.asDiagonal());
  SmallMatrix mix = SmallMatrix::Zero(width, width);
  int rank = 0;
  while (rank < width && eigen.values[rank] > kDropFromBasis * eigen.values[0]) {
    mix.col(rank) = scale.asDiagonal() * eigen.vectors.col(rank) / std::sqrt(eigen.values[rank]);
    ++rank;
  }
  x = Mix(x, rows, width, mix);
  return rank;
}

std::vector<float> RandomStart(int rows, int columns, int width) {
  std::vector<float> x(static_cast<size_t>(rows) * width, 0.f);
  PseudoRandom random;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      x[static_cast<size_t>(r) * width + c] = static_cast<float>(random.Next());
    }
  }
  return x;
}

/// A power of two near 1 / max_abs: products of the scaled matrix neither overflow nor underflow.
float Prescale(double max_abs) {
  const int exponent = std::clamp(-std::ilogb(max_abs), -100, 100);
  return std::ldexp(1.f, exponent);
}

void Scale(std::vector<float>& x, float factor) {
  for (float& value : x) value *= factor;
}

PcaResult Finish(PcaResult result, const LinearMap& map, const Spectrum& eigen, float prescale,
                 int terms) {
  SmallMatrix mix = SmallMatrix::Zero(result.width, result.width);
  const double noise = kDropSingularValue * eigen.values[0];
  while (result.rank < result.width && eigen.values[result.rank] > noise) {
    mix.col(result.rank) = eigen.vectors.col(result.rank);
    result.singular_values.push_back(std::sqrt(eigen.values[result.rank]) / prescale);
    ++result.rank;
  }
  result.left = Mix(result.left, map.rows, result.width, mix);
  result.right = Mix(result.right, map.cols, result.width, mix);
  Scale(result.right, 1 / prescale);
  result.terms = std::min(terms, result.rank);
  return result;
}

}  // namespace

int Orthonormalize(std::vector<float>& x, int rows, int width) {
  OrthonormalizeOnce(x, rows, width, GramMatrix(x, rows, width));
  return OrthonormalizeOnce(x, rows, width, GramMatrix(x, rows, width));
}

PcaResult ComputePca(const LinearMap& map, const PcaOptions& options) {
  if (!std::isfinite(map.max_abs)) throw Error("PCA: the matrix holds values that are not finite");
  if (options.terms < 0 || options.terms > 16) throw Error("PCA: terms must lie in [0, 16]");
  PcaResult result;
  const int columns = std::min({std::max(16, options.terms + 8), map.rows, map.cols});
  result.width = std::max(1, (columns + 7) / 8) * 8;
  result.left.assign(static_cast<size_t>(map.rows) * result.width, 0.f);
  result.right.assign(static_cast<size_t>(map.cols) * result.width, 0.f);
  if (columns == 0 || map.max_abs <= 0 || options.terms == 0) return result;

  const float prescale = Prescale(map.max_abs);
  result.right = RandomStart(map.cols, columns, result.width);
  double captured = 0;
  for (;;) {
    Scale(result.right, prescale);
    map.multiply(result.right.data(), result.width, result.left.data());
    if (Orthonormalize(result.left, map.rows, result.width) == 0) break;
    std::vector<float> scaled_left = result.left;
    Scale(scaled_left, prescale);
    map.multiply_transposed(scaled_left.data(), result.width, result.right.data());
    const Spectrum eigen = DescendingEigen(GramMatrix(result.right, map.cols, result.width));
    const double before = captured;
    captured = eigen.values.head(std::min(columns, options.terms)).sum();
    ++result.passes;
    if (captured - before <= options.tolerance * captured || result.passes >= options.max_passes) {
      return Finish(std::move(result), map, eigen, prescale, options.terms);
    }
    result.right = Mix(result.right, map.cols, result.width, InverseRoots(eigen));
  }
  result.left.assign(result.left.size(), 0.f);
  result.right.assign(result.right.size(), 0.f);
  return result;
}

}  // namespace lfm
