// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "encode/model.h"

namespace lfm {

/// Where every triangle's patch lies. Two triangles of equal n share a rectangle of
/// (n + 4) x (n + 3) texels, the second turned by 180 degrees; each has one texel of gutter all
/// round (outside both legs, and the first diagonal beyond the hypotenuse), its own.
struct PatchLayout {
  std::vector<PatchPlacement> placements;   ///< one a triangle
  std::vector<Eigen::Vector2i> page_sizes;  ///< width, height in texels
};

/// Lays patches of the given n out on as few pages as fit into max_texture_size. Rectangles are
/// sorted by n and set in shelves; the page width is searched for the least waste (below 2 % from
/// some 500 triangles on). Throws Error when a single rectangle is larger than a page, or n < 2.
PatchLayout PlacePatches(std::span<const int> edge_samples, int max_texture_size);

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
/// Throws Error when a tile is larger than a page. No vertices: no pages.
ViewLayout PlaceViews(int vertices, int grid, int max_texture_size);

}  // namespace lfm
