// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

// The implicit bodies that the studio's shapes are blended from. Each function is negative inside
// and close to the distance in mm near its surface; points and sizes are in mm. Blends after
// Quilez (polynomial smooth minimum): within `blend` of each other two bodies grow together.

namespace lfm {

inline double SmoothUnion(double a, double b, double blend) {
  const double h = std::max(0.0, blend - std::abs(a - b)) / blend;
  return std::min(a, b) - h * h * blend * 0.25;
}
inline double SmoothIntersection(double a, double b, double blend) {
  return -SmoothUnion(-a, -b, blend);
}
/// `body` without `tool`.
inline double SmoothCut(double body, double tool, double blend) {
  return -SmoothUnion(-body, tool, blend);
}

inline double Ball(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius) {
  return (p - center).norm() - radius;
}

/// Exact on the surface; its gradient there is 1.
inline double Ellipsoid(const Eigen::Vector3d& p, const Eigen::Vector3d& center,
                        const Eigen::Vector3d& radii) {
  const Eigen::Vector3d q = p - center;
  const double k0 = q.cwiseQuotient(radii).norm();
  const double k1 = q.cwiseQuotient(radii.cwiseProduct(radii)).norm();
  return k1 > 1e-12 ? k0 * (k0 - 1) / k1 : -radii.minCoeff();
}

/// A capsule from `a` to `b` whose radius goes from `ra` to `rb`.
inline double Limb(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                   double ra, double rb) {
  const Eigen::Vector3d ab = b - a;
  const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (p - a - t * ab).norm() - (ra + t * (rb - ra));
}

/// A box round `center` with edges rounded by `rounding`.
inline double RoundBox(const Eigen::Vector3d& p, const Eigen::Vector3d& center,
                       const Eigen::Vector3d& half, double rounding) {
  const Eigen::Vector3d q = (p - center).cwiseAbs() - half + Eigen::Vector3d::Constant(rounding);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

/// A disc (short cylinder) round the z axis through `center`, its edges rounded.
inline double RoundDisc(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius,
                        double half_height, double rounding) {
  const Eigen::Vector3d q = p - center;
  const double dr = std::hypot(q.x(), q.y()) - radius + rounding;
  const double dz = std::abs(q.z()) - half_height + rounding;
  return std::min(std::max(dr, dz), 0.0) + std::hypot(std::max(dr, 0.0), std::max(dz, 0.0)) -
         rounding;
}

/// A ring round the z axis through `center`.
inline double Ring(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius,
                   double thickness) {
  const Eigen::Vector3d q = p - center;
  return std::hypot(std::hypot(q.x(), q.y()) - radius, q.z()) - thickness;
}

/// Left and right are the same: features are given for the side x > 0.
inline Eigen::Vector3d Mirrored(const Eigen::Vector3d& p) {
  return {std::abs(p.x()), p.y(), p.z()};
}

/// `body()` where it can matter: farther than `reach` outside the ball round `center`, the distance
/// to that ball, which is no larger than the body's.
template <typename Body>
double Bounded(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double radius, double reach,
               const Body& body) {
  const double bound = (p - center).norm() - radius;
  return bound > reach ? bound : body();
}

}  // namespace lfm
