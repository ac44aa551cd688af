// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/image.h"
#include "encode/block_compression.h"
#include "encode/edge_links.h"
#include "encode/model.h"

namespace lfm {

/// An EdgeLink between texels of pages.
struct PatchLink {
  struct Texel {
    int page = 0, x = 0, y = 0;
  };
  Texel own;
  std::array<Texel, 2> other;
  float share = 0;
  std::array<int, 3> channels = {0, 1, 2};
  float weight = 1;
};
/// `placements[t]` is where triangle t's patch lies; several may share one.
PatchLink InPages(const EdgeLink& link, const std::vector<PatchPlacement>& placements,
                  float weight);

/// Codes pages in blocks such that samples that meet across triangle edges stay near each other:
/// makes
///
///   sum over texels w |d - x|^2 + edge_weight * sum over links w |d - d_neighbor|^2
///
/// small, x being the texels as given, d as decoded, w the weights (a link has that of its use).
/// First every block by itself, the neighbour as given; then blocks with linked samples one after
/// another beside what their neighbours have become, a few times round; a block is replaced only
/// where that lowers its own part of the sum (its texels and the links from them). Blocks of
/// independent palettes cannot agree exactly. edge_weight 0: EncodePage. Does not depend on the
/// number of threads.
std::vector<BlockPage> EncodeLinkedPages(const std::vector<Image>& pages, BlockFormat format,
                                         std::vector<PageWeights> weights,
                                         std::span<const PatchLink> links, double edge_weight,
                                         BlockQuality quality);

}  // namespace lfm
