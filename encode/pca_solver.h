// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "encode/pca.h"

namespace lfm {

/// How the leading singular triplets of a vertex light field are found.
enum class PcaSolver {
  kFactored,  ///< ComputePca: products with the factors, never the matrix
  kPaper,     ///< PaperPca on the formed matrix, float32: K directions, no more
  kDense,     ///< all singular values of the formed matrix, float64: the oracle
};

/// What the factored solver computes in.
enum class Precision {
  kSingle,  ///< float32 with float64 sums where they are squared: within 1e-6 ||F|| of the optimum
  kDouble,  ///< ComputePrecisePca: within 1e-10 ||F||
};

/// F / max_abs, formed by products with unit vectors: neither overflows nor underflows. `max_abs`
/// must not be zero.
Eigen::MatrixXf FormMatrix(const LinearMap& map);

/// ComputePca by another road: the same result to the accuracy of the solvers (`passes` counts
/// power iterations or is 0). kPaper captures the K directions alone, so that the closed loop has
/// less room than in the l = max(16, K + 8) of the others. Both form the matrix (rows x cols
/// floats or doubles, each thread) by products with unit vectors: hundreds of times slower. Throws
/// Error as ComputePca does.
PcaResult SolvePca(const LinearMap& map, const PcaOptions& options, PcaSolver solver);

}  // namespace lfm
