// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/star_shape.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sample_data/shapes/implicit.h"

namespace lfm {

using V3 = Eigen::Vector3d;

Shape MakeStar(const StarSizes& sizes, double edge_mm) {
  if (!(sizes.arms >= 3 && sizes.arms <= 12 && sizes.notch_mm > 0 &&
        sizes.notch_mm < sizes.tip_mm && sizes.half_rim_mm > 0 &&
        sizes.half_rim_mm < sizes.half_depth_mm && sizes.bevel_mm > 0)) {
    throw Error("a star needs 3 to 12 arms, 0 < notch < tip, 0 < rim < depth and a bevel above 0");
  }
  // Half an arm, seen from the front, is one facet: the star is folded onto it. Coordinates:
  // along the arm, across it (both >= 0), towards the front.
  const double half_sector = std::numbers::pi / sizes.arms;
  const V3 apex(0, 0, sizes.half_depth_mm), tip(sizes.tip_mm, 0, sizes.half_rim_mm);
  const V3 notch(sizes.notch_mm * std::cos(half_sector), sizes.notch_mm * std::sin(half_sector),
                 sizes.half_rim_mm);
  const V3 facet = (tip - apex).cross(notch - apex).normalized();
  const V3 rim = (notch - tip).cross(V3::UnitZ()).normalized();
  const double bevel = sizes.bevel_mm;
  const auto half_arm = [=](double radius, double angle, double front) {
    const V3 q(radius * std::cos(angle), radius * std::sin(angle), front);
    return SmoothIntersection(facet.dot(q - tip), rim.dot(q - tip), bevel);
  };
  // Both halves meet in a ridge, neighbouring arms in a valley.
  const auto arm = [=](double radius, double angle, double front) {
    return SmoothIntersection(half_arm(radius, angle, front), half_arm(radius, -angle, front),
                              0.5 * bevel);
  };
  const auto star = [=](const V3& p) {
    const double radius = std::hypot(p.x(), p.z()), front = std::abs(p.y());
    const double folded = std::abs(std::remainder(std::atan2(p.x(), p.z()), 2 * half_sector));
    return SmoothUnion(arm(radius, folded, front), arm(radius, 2 * half_sector - folded, front),
                       bevel);
  };
  const double r = sizes.tip_mm, d = sizes.half_depth_mm;
  return PolygoniseShape(star, {-r, -d, -r}, {r, d, r}, edge_mm, 1.5);
}

}  // namespace lfm
