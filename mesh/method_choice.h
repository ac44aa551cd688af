// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "core/point_cloud.h"

namespace lfm {

/// How a closed surface is made from points.
enum class SurfaceMethod {
  kAuto,     ///< as the data look
  kPoisson,  ///< screened Poisson: averages noise, closes smoothly; needs normals that agree
  kWrap,  ///< alpha wrapping: needs no normals and few points; keeps to the points, noise and all
};
/// "auto", "poisson", "wrap".
const char* NameOf(SurfaceMethod method);

/// What a cloud looks like to a method.
struct CloudLook {
  int64_t points = 0;
  /// Share of points whose normal is upright on their neighbourhood (within 45 degrees of its plane
  /// fit) and faces the side that most neighbours face.
  double normal_agreement = 0;
};
/// Looks at up to 20000 points, evenly chosen. Needs normals; no points give zeros.
CloudLook LookAtCloud(const PointCloud& points);

struct MethodChoice {
  SurfaceMethod method = SurfaceMethod::kPoisson;
  std::string reason;  ///< one line for people
};
/// Wrapping for fewer than 500 points, or when fewer than 75 % of the normals agree: a wrong normal
/// tells Poisson that inside is outside. Poisson otherwise. `asked` other than kAuto is kept.
MethodChoice ChooseMethod(const CloudLook& look, SurfaceMethod asked);

}  // namespace lfm
