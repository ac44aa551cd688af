// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "encode/light_field_source.h"
#include "encode/model.h"

namespace lfm {

inline constexpr int kMostLightMapsPerTerm = 16;
/// Pages need not be smaller than the least that lfm-encode --max-texture-size takes; many tiny
/// ones would take long to lay out.
inline constexpr int kLeastSide = 256;

/// Whether the maps of every vertex and term have one range in common, and those of a term at most
/// kMostLightMapsPerTerm different ones: what AFX can hold as it is.
bool HasSharedRanges(const LightFieldModel& model);

/// Empty pages for what `model` holds, on sides no longer than its longest (or 256), laid out such
/// that laying them out again on their own longest side gives the same.
LightFieldModel StableLayout(const LightFieldModel& model);

/// The layout that StableLayout ends with, begun with pages of `side`.
LightFieldModel LayOutOnSide(const LightFieldSource& source, std::span<const int> edge_samples,
                             const std::vector<int>& vertex_terms, int side);
/// The longest side of a model's pages; not below 256, nor what a single patch or tile takes.
int LongestSide(const LightFieldModel& model);

/// The same model, its triangles in the order of the pages that StableLayout gives them, among
/// those of a page in the order that they have: running it twice changes nothing more.
LightFieldModel InPageOrder(const LightFieldModel& model);

}  // namespace lfm
