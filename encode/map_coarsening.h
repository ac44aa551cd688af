// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encode/light_field_source.h"
#include "encode/map_selection.h"
#include "encode/model.h"
#include "encode/vertex_factorization.h"

namespace lfm {

/// Whether maps may have fewer samples than the light field has, where that is worth it.
enum class MapDetail { kAsNeeded, kFull };

struct MapDetails {
  MapDetail patches = MapDetail::kAsNeeded;  ///< mean views and surface maps, each by itself
  MapDetail views = MapDetail::kAsNeeded;    ///< view maps, each by itself
};

/// What the terms of `vertices` and the mean view cost, with every sample or also at each coarser
/// resolution. `edge_samples` and `mean_codes` (3 a sample) are the triangles'. What coarser
/// maps add is estimated a term at a time: squared change of the map x energy of the map that it is
/// multiplied with; in triangles that nobody saw too, where it is no error against the light field
/// but would be seen.
MapCosts MeasureMapCosts(const LightFieldSource& source, std::span<const int> edge_samples,
                         std::span<const std::vector<uint8_t>> mean_codes,
                         std::span<const VertexTerms> vertices, const MapDetails& details);

/// A model of the same terms without maps in the pages, as large as CoarsenMaps makes it: what a
/// selection will take.
LightFieldModel LayOutCoarsened(const LightFieldModel& model, const MapSelection& maps,
                                int max_texture_size);

/// The maps of a whole model (one from LayOutModel with its maps written) in the resolutions that
/// `maps` names: coarser surface maps keep the samples that they share with finer ones (Chen 2002,
/// Section 5.2: lower resolution for higher terms), so that neighbours of different resolution
/// still agree along their edge to half a code; then view maps are fitted anew to what surface maps
/// and mean views have become (view_refit.h), and coarser ones to those (view_resolution.h).
/// Patches are laid out a term by itself; gutters beyond the legs are the mean view's alone.
LightFieldModel CoarsenMaps(const LightFieldSource& source, const LightFieldModel& model,
                            const MapSelection& maps, double guessed_weight, int max_texture_size);

}  // namespace lfm
