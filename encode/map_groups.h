// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "encode/model.h"
#include "encode/vector_quantization.h"
#include "encode/view_refit.h"

namespace lfm {

/// Maps of one size and kind that share a codebook (Chen 2002, Section 5), as vectors. Distances
/// are what a map's change does to the light field: squared errors summed over samples, channels
/// and directions, colours in [0, 1].
struct MapGroup {
  int edge_samples = 0;     ///< of patches; 0: view maps
  std::vector<int> owners;  ///< triangles or vertices
  WeightedVectors vectors;
  int64_t code_bytes = 0;  ///< of one code in the pages
  double lost = 0;         ///< distortion by its resolution, before any vector quantisation
};

/// The same maps with every second sample of their patches (Chen 2002, Section 5.2: lower
/// resolution); none for view maps and where n is even or below 5.
std::optional<MapGroup> HalfResolution(const MapGroup& group);

/// RMS of each vertex's surface map over its ring, and sum of squares of its view map, of term k at
/// k * V + v; 0 where the vertex has no such term.
struct MapScales {
  std::vector<float> surface_rms, view_energy;
};
MapScales MeasureMapScales(const LightFieldModel& model);

/// Mean views, a group a patch size: RGB values, weight grid^2.
std::vector<MapGroup> MeanGroups(const LightFieldModel& model);
/// The blocks of three surface maps of a term, a group a patch size; segments are corners. Each map
/// is taken relative to its vertex's RMS, so that strong and weak vertices can share a code, and
/// counts by that RMS and the energy of its view map.
std::vector<MapGroup> SurfaceGroups(const LightFieldModel& model, const MapScales& scales,
                                    int term);
/// The view maps of a term, mean taken out and scaled to RMS 1 (a vertex's range brings both back);
/// each counts by that RMS and the energy of its surface map. No vertex with the term: no owners.
MapGroup ViewGroup(const LightFieldModel& model, std::span<const FittedViews> views, int term);

/// In which form a group is stored, and with how many codes.
struct GroupChoice {
  int halvings = 0;  ///< of the resolution
  int codes = 1;
};

/// A form for each group, and what they come to, as estimated.
struct GroupAllocation {
  std::vector<GroupChoice> choices;
  int64_t bytes = 0;  ///< of all codes
  double distortion = 0;
};

/// What each group gets, one code at least: that for which no byte spent elsewhere would lower the
/// total distortion more, as MeasureRates estimates it. Codes together take `max_bytes` at most
/// (but one code a group at the lowest resolution), or lose `max_distortion` at most.
GroupAllocation ChooseForBytes(std::span<const MapGroup> groups, int64_t max_bytes);
GroupAllocation ChooseForDistortion(std::span<const MapGroup> groups, double max_distortion);

}  // namespace lfm
