// SPDX-License-Identifier: BSD-3-Clause
// Eigen's dense decompositions take long to compile: here once.
#include "tests/encode/dense_oracle.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <random>

#include "encode/product_kernels.h"

namespace lfm::testing {

Eigen::MatrixXd DenseMatrix(const SyntheticLightField& field, const VertexOperator& f,
                            const std::function<PatchMean(int)>& mean_of) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(f.rows, f.cols());
  for (const RingBlock& block : f.blocks) {
    const SyntheticLightField::Triangle& triangle = field.triangles[block.triangle];
    if (triangle.photos.empty()) continue;
    const PatchMean mean = mean_of ? mean_of(block.triangle) : ArbitraryMean(field, block.triangle);
    const int n = triangle.edge_samples;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const int sample = PatchSampleIndex(n, i, j);
        const double hat = PatchSampleWeights(n, i, j)[block.corner];
        for (int col = 0; col < f.cols(); ++col) {
          const int channel = col / f.directions;
          dense(block.first_row + sample, col) =
              hat * (ResampledValue(field, block.triangle, block.corner, sample, channel,
                                    col % f.directions) -
                     mean[3 * sample + channel]);
          for (int at = 0; at < 3 && !block.change.empty(); ++at) {
            dense(block.first_row + sample, col) +=
                hat * PatchSampleWeights(n, i, j)[at] * block.change[at * f.cols() + col];
          }
        }
      }
    }
  }
  return dense;
}

LinearMap DenseMap(const RowMatrix& f) {
  LinearMap map;
  map.rows = static_cast<int>(f.rows());
  map.cols = static_cast<int>(f.cols());
  map.max_abs = f.size() == 0 ? 0 : f.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  map.multiply = [&f](const float* x, int width, float* y) {
    kernels::Multiply(f.data(), static_cast<int>(f.rows()), static_cast<int>(f.cols()), x, width,
                      y);
  };
  map.multiply_transposed = [&f](const float* y, int width, float* x) {
    kernels::MultiplyTransposed(f.data(), static_cast<int>(f.rows()), static_cast<int>(f.cols()), y,
                                width, x);
  };
  return map;
}

Eigen::MatrixXd RandomNormal(int rows, int cols, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

Eigen::MatrixXd MatrixWithSpectrum(int rows, int cols, const Eigen::VectorXd& values, int seed) {
  const auto count = static_cast<int>(values.size());
  return OrthonormalBasis(RandomNormal(rows, count, seed)) * values.asDiagonal() *
         OrthonormalBasis(RandomNormal(cols, count, seed + 1)).transpose();
}

Eigen::VectorXd SingularValues(const Eigen::MatrixXd& matrix) {
  return Eigen::BDCSVD<Eigen::MatrixXd>(matrix).singularValues();
}

Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& matrix) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(matrix).householderQ() *
         Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
}

}  // namespace lfm::testing
