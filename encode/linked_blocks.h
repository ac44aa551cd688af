// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "core/image.h"
#include "encode/block_compression.h"
#include "encode/edge_links.h"

namespace lfm {

/// Codes pages in blocks such that samples that meet across triangle edges stay near each other:
/// makes
///
///   sum over texels w |d - x|^2 + edge_weight * sum over links w |d - d_neighbor|^2
///
/// small, x being the texels as given, d as decoded, w the weights (a link has that of its use:
/// `link_weights`). First every block by itself, the neighbour as given; then blocks with linked
/// samples one after another beside what their neighbours have become, a few times round; a block
/// is replaced only where that lowers the sum, so it never rises. Blocks of independent palettes
/// cannot agree exactly. edge_weight 0: EncodePage. Does not depend on the number of threads.
std::vector<BlockPage> EncodeLinkedPages(const std::vector<Image>& pages, BlockFormat format,
                                         std::vector<PageWeights> weights,
                                         std::span<const EdgeLink> links,
                                         std::span<const float> link_weights, double edge_weight,
                                         BlockQuality quality);

}  // namespace lfm
