// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "core/triangle_mesh.h"
#include "encode/edge_links.h"
#include "encode/map_groups.h"
#include "encode/vector_quantization.h"

namespace lfm {

struct LinkedCodebookOptions {
  CodebookStart start = CodebookStart::kSplitting;
  double edge_weight = 0;
};

/// Codebooks for groups of patches of one kind (MeanGroups: kColors, or SurfaceGroups: kCorners),
/// with `codes[g]` codes each, such that triangles agree across their edges: makes
///
///   sum over samples w |y - x|^2 + edge_weight * sum over links w |y - y_neighbor|^2
///
/// small, x being a triangle's map, y its code. First with edges counting more; then, a few times,
/// maps are drawn to what their neighbours' codes show on the edges, and codes and choices follow
/// (generalised Lloyd from where they are). Of these the best is returned. Values of codes are in
/// the groups' units (a sample on an edge that nobody shares counts as if its neighbour agreed);
/// their distortion is that of the last iteration, edges included. edge_weight 0: QuantizeVectors,
/// group by group.
std::vector<Codebook> QuantizeLinkedGroups(const TriangleMesh& mesh, PatchChannels channels,
                                           std::span<const MapGroup> groups,
                                           std::span<const int> codes,
                                           const LinkedCodebookOptions& options);

}  // namespace lfm
