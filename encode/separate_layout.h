// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "encode/model.h"
#include "encode/tiling.h"

namespace lfm {

/// How the pages of mean views and of surface maps are filled where each has its own.
struct SeparateSpacing {
  PatchSpacing mean = PatchSpacing::kNeighbors;
  PatchSpacing surface = PatchSpacing::kCompletions;  ///< only our own renderers read them
  PatchAlignment mean_alignment = PatchAlignment::kTexels;
  PatchAlignment surface_alignment = PatchAlignment::kTexels;
};

/// The resolutions of maps that lie by themselves.
struct SeparateSizes {
  /// `edge_samples(t, 0)` are those of triangle t's mean view, `edge_samples(t, k + 1)` those of
  /// its surface maps of term k, asked for triangles that have the term.
  std::function<int(int triangle, int layer)> edge_samples;
  /// How often the model's grid is halved for a vertex's view map, 0 to 2, asked for vertices that
  /// have the term; none: never.
  std::function<int(int vertex, int term)> view_level = {};
};

/// A model of the same mesh, terms and ranges with nothing in its pages, whose mean views and
/// surface maps of each term lie by themselves (`surface_placements`, `view_codes`). `model` may be
/// without pages of patches.
LightFieldModel LayOutSeparately(const LightFieldModel& model, const SeparateSizes& sizes,
                                 int max_texture_size, const SeparateSpacing& spacing = {});

/// The same maps laid out so, every sample of them; what the spacing leaves room for is filled. A
/// model without terms stays as it is unless its mean views are to be aligned. `model` shares no
/// patches.
LightFieldModel SeparateSurfaceMaps(const LightFieldModel& model, int max_texture_size,
                                    const SeparateSpacing& spacing = {});

/// Whether every surface map has as many samples as the mean view, every view map the model's grid,
/// and nothing is shared.
bool HasWholeMaps(const LightFieldModel& model);

/// The other way: one layout for mean views and surface maps, gutters all round. Throws Error
/// unless HasWholeMaps.
LightFieldModel JoinSurfaceMaps(const LightFieldModel& model);

}  // namespace lfm
