// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model.h"

#include <array>
#include <map>
#include <numeric>

#include "core/error.h"
#include "encode/guessed_directions.h"
#include "encode/tiling.h"

namespace lfm {
namespace {

int64_t PageBytes(const std::vector<Image>& pages) {
  int64_t bytes = 0;
  for (const Image& page : pages) bytes += static_cast<int64_t>(page.Bytes().size());
  return bytes;
}

bool AllRgb8(const std::vector<Image>& pages) {
  return std::all_of(pages.begin(), pages.end(), [](const Image& page) {
    return page.type() == PixelType::kUint8 && page.channels() == 3;
  });
}

// The patch with its completions beyond the hypotenuse lies inside its page: what is read.
bool HoldsPatch(const std::vector<Image>& pages, const PatchPlacement& placement) {
  const int n = placement.edge_samples;
  if (n < 2 || placement.page < 0 || placement.page >= static_cast<int>(pages.size())) return false;
  const Eigen::Vector2i a = TexelOfSample(placement, 0, 0);
  const Eigen::Vector2i b = TexelOfSample(placement, n - 1, n - 1);
  const Image& page = pages[placement.page];
  return std::min(a.x(), b.x()) >= 0 && std::min(a.y(), b.y()) >= 0 &&
         std::max(a.x(), b.x()) < page.width() && std::max(a.y(), b.y()) < page.height();
}

bool HoldsTile(const std::vector<Image>& pages, const LightFieldModel::TilePosition& tile) {
  return tile.page < static_cast<int>(pages.size()) && tile.x >= 0 && tile.y >= 0 &&
         tile.x + tile.grid <= pages[tile.page].width() &&
         tile.y + tile.grid <= pages[tile.page].height();
}

// Counts are small enough to be added up, the last of the grids is one, and every vertex's map has
// a number below what they add up to.
bool CountsHold(const LightFieldModel& model, size_t term) {
  if (model.view_tile_counts.empty()) return true;
  constexpr int kMostTiles = 1 << 26;
  int64_t maps = 0;
  for (int level = 0; level < static_cast<int>(ViewTileCounts{}.size()); ++level) {
    const int count = model.view_tile_counts[term][level];
    if (count < 0 || count > kMostTiles) return false;
    if (count > 0 && (model.grid % (1 << level) != 0 || model.grid >> level < 2)) return false;
    maps += int64_t{count} << (2 * level);
  }
  for (size_t v = 0; v < model.vertex_terms.size(); ++v) {
    if (model.vertex_terms[v] > static_cast<int>(term) && model.view_codes[term][v] >= maps) {
      return false;
    }
  }
  return true;
}

bool FitPages(const std::vector<BlockPage>& blocks, const std::vector<Image>& pages, int planes) {
  if (blocks.size() != pages.size()) return false;
  for (size_t i = 0; i < pages.size(); ++i) {
    const BlockPage& page = blocks[i];
    if (page.width != pages[i].width() || page.height != pages[i].height() || page.width % 4 != 0 ||
        page.height % 4 != 0 || page.planes != planes ||
        page.blocks.size() != size_t{1} * planes * page.width * page.height / 2) {
      return false;
    }
  }
  return true;
}

// Mean and view pages in BC1; surface pages in BC1 or BC4, all alike.
bool BlocksFit(const LightFieldModel& model) {
  const LightFieldModel::Blocks& blocks = model.blocks;
  if (blocks.empty()) return blocks.surface.empty() && blocks.view.empty();
  const auto terms = static_cast<size_t>(model.terms);
  bool fit = FitPages(blocks.mean, model.mean_pages, 1) && blocks.surface.size() == terms &&
             blocks.view.size() == terms;
  const int planes = model.SurfacePlanes();
  for (size_t k = 0; k < terms && fit; ++k) {
    fit = FitPages(blocks.surface[k], model.surface_pages[k], planes) &&
          FitPages(blocks.view[k], model.view_pages[k], 1);
  }
  return fit && (planes == 1 || planes == 3);
}

int64_t BlockBytes(const std::vector<BlockPage>& pages) {
  int64_t bytes = 0;
  for (const BlockPage& page : pages) bytes += static_cast<int64_t>(page.blocks.size());
  return bytes;
}

int64_t IndexBytes(size_t codes) { return codes <= 1 << 16 ? 2 : 4; }

}  // namespace

void ValidateModel(const LightFieldModel& model, const std::string& name) {
  ValidateMesh(model.mesh, name.c_str());
  const auto require = [&name](bool condition, const char* problem) {
    if (!condition) throw Error(name + ": " + problem + "; run lfm-encode again");
  };
  const size_t vertices = model.mesh.vertices.size();
  const auto terms = static_cast<size_t>(std::max(0, model.terms));
  require(model.placements.size() == model.mesh.triangles.size() &&
              model.vertex_frames.size() == vertices && model.vertex_terms.size() == vertices &&
              model.view_slots == RankByTerms(model.vertex_terms) &&
              model.surface_ranges.size() == terms * vertices &&
              model.view_ranges.size() == terms * vertices,
          "its tables do not fit its mesh");
  const auto one_a_term = [&](const auto& lists, size_t size) {
    return lists.empty() || (lists.size() == terms &&
                             std::all_of(lists.begin(), lists.end(),
                                         [size](const auto& list) { return list.size() == size; }));
  };
  require(one_a_term(model.surface_placements, model.placements.size()) &&
              one_a_term(model.view_codes, vertices) &&
              model.surface_placements.empty() == model.view_codes.empty(),
          "its codebooks do not fit its mesh");
  require(model.surface_pages.size() == terms && model.view_pages.size() == terms,
          "it does not have one list of pages a term");
  constexpr int64_t kMostSide = 1 << 20;
  require(model.grid >= 2 && model.view_tiles_per_row >= 1 && model.view_tiles_per_page >= 1 &&
              int64_t{model.view_tiles_per_row} * model.grid <= kMostSide &&
              int64_t{(model.view_tiles_per_page - 1) / model.view_tiles_per_row} * model.grid <=
                  kMostSide,
          "its view tiles have no place");
  require(model.view_tile_counts.empty() ||
              (model.view_tile_counts.size() == terms && !model.view_codes.empty()),
          "its view maps have grids of their own without numbers");
  for (size_t k = 0; k < terms; ++k) {
    require(CountsHold(model, k), "its view maps do not fill its view tiles");
  }
  bool rgb = AllRgb8(model.mean_pages);
  for (size_t k = 0; k < terms; ++k) {
    rgb = rgb && AllRgb8(model.surface_pages[k]) && AllRgb8(model.view_pages[k]);
  }
  require(rgb, "its pages are not 8-bit RGB");
  require(BlocksFit(model), "its blocks do not fit its pages");
  require(model.guessed.empty() || model.guessed.size() == vertices * GuessedBytes(model.grid),
          "its guessed directions do not fit its view maps");
  for (size_t v = 0; v < vertices; ++v) {
    const int own = model.vertex_terms[v];
    require(own >= 0 && own <= model.terms, "a vertex has more terms than the model");
    for (int k = 0; k < own; ++k) {
      require(model.view_codes.empty() || model.view_codes[k][v] >= 0, "a view map has no tile");
      require(HoldsTile(model.view_pages[k], model.ViewTile(k, static_cast<int>(v))),
              "a view tile does not lie inside its page");
    }
  }
  for (size_t t = 0; t < model.placements.size(); ++t) {
    bool inside = HoldsPatch(model.mean_pages, model.placements[t]);
    for (int k = 0; k < model.TriangleTerms(static_cast<int>(t)) && inside; ++k) {
      const PatchPlacement& own = model.SurfacePlacement(k, static_cast<int>(t));
      inside = HoldsPatch(model.surface_pages[k], own) &&
               (!model.surface_placements.empty() ||
                model.surface_pages[k][own.page].width() == model.mean_pages[own.page].width());
    }
    require(inside, "a patch does not lie inside its page");
  }
}

LightFieldModel::TilePosition LightFieldModel::ViewMapAt(int term, int number) const {
  int tile = number, own = grid, x = 0, y = 0;
  if (!view_tile_counts.empty()) {
    const ViewTileCounts& counts = view_tile_counts[term];
    int level = 0, first = 0, within = number;
    while (level + 1 < static_cast<int>(counts.size()) && within >= int64_t{counts[level]}
                                                                        << (2 * level)) {
      within -= counts[level] << (2 * level);
      first += counts[level++];
    }
    const int last = (1 << level) - 1;  // renderers ask for every pixel: no divisions
    own = grid >> level;
    tile = first + (within >> (2 * level));
    x = (within & last) * own;
    y = (within >> level & last) * own;
  }
  const int in_page = tile % view_tiles_per_page;
  return {tile / view_tiles_per_page, in_page % view_tiles_per_row * grid + x,
          in_page / view_tiles_per_row * grid + y, own};
}

bool LightFieldModel::IsGuessed(int vertex, int q) const {
  if (guessed.empty()) return false;
  return (guessed[GuessedBytes(grid) * vertex + q / 8] >> q % 8 & 1) != 0;
}

int64_t LightFieldModel::MapsBytes() const {
  int64_t bytes = 0;
  if (blocks.empty()) {
    bytes += PageBytes(mean_pages);
    for (const auto& pages : surface_pages) bytes += PageBytes(pages);
    for (const auto& pages : view_pages) bytes += PageBytes(pages);
  } else {
    bytes += BlockBytes(blocks.mean);
    for (const auto& pages : blocks.surface) bytes += BlockBytes(pages);
    for (const auto& pages : blocks.view) bytes += BlockBytes(pages);
  }
  if (!surface_placements.empty() || terms == 0) {
    const SharedPlacements mean = FindSharedPlacements(placements);
    if (mean.codes.size() < placements.size()) bytes += mean.Bytes();
  }
  for (int k = 0; k < static_cast<int>(surface_placements.size()); ++k) {
    if (FirstEqual(surface_placements, k) == k) {
      bytes += FindSharedPlacements(surface_placements[k]).Bytes();
    }
  }
  for (int k = 0; k < static_cast<int>(view_codes.size()); ++k) {
    const std::vector<int>& list = view_codes[k];
    if (FirstEqual(view_codes, k) < k) continue;
    const int most = list.empty() ? 0 : *std::max_element(list.begin(), list.end());
    bytes += IndexBytes(static_cast<size_t>(most) + 1) * static_cast<int64_t>(list.size());
  }
  const size_t ranges = surface_ranges.size() + view_ranges.size();
  return bytes + static_cast<int64_t>(ranges * sizeof(MapRange));
}

int LightFieldModel::SurfacePlanes() const {
  for (const auto& pages : blocks.surface) {
    if (!pages.empty()) return pages.front().planes;
  }
  return 1;
}

int64_t SharedPlacements::Bytes() const {
  constexpr int64_t kPlacementBytes = 8;  // as in the file: page, x, y, 2 n + flipped
  return kPlacementBytes * static_cast<int64_t>(codes.size()) +
         IndexBytes(codes.size()) * static_cast<int64_t>(indices.size());
}

SharedPlacements FindSharedPlacements(const std::vector<PatchPlacement>& placements) {
  SharedPlacements shared;
  std::map<std::array<int, 5>, uint32_t> known;
  for (const PatchPlacement& p : placements) {
    const std::array<int, 5> key = {p.page, p.origin.y(), p.origin.x(), p.flipped ? 1 : 0,
                                    p.edge_samples};
    const auto [place, added] = known.try_emplace(key, static_cast<uint32_t>(shared.codes.size()));
    if (added) shared.codes.push_back(p);
    shared.indices.push_back(place->second);
  }
  return shared;
}

std::vector<int> RankByTerms(const std::vector<int>& vertex_terms) {
  std::vector<int> order(vertex_terms.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return vertex_terms[a] > vertex_terms[b]; });
  std::vector<int> rank(order.size());
  for (size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<int>(i);
  return rank;
}

}  // namespace lfm
