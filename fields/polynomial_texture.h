// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// The six functions of a polynomial texture map (Malzbender 2001, Equation 5), of the light's
/// direction projected onto the picture's plane:
///
///   L = a0 lu^2 + a1 lv^2 + a2 lu lv + a3 lu + a4 lv + a5,   lu = x, lv = y
///
/// in this order, which .ptm files have too. `local` is a unit vector with z >= 0
/// (LightFrame::Local).
Eigen::VectorXd PolynomialTerms(const Eigen::Vector3d& local);

}  // namespace lfm
