// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

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

/// F^v by its definition (hat times resampled value minus mean, and the blocks' change), in
/// float64.
Eigen::MatrixXd DenseMatrix(const SyntheticLightField& field, const VertexOperator& f,
                            const std::function<PatchMean(int)>& mean_of = nullptr);

/// Normally distributed entries; equal seeds, equal entries.
Eigen::MatrixXd RandomNormal(int rows, int cols, int seed);
/// A matrix with these singular values (the rest zero) and random singular vectors.
Eigen::MatrixXd MatrixWithSpectrum(int rows, int cols, const Eigen::VectorXd& values, int seed);

/// Products with a matrix that is formed; it must outlive the map.
LinearMap DenseMap(const RowMatrix& f);

/// All of them, descending, by divide and conquer in float64.
Eigen::VectorXd SingularValues(const Eigen::MatrixXd& matrix);

/// Orthonormal columns that span the columns of `matrix` (Householder, float64).
Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& matrix);

}  // namespace lfm::testing
