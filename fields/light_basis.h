// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fields/light_frame.h"

namespace lfm {

/// What a picture is written as a sum of, by the classic fits of reflectance transformation
/// imaging.
enum class LightBasis {
  kPolynomial,  ///< a polynomial texture map: 6 (fields/polynomial_texture.h)
  kHarmonics4,  ///< hemispherical harmonics of 2, 3 and 4 bands
  kHarmonics9,  ///< (fields/hemispherical_harmonics.h)
  kHarmonics16
};

/// "PTM", "HSH 4", "HSH 9", "HSH 16".
const char* LightBasisName(LightBasis basis);
int LightBasisTerms(LightBasis basis);
/// The basis at a light in the frame's hemisphere (LightFrame::Local).
Eigen::VectorXd LightBasisValues(LightBasis basis, const Eigen::Vector3d& local);

/// Least squares over given lights: coefficients = solver * values, float64.
struct LightSolver {
  Eigen::MatrixXd solver;  ///< terms x lights; rows of functions that are left out are zero
  std::vector<int> used;   ///< the functions that the lights can tell apart, in order
};

/// Of the lights above the frame's horizon; when none is, of all as they are on it. A light that
/// comes twice counts twice.
///
/// Too few lights, or lights on a line or circle, do not determine all functions. Then functions
/// are taken by rising degree (the constant first, then in the basis's own order) as long as what
/// is left of them beside the ones before, at the lights, is more than `kLeastIndependence` of
/// their length; the others are left out, and their coefficients are zero. One light gives the
/// constant. Throws Error without any light.
LightSolver MakeLightSolver(LightBasis basis, const LightFrame& frame,
                            const std::vector<Eigen::Vector3d>& to_lights);
inline constexpr double kLeastIndependence = 1e-3;

}  // namespace lfm
