// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// Distances of a point to the parts that the bust is blended from, mm, negative inside; what the
/// paint goes by.
struct BustParts {
  double skin = 0, hair = 0, cloth = 0, pedestal = 0;
};

/// The studio's subject: an antique bust, 120 mm high, that stands on z = 0 on a flat base round
/// the origin and faces -y. An implicit surface: ellipsoids, capsules and relief, blended smoothly.
/// The distances are those of the blend, not Euclidean; their gradient is between 0.3 and 2.
BustParts BustPartDistances(const Eigen::Vector3d& point_mm);
/// The whole body: < 0 inside.
double BustDistance(const Eigen::Vector3d& point_mm);

/// The point in the head's own frame (the head is turned on the neck): x to its left as seen, -y
/// forwards, z up, origin between the ears. For painting eyes and lips.
Eigen::Vector3d BustHeadFrame(const Eigen::Vector3d& point_mm);

/// The bust's head alone, in its own frame: about 40 mm wide, 45 high, 50 deep. Distances as above.
/// Its skin is the skull with face and ears; its hair has curls, a band and a knot.
double BustFaceDistance(const Eigen::Vector3d& point_in_head);
double BustHairDistance(const Eigen::Vector3d& point_in_head);

inline constexpr double kBustHeightMm = 120;
/// Half extents of a box round the z axis that holds the bust.
inline constexpr double kBustHalfWidthMm = 52;

}  // namespace lfm
