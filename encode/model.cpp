// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model.h"

#include <numeric>

#include "core/error.h"
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

// The patch with its gutters lies inside its page.
bool HoldsPatch(const std::vector<Image>& pages, const PatchPlacement& placement) {
  const int n = placement.edge_samples;
  if (n < 2 || placement.page < 0 || placement.page >= static_cast<int>(pages.size())) return false;
  const Eigen::Vector2i a = TexelOfSample(placement, -1, -1), b = TexelOfSample(placement, n, n);
  const Image& page = pages[placement.page];
  return std::min(a.x(), b.x()) >= 0 && std::min(a.y(), b.y()) >= 0 &&
         std::max(a.x(), b.x()) < page.width() && std::max(a.y(), b.y()) < page.height();
}

bool HoldsTile(const std::vector<Image>& pages, const LightFieldModel::TilePosition& tile,
               int grid) {
  return tile.page < static_cast<int>(pages.size()) && tile.x >= 0 && tile.y >= 0 &&
         tile.x + grid <= pages[tile.page].width() && tile.y + grid <= pages[tile.page].height();
}

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
  require(model.surface_pages.size() == terms && model.view_pages.size() == terms,
          "it does not have one list of pages a term");
  constexpr int64_t kMostSide = 1 << 20;
  require(model.grid >= 2 && model.view_tiles_per_row >= 1 && model.view_tiles_per_page >= 1 &&
              int64_t{model.view_tiles_per_row} * model.grid <= kMostSide &&
              int64_t{(model.view_tiles_per_page - 1) / model.view_tiles_per_row} * model.grid <=
                  kMostSide,
          "its view tiles have no place");
  bool rgb = AllRgb8(model.mean_pages);
  for (size_t k = 0; k < terms; ++k) {
    rgb = rgb && AllRgb8(model.surface_pages[k]) && AllRgb8(model.view_pages[k]);
  }
  require(rgb, "its pages are not 8-bit RGB");
  for (size_t v = 0; v < vertices; ++v) {
    const int own = model.vertex_terms[v];
    require(own >= 0 && own <= model.terms, "a vertex has more terms than the model");
    for (int k = 0; k < own; ++k) {
      require(HoldsTile(model.view_pages[k], model.ViewTile(static_cast<int>(v)), model.grid),
              "a view tile does not lie inside its page");
    }
  }
  for (size_t t = 0; t < model.placements.size(); ++t) {
    bool inside = HoldsPatch(model.mean_pages, model.placements[t]);
    for (int k = 0; k < model.TriangleTerms(static_cast<int>(t)) && inside; ++k) {
      inside = HoldsPatch(model.surface_pages[k], model.placements[t]) &&
               model.surface_pages[k][model.placements[t].page].width() ==
                   model.mean_pages[model.placements[t].page].width();
    }
    require(inside, "a patch does not lie inside its page");
  }
}

int64_t LightFieldModel::MapsBytes() const {
  int64_t bytes = PageBytes(mean_pages);
  for (const auto& pages : surface_pages) bytes += PageBytes(pages);
  for (const auto& pages : view_pages) bytes += PageBytes(pages);
  const size_t ranges = surface_ranges.size() + view_ranges.size();
  return bytes + static_cast<int64_t>(ranges * sizeof(MapRange));
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
