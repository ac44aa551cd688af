// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// One step of the pyramid: the means of two sets of directions become the mean of both, which
/// takes the place of the first, and their difference, which takes that of the second.
struct HaarStep {
  int mean = 0, difference = 0;  ///< columns
  double cosine = 1, sine = 0;   ///< sqrt of either set's share of the directions
};

/// An orthonormal Haar basis psi over scattered directions (Yamada 2009, Equation 3): nearest
/// directions are paired, then nearest pairs, and so on to the sphere. A set of n directions has
/// the scaling function 1 / sqrt(n) on them. Two sets of a and b directions with coefficients p, q
/// give
///
///   mean = (sqrt(a) p + sqrt(b) q) / sqrt(a + b)
///   difference = (sqrt(b) p - sqrt(a) q) / sqrt(a + b)
///
/// a rotation, so the whole is orthonormal for any number of directions and any sizes of sets (the
/// unbalanced Haar transform). A step a pair: one fewer than directions.
struct HaarBasis {
  int columns = 0;
  std::vector<HaarStep> steps;
};

/// Pairs by distance between mean directions, level by level; ties by number. One direction has no
/// steps. Throws Error without directions or when one is not finite.
HaarBasis MakeHaarBasis(const std::vector<Eigen::Vector3d>& directions);

/// R psi: every row in the basis; and back. As psi is orthonormal, R l = (R psi)(psi^T l): to
/// relight rows in the basis, take the light's own row there. Steps run in float64, parallel over
/// rows. Throw Error when the columns differ.
FunctionRows ToHaar(const HaarBasis& basis, FunctionRows rows);
FunctionRows FromHaar(const HaarBasis& basis, FunctionRows rows);

}  // namespace lfm
