// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "encode/block_compression.h"
#include "encode/model.h"

namespace lfm {

/// The model with its pages in blocks, mean and view pages in BC1, padded to whole ones.
LightFieldModel InBlocks(LightFieldModel model, BlockFormat surface_format);

/// Triangles and vertices show each other's maps, another's in each term.
LightFieldModel Sharing(LightFieldModel model);

/// Each triangle keeps every sample, or fewer, of its mean view and of each term by itself; each
/// vertex shows its view map, of its grid or the first texels of it as one of half or a quarter.
LightFieldModel Coarser(const LightFieldModel& model);

}  // namespace lfm
