// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/field.h"

namespace lfm {

struct FunctionKindOptions {
  double noise = 1.0 / 256;      ///< rows whose mean magnitude is below are background; radiance
  double horizon_cosine = 0.15;  ///< lights nearer to the surface's horizon do not tell shadows
  double dark = 0.4;             ///< of the diffuse fit: below it a light is blocked
  double blocked_share = 0.02;   ///< of the lights above the horizon that unoccluded rows may lack
  double highlight = 0.5;        ///< of the diffuse fit's peak: more above the fit is a highlight
};

/// Rows by kind (Yamada 2009, Section 5 and Figure 4), ascending. A row may be of several kinds.
struct FunctionKinds {
  std::vector<int64_t> object;      ///< all that are not background
  std::vector<int64_t> unoccluded;  ///< no light above the surface's horizon is blocked
  std::vector<int64_t> specular;    ///< has a highlight
};

/// Sorts the rows of a reflectance field by what the row itself shows. The paper does not say how
/// it did; here a row's diffuse part b max(0, n . l), n the normal and b the peak, is fitted by
/// least absolute error (reweighted least squares) to the lights where neither it nor the row is
/// dark, so that neither shadows nor highlights pull at it. A row is
///
///   unoccluded when at most `blocked_share` of the lights with n . l > `horizon_cosine` give less
///   than `dark` of the fit;
///   specular when some light gives more than `highlight` b above the fit.
///
/// Rows of fewer than four lights, or whose lit lights do not span space, are of neither kind.
/// Parallel; does not depend on the number of threads. Throws Error when the directions are not as
/// many as columns, or a number is not finite.
FunctionKinds SplitByKind(const Field& field, const FunctionKindOptions& options = {});

}  // namespace lfm
