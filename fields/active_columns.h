// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lfm {

/// As many columns as there are functions, independent, those of the smallest `cost` first.
std::vector<int> IndependentColumns(const Eigen::MatrixXd& functions, const Eigen::VectorXd& cost);

/// The target moved into general position: by 1e-9 to 2e-9 upwards, column by column otherwise.
Eigen::VectorXd MovedTarget(const Eigen::VectorXd& target);

/// The columns that a vertex meets, and the inverse of the functions there.
struct ActiveColumns {
  std::vector<int> columns;
  Eigen::MatrixXd inverse;  ///< of functions(:, columns)
};

/// The inverse anew, without what exchanges left of rounding.
void Refresh(const Eigen::MatrixXd& functions, ActiveColumns& active);
/// Column `entering` in place `leaving`.
void Exchange(const Eigen::MatrixXd& functions, int leaving, int entering, ActiveColumns& active);
/// The weights that meet the target at the active columns.
Eigen::VectorXd WeightsAt(const ActiveColumns& active, const Eigen::VectorXd& target);

}  // namespace lfm
