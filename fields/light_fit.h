// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fields/field.h"
#include "fields/light_basis.h"
#include "fields/light_frame.h"

namespace lfm {

/// Of which values the basis functions are summed.
enum class FitSpace {
  kLinear,   ///< linear radiance: sums of lights are sums of coefficients
  kDisplay,  ///< sRGB-coded values, as RTI viewers show them and .ptm and .rti files hold them
};

/// Every row of a field as a sum of a few fixed functions of the light's direction.
struct LightFit {
  LightBasis basis = LightBasis::kPolynomial;
  FitSpace space = FitSpace::kLinear;
  LightFrame frame;
  FunctionRows coefficients;  ///< a row of the field each, a column a basis function
};

/// The least-squares fit of every row (row r, column j: its value under light j), float64; which
/// functions take part where the lights do not determine all: MakeLightSolver. Magnitudes may lie
/// anywhere in 1e+-25 (kLinear); black rows get zeros. Parallel; the result does not depend on the
/// number of threads. Throws Error when the numbers of lights differ or a value is not finite.
LightFit FitLights(RowsView rows, const std::vector<Eigen::Vector3d>& to_lights,
                   const LightFrame& frame, LightBasis basis, FitSpace space);

/// The same for several bases, which costs less than one after the other.
std::vector<LightFit> FitLights(RowsView rows, const std::vector<Eigen::Vector3d>& to_lights,
                                const LightFrame& frame, const std::vector<LightBasis>& bases,
                                FitSpace space);

/// What every row shows under a light from anywhere, linear radiance, never below 0, never NaN. A
/// light below the frame's horizon shows what one on it shows.
std::vector<float> EvaluateFit(const LightFit& fit, const Eigen::Vector3d& to_light);

}  // namespace lfm
