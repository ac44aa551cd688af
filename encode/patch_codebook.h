// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encode/map_groups.h"
#include "encode/model.h"
#include "encode/tiling.h"

namespace lfm {

/// How codes are found and laid out.
struct CodebookLayout {
  CodebookStart start = CodebookStart::kSplitting;
  PatchSpacing mean_spacing = PatchSpacing::kCompletions;
  PatchSpacing surface_spacing = PatchSpacing::kCompletions;
  PatchAlignment alignment = PatchAlignment::kTexels;
  int max_texture_size = 4096;
  double edge_weight = 0;  ///< linked_codebooks.h
};

/// Mean views from codebooks, one a group (MeanGroups) with `codes[g]` codes: new mean pages and
/// placements. Returns the model.
LightFieldModel ShareMeanViews(LightFieldModel model, std::span<const MapGroup> groups,
                               std::span<const int> codes, const CodebookLayout& layout);

/// Surface maps of a term from codebooks (SurfaceGroups): new pages, placements and ranges. Code
/// 128 is zero for every vertex, so that maps still end where they ended.
LightFieldModel ShareSurfaceMaps(LightFieldModel model, std::span<const MapGroup> groups,
                                 std::span<const int> codes, int term, const MapScales& scales,
                                 const CodebookLayout& layout);

/// View maps of all terms from codebooks of `codes[k]` codes: new pages and `view_codes`. Each code
/// fills its 8 bits; ranges are left to FitViewRanges.
LightFieldModel ShareViewMaps(LightFieldModel model, std::span<const FittedViews> views,
                              std::span<const int> codes, const CodebookLayout& layout);

}  // namespace lfm
