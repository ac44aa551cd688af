// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "encode/model.h"

namespace lfm {

/// What stands round the patches of a rectangle, which two triangles of equal n share, the second
/// turned by 180 degrees.
enum class PatchSpacing {
  kNeighbors,    ///< one texel of gutter all round: rectangles of (n + 4) x (n + 3) texels
  kCompletions,  ///< the diagonal beyond the hypotenuse alone: (n + 2) x (n + 1)
  kNone,         ///< nothing: the two patches fill (n + 1) x n texels
};

/// What begins and ends at whole blocks of 4 x 4 texels.
enum class PatchAlignment {
  kTexels,      ///< nothing
  kPages,       ///< pages: blocks may hold texels of several rectangles
  kShelves,     ///< rows of rectangles too: of two that stand side by side
  kRectangles,  ///< every rectangle: no block mixes them
};

/// Where every triangle's patch lies.
struct PatchLayout {
  std::vector<PatchPlacement> placements;   ///< one a triangle
  std::vector<Eigen::Vector2i> page_sizes;  ///< width, height in texels
  /// `term_page_sizes[k]`: of the pages of term k, no more than there are pages. Triangles with
  /// more terms come first and lie higher, so that a term's pages are the top of the pages.
  std::vector<std::vector<Eigen::Vector2i>> term_page_sizes;
};

/// Lays patches of the given n out on as few pages as fit into max_texture_size. `terms` says how
/// many terms each triangle has; empty stands for none. Rectangles are sorted by terms, then n, and
/// set in shelves; the page width is searched for the least waste (below 2 % from some 500
/// triangles of equal terms on). Throws Error when a single rectangle is larger than a page, n < 2,
/// or the two lists differ in length.
PatchLayout PlacePatches(std::span<const int> edge_samples, std::span<const int> terms,
                         int max_texture_size, PatchSpacing spacing = PatchSpacing::kNeighbors,
                         PatchAlignment alignment = PatchAlignment::kTexels);

/// The texel of sample (i, j); indices outside the patch name its gutters.
inline Eigen::Vector2i TexelOfSample(const PatchPlacement& placement, int i, int j) {
  const int sign = placement.flipped ? -1 : 1;
  return {placement.origin.x() + sign * i, placement.origin.y() + sign * j};
}

/// How view tiles (grid x grid texels, corner-aligned, no gutters) are arranged.
struct ViewLayout {
  int tiles_per_row = 1;
  int tiles_per_page = 1;
  std::vector<Eigen::Vector2i> page_sizes;
};
/// Throws Error when a tile is larger than a page. No tiles: no pages.
ViewLayout PlaceViews(int tiles, int grid, int max_texture_size);
/// The pages that the first `tiles` tiles take: a later term has no more tiles than the first.
std::vector<Eigen::Vector2i> ViewPageSizes(const ViewLayout& layout, int tiles, int grid);

}  // namespace lfm
