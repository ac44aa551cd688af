// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "encode/map_compression.h"
#include "encode/map_groups.h"
#include "encode/model.h"

namespace lfm {

/// Codes mean and surface pages in blocks, and decodes them: pages are what the blocks say from
/// then on. Texels that nobody reads do not count, completions of the mean view (which viewers
/// without our extension interpolate with) a quarter, and the channels of a surface block as their
/// vertices' ranges and view maps make them count; sides of an edge are coded towards each other
/// (linked_blocks.h). Returns the model.
LightFieldModel CodePatchPages(LightFieldModel model, const MapScales& scales,
                               const MapCompressionOptions& options);
/// The same for view pages, in BC1.
LightFieldModel CodeViewPages(LightFieldModel model, const MapCompressionOptions& options);

}  // namespace lfm
