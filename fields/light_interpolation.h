// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace lfm {

/// How much of each of several lights makes up a light from elsewhere: number and weight; weights
/// are positive and add up to 1.
using LightWeights = std::vector<std::pair<int, double>>;

/// The light that is nearest in angle, the first of equals. Throws Error without any light.
LightWeights NearestLight(const std::vector<Eigen::Vector3d>& to_lights,
                          const Eigen::Vector3d& to_light);

/// The barycentric weights of `to_light` in its triangle of the lights' spherical Delaunay
/// triangulation (the face of their convex hull that it passes through): 1 at a light, linear along
/// edges, continuous. Unit vectors.
///
/// Where no such triangle has all corners among the 24 nearest lights (outside the dome, fewer than
/// three lights, all on a circle), the nearest point of an edge between two of these decides, so
/// that a light alone is the answer everywhere when there is no other. A direction that comes twice
/// counts once, the first time.
LightWeights SphericalWeights(const std::vector<Eigen::Vector3d>& to_lights,
                              const Eigen::Vector3d& to_light);

}  // namespace lfm
