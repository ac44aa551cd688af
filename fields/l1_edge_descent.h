// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

namespace lfm {

/// Where a descent along edges ended: weights that meet as many targets as there are functions,
/// and the dual solution that proves that no others do better.
struct L1Vertex {
  Eigen::VectorXd weights;
  /// y, a number a column: functions y = 0, and each y_j in [-1, 1]. Then sum |b - x functions| >=
  /// sum y_j b_j for every x, with equality here.
  Eigen::VectorXd dual;
  int steps = 0;
};

/// min over x of sum_j |b_j - (x functions)_j| to the optimum itself, float64 (Barrodale and
/// Roberts 1973, Bloomfield and Steiger 1983): from the columns that `start` meets best, along the
/// edge on which the error falls fastest, each time to the weighted median along it.
///
/// `functions` (r x m) are independent with entries of about 1, the mean magnitude of `target` is
/// about 1 or 0. Targets that lie on no general position are moved by 1e-9 on the way, always
/// alike, so that every step descends and none repeats; the weights meet the targets unmoved.
/// None when rounding keeps the optimum from being reached in 100 + 20 m steps.
std::optional<L1Vertex> DescendEdges(const Eigen::MatrixXd& functions,
                                     const Eigen::VectorXd& target, const Eigen::VectorXd& start);

}  // namespace lfm
