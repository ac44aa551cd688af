// SPDX-License-Identifier: BSD-3-Clause
// Eigen's dense decompositions take long to compile: here once.
#include "tests/encode/dense_oracle.h"

#include <Eigen/QR>
#include <Eigen/SVD>

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
        }
      }
    }
  }
  return dense;
}

Eigen::VectorXd SingularValues(const Eigen::MatrixXd& matrix) {
  return Eigen::BDCSVD<Eigen::MatrixXd>(matrix).singularValues();
}

Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& matrix) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(matrix).householderQ() *
         Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
}

}  // namespace lfm::testing
