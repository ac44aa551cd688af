// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/triangle_mesh.h"

namespace lfm {

/// Where a ray met the mesh.
struct RayHit {
  int triangle = -1;
  double distance = 0;  ///< along the unit direction, mm
  double u = 0, v = 0;  ///< barycentric weights of corners 1 and 2 (corner 0 has 1 - u - v)
};

/// A triangle mesh prepared for ray casting and closest-point queries (Embree; float32 inside, so
/// the mesh is centred first: hits are good to about 1e-6 of the mesh's extent). Robust mode: rays
/// do not slip through shared edges. Immutable; safe to use from many threads.
class RayScene {
 public:
  /// Copies what it needs. Throws Error when the mesh has no triangle, an index out of range or a
  /// coordinate that is not finite. The answers do not depend on the number of threads.
  explicit RayScene(const TriangleMesh& mesh);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// First hit of origin + t * direction, t in [t_min, t_max] (direction need not be unit for the
  /// caller's convenience; `distance` and t are in units of its length). Both sides of a triangle
  /// count. A zero or non-finite ray meets nothing. The triangle is found in float32; distance, u
  /// and v are then computed in double precision, with u, v >= 0 and u + v <= 1.
  std::optional<RayHit> Intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double t_min = 0, double t_max = 1e30) const;
  /// Of each ray from one origin the distance of its first hit, in units of the direction's length;
  /// infinity where it meets nothing. As Intersect finds it, but for which triangle of a shared
  /// edge is hit; rays that lie beside one another share their search.
  void FirstDistances(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                      std::span<double> distances) const;
  /// True when anything lies between t_min and t_max.
  bool Occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min,
                double t_max) const;

  struct ClosestPoint {
    Eigen::Vector3d point;
    int triangle = -1;
    double distance = 0;  ///< mm
  };
  /// The closest point of the mesh to `query` within `max_distance`, in double precision; of
  /// equally near triangles the first. No answer for a non-finite query.
  std::optional<ClosestPoint> Closest(const Eigen::Vector3d& query,
                                      double max_distance = 1e30) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
