// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/triangle_mesh.h"
#include "encode/block_compression.h"
#include "resample/direction_map.h"

namespace lfm {

/// An 8-bit map's value: `scale * code / 255 + bias`.
struct MapRange {
  float scale = 1, bias = 0;
};

/// Where a triangle's patch lies in the surface pages. Texel (x, y) holds sample (i, j) with
/// x = origin.x + i, y = origin.y + j, or, when `flipped`, x = origin.x - i, y = origin.y - j: two
/// triangles share one rectangle.
struct PatchPlacement {
  int page = 0;
  Eigen::Vector2i origin = {0, 0};
  bool flipped = false;
  int edge_samples = 2;
  bool operator==(const PatchPlacement&) const = default;
};

/// How many tiles of view pages hold one map of the model's grid, four of half of it, sixteen of a
/// quarter.
using ViewTileCounts = std::array<int, 3>;

/// A surface light field in factored, quantised form: what `model.glb` holds and the renderers show
/// (Chen 2002, Equations 3 and 6). Colours are sRGB-coded, [0, 1].
///
///   colour(t, s, d) = mean_t(s) + sum over corners j, terms k of
///                     g[t, j, k](s) * h[vertex(t, j), k](direction of d in the vertex frame)
///
/// (with mean_in_terms the mean is weighted by the barycentric weights of corners without terms),
/// with g one number and h three (RGB) a sample. All maps are 8-bit codes with a MapRange.
struct LightFieldModel {
  TriangleMesh mesh;                           ///< mm, world frame; V vertices, T triangles
  std::vector<Eigen::Matrix3d> vertex_frames;  ///< V; columns x, y, z
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 32;
  int terms = 0;  ///< K, the most terms that any vertex has
  /// The terms hold the mean view too (NMF): it is shown by vertices without terms alone.
  bool mean_in_terms = false;

  std::vector<PatchPlacement> placements;  ///< T; of mean views, and surface maps without their own
  std::vector<Image> mean_pages;           ///< RGB 8 bit sRGB
  /// `surface_pages[k][page]`: RGB 8 bit, channel = corner of the triangle (three monochrome maps).
  /// They are the upper parts of the pages, and fewer, where not all triangles have term k.
  std::vector<std::vector<Image>> surface_pages;
  /// `view_pages[k][page]`: RGB 8 bit; vertex v has its grid x grid tile at ViewTile(k, v). Fewer,
  /// and
  /// the last one smaller, where not all vertices have term k.
  std::vector<std::vector<Image>> view_pages;
  std::vector<int> vertex_terms;  ///< V; terms that this vertex has, <= K
  std::vector<int> view_slots;    ///< V; RankByTerms(vertex_terms), for ViewTile
  /// `surface_ranges[k * V + v]`, `view_ranges[k * V + v]`: one range a vertex and term, so that
  /// samples on shared edges stay equal.
  std::vector<MapRange> surface_ranges, view_ranges;
  int view_tiles_per_row = 0, view_tiles_per_page = 0;
  /// Directions that no photograph of the triangles around the vertex covers: what the view maps
  /// hold there is an extrapolation (FindGuessedDirections). GuessedBytes(grid) bytes a vertex,
  /// texel q of its view map (rows from the top) in bit q % 8 of byte q / 8. Empty when not known.
  std::vector<uint8_t> guessed;

  /// Where surface maps lie by themselves, as in what Encode returns, K lists each; or empty:
  /// `surface_placements[k][t]` is where triangle t's surface maps of term k lie,
  /// `view_codes[k][v]` the number of vertex v's view map. They have no gutters beyond their legs,
  /// and may have fewer samples than the mean view. With vector quantisation (Chen 2002, Section 5)
  /// several triangles share a patch (of the mean view too, which `placements` shows), and several
  /// vertices a view map.
  std::vector<std::vector<PatchPlacement>> surface_placements;
  std::vector<std::vector<int>> view_codes;
  /// Where view maps have grids of their own, one a term; or empty. The tiles follow each other in
  /// this order, and maps are numbered in it, row by row within a tile.
  std::vector<ViewTileCounts> view_tile_counts;
  /// Pages in blocks, as graphics cards read them: none, or all; pages hold what they decode to.
  struct Blocks {
    std::vector<BlockPage> mean;
    std::vector<std::vector<BlockPage>> surface, view;
    bool empty() const { return mean.empty(); }
  };
  Blocks blocks;
  /// How many planes the blocks of surface pages have: 1 (BC1) or 3 (BC4).
  int SurfacePlanes() const;

  /// Whether texel `q` of the vertex's view maps is marked as guessed; no when that is not known.
  bool IsGuessed(int vertex, int q) const;

  const PatchPlacement& SurfacePlacement(int term, int triangle) const {
    return surface_placements.empty() ? placements[triangle] : surface_placements[term][triangle];
  }
  struct TilePosition {
    int page, x, y;  ///< top-left texel
    int grid;        ///< texels a side
  };
  TilePosition ViewMapAt(int term, int number) const;
  TilePosition ViewTile(int term, int vertex) const {
    return ViewMapAt(term, view_codes.empty() ? view_slots[vertex] : view_codes[term][vertex]);
  }
  /// Terms that the triangle's surface maps have: the most of its corners.
  int TriangleTerms(int triangle) const {
    const Eigen::Vector3i& corners = mesh.triangles[triangle];
    return std::max({vertex_terms[corners[0]], vertex_terms[corners[1]], vertex_terms[corners[2]]});
  }
  /// Bytes of all maps as they lie in the pages (in blocks where there are blocks), gutters,
  /// ranges, and the tables and indices of what is shared included; geometry excluded.
  int64_t MapsBytes() const;
};

/// Throws Error, beginning with `name`, when tables, pages and mesh do not fit together, so that no
/// reader of the model reads out of bounds.
void ValidateModel(const LightFieldModel& model, const std::string& name);

/// Where the different ones of a list of placements lie, in order of first use, and which of them
/// each is: a codebook, when they are fewer.
struct SharedPlacements {
  std::vector<PatchPlacement> codes;
  std::vector<uint32_t> indices;
  /// 8 bytes a code, and 2 (from 65537 codes on 4) an index.
  int64_t Bytes() const;
};
SharedPlacements FindSharedPlacements(const std::vector<PatchPlacement>& placements);

/// The first of the lists that is equal to list `k`: files hold it once.
template <typename List>
int FirstEqual(const std::vector<List>& lists, int k) {
  return static_cast<int>(std::find(lists.begin(), lists.begin() + k, lists[k]) - lists.begin());
}

/// Each vertex's place when those with more terms come first (among equals the lower index): the
/// first tiles of the view pages are then those of every term.
std::vector<int> RankByTerms(const std::vector<int>& vertex_terms);

}  // namespace lfm
