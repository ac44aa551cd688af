// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>

namespace lfm {

/// The homography H with `to[i] ~ H from[i]`, scaled to unit Frobenius norm: direct linear
/// transform on normalised coordinates (Hartley and Zisserman, "Multiple View Geometry", algorithm
/// 4.2). Exact for four points, least squares in the algebraic error beyond.
///
/// No answer for fewer than four points, when all but one lie on a line or points repeat so that H
/// is not determined, or a coordinate is not finite.
std::optional<Eigen::Matrix3d> FitHomography(std::span<const Eigen::Vector2d> from,
                                             std::span<const Eigen::Vector2d> to);

/// H p, dehomogenised; infinite or NaN when p maps to the line at infinity.
inline Eigen::Vector2d MapByHomography(const Eigen::Matrix3d& h, const Eigen::Vector2d& p) {
  return (h * p.homogeneous()).hnormalized();
}

}  // namespace lfm
