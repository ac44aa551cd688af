// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// Edge collapses in order of quadric error (Garland and Heckbert 1997).
///
/// The planes of the original triangles, weighted by area, are summed at the vertices; an edge
/// collapses to the point x that minimises
///   sum_i area_i (n_i . x - d_i)^2  +  a pull of 1/1000 of that strength to the edge's middle,
/// so vertices lie where the error is least, not on old ones. A small price on long edges keeps
/// flat regions even. Collapses that would flip a triangle, make a sliver, an edge much longer than
/// the others, or anything but a manifold, are not done. Boundaries are held by planes upright on
/// them. Copies go on independently.
class Decimation {
 public:
  /// `prices`, one a vertex or none, multiply the cost of collapses there: where they are high,
  /// triangles stay small (of a collapsed edge the higher one remains). Throws Error unless the
  /// mesh is valid and an oriented manifold, and prices are positive and finite.
  explicit Decimation(const TriangleMesh& mesh, const std::vector<double>& prices = {});
  Decimation(const Decimation& other);
  Decimation& operator=(const Decimation& other);
  ~Decimation();

  /// Collapses until at most `count` triangles are left, or none more can go. Never below 4.
  void ReduceTo(int64_t count);
  int64_t triangles() const;
  /// Vertices and triangles only.
  TriangleMesh Mesh() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Collapses edges shorter than `length_mm` to their middle where that keeps a manifold and turns
/// no triangle by more than 60 degrees. Points at z = 0 stay there. Vertices and triangles only.
TriangleMesh RemoveShortEdges(const TriangleMesh& mesh, double length_mm);

}  // namespace lfm
