// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/cube_map.h"
#include "fields/light_cells.h"

namespace lfm {

/// `count` directions of a spiral from the zenith down to height `lowest`.
inline std::vector<Eigen::Vector3d> Spiral(int count, double lowest) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (1 - lowest) * (i + 0.5) / count,
                 angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    directions.push_back(Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).normalized());
  }
  return directions;
}

/// The middles of a cube map's texels.
inline std::vector<Eigen::Vector3d> Cube(int resolution) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < 6 * resolution * resolution; ++i) {
    directions.push_back(CubeMap{resolution}.Direction(i).cast<double>().normalized());
  }
  return directions;
}

inline Eigen::Matrix3d RandomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

/// The first nearest of them.
inline int Nearest(const std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& d) {
  int nearest = 0;
  for (size_t i = 1; i < directions.size(); ++i) {
    if (directions[i].dot(d) > directions[nearest].dot(d)) nearest = static_cast<int>(i);
  }
  return nearest;
}

}  // namespace lfm
