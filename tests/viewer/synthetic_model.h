// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "core/triangle_mesh.h"
#include "encode/model.h"

namespace lfm {

/// An icosahedron refined `levels` times (20 * 4^levels triangles), outward, with unit normals.
TriangleMesh MakeSphere(double radius, const Eigen::Vector3d& center, int levels);

/// What a hand-made model shows: colours are functions of the world point p, view maps of the
/// vertex, the term and the position on the square.
struct ModelRecipe {
  int terms = 0;
  int grid = 16;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  /// Mean view, [0, 1].
  std::function<Eigen::Vector3d(const Eigen::Vector3d& p)> mean;
  /// Surface map of term k before the hat weight, within [-1, 1]; stored times the weight.
  std::function<double(int k, const Eigen::Vector3d& p)> surface;
  /// View map, within [-1, 1].
  std::function<Eigen::Vector3d(int k, int vertex, const Eigen::Vector2d& square)> view;
  std::function<int(int vertex)> vertex_terms;  ///< absent: all terms
};

/// A model with small, oblong pages (several of each kind), patches of 5 and 9 samples an edge,
/// half of them flipped, ranges that differ by vertex and term.
LightFieldModel MakeModel(const TriangleMesh& mesh, const ModelRecipe& recipe);

/// Smooth random maps on a sphere of 60 mm round (10, -20, 80), 3 terms of which some vertices lack
/// some.
LightFieldModel MakeSmoothRandomModel(uint32_t seed, DirectionMap direction_map);

}  // namespace lfm
