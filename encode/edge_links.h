// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// A sample on a triangle's edge and what the neighbour shows at the same place, between two of
/// its samples: (1 - share) * other[0] + share * other[1]. Samples are (i, j) of their patches.
struct EdgeLink {
  int triangle = 0, neighbor = 0;
  Eigen::Vector2i own = {0, 0};
  std::array<Eigen::Vector2i, 2> other = {Eigen::Vector2i(0, 0), Eigen::Vector2i(0, 0)};
  float share = 0;
  /// Which channel of the neighbour's samples each of the own ones meets; -1: none, the map of the
  /// corner off the edge, which ends there.
  std::array<int, 3> channels = {0, 1, 2};
};

/// What the channels of a texel are.
enum class PatchChannels {
  kColors,   ///< the same in all triangles
  kCorners,  ///< the maps of the triangle's corners
};

/// The links of all edges that two triangles or more share: every sample of each side, ends
/// included. `edge_samples`: n of each triangle's patch; 0 where it has none. In the order of the
/// mesh's vertices.
std::vector<EdgeLink> FindEdgeLinks(const TriangleMesh& mesh, std::span<const int> edge_samples,
                                    PatchChannels channels);

}  // namespace lfm
