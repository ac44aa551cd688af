// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "encode/model.h"

namespace lfm {

/// Fills the gutters of mean and surface pages from the samples that lie in them already.
///
/// - Beyond the hypotenuse, at (i, n - i): the completion b + c - a of the cell's other texels
///   a = (i - 1, n - 1 - i), b = (i, n - 1 - i), c = (i - 1, n - i). Bilinear interpolation is then
///   linear in the cells on the hypotenuse, and along it depends on the edge's samples alone.
/// - Beyond the legs (row and column -1): the neighbour's samples next to the edge; a corner map of
///   a vertex that the neighbour does not have goes on as zero. At a boundary, the edge's own.
/// - At the ends: the nearest sample.
/// Where surface maps lie by themselves (`surface_placements`) they have completions alone.
/// Pages, placements and ranges must fit together, no patch be shared, and there be room (any model
/// from LayOutModel). Returns the model.
LightFieldModel FillGutters(LightFieldModel model);

/// The completions beyond the hypotenuse of one patch alone.
void CompletePatch(Image& page, const PatchPlacement& placement);

}  // namespace lfm
