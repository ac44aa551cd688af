// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "fields/l1_edge_descent.h"

namespace lfm {

/// The same optimum among weights that leave no negative residual, x functions <= target (the
/// remark of Yamada 2009, Section 3.2, on dropping the term l): from a feasible point to a vertex,
/// then along edges of the feasible set, each to the first column that would turn negative. In
/// L1Vertex::dual y_j <= 1, without a bound below.
///
/// `functions` and `target` as for DescendEdges. None when no weights are feasible; for a target
/// without negative numbers some always are: zeros.
std::optional<L1Vertex> DescendOneSided(const Eigen::MatrixXd& functions,
                                        const Eigen::VectorXd& target);

}  // namespace lfm
