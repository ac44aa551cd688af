// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "encode/factored_operator.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Some mean view that is not the mean of anything.
inline PatchMean ArbitraryMean(const SyntheticLightField& field, int triangle) {
  PatchMean mean(static_cast<size_t>(PatchSampleCount(field.triangles[triangle].edge_samples)) * 3);
  for (size_t k = 0; k < mean.size(); ++k) {
    mean[k] = 0.2f + 0.05f * static_cast<float>((k * 7 + static_cast<size_t>(triangle)) % 11);
  }
  return mean;
}

/// F^v by its definition (hat times resampled value minus mean), in float64.
inline Eigen::MatrixXd DenseMatrix(const SyntheticLightField& field, const VertexOperator& f,
                                   const std::function<PatchMean(int)>& mean_of = nullptr) {
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

}  // namespace lfm::testing
