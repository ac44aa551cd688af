// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/triangle_mesh.h"
#include "encode/model.h"

namespace lfm {

/// A sample on a triangle's edge and what the neighbour shows at the same place, between two of
/// its samples: (1 - share) * other[0] + share * other[1].
struct EdgeLink {
  struct Sample {
    int page = 0, x = 0, y = 0;  ///< texel
  };
  int triangle = 0, neighbor = 0;
  Sample own;
  std::array<Sample, 2> other;
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

/// The links of all edges that two triangles or more share, of the triangles that `wanted` names,
/// whose patches lie at `placements`: every sample of each side on every edge, ends included.
/// Triangles may share patches. In the order of the mesh's vertices.
std::vector<EdgeLink> FindEdgeLinks(const TriangleMesh& mesh,
                                    const std::vector<PatchPlacement>& placements,
                                    const std::function<bool(int triangle)>& wanted,
                                    PatchChannels channels);

}  // namespace lfm
