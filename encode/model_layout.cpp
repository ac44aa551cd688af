// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model_layout.h"

#include <algorithm>

#include "encode/tiling.h"

namespace lfm {

std::vector<Image> MakePages(const std::vector<Eigen::Vector2i>& sizes) {
  std::vector<Image> pages;
  for (const Eigen::Vector2i& size : sizes) {
    pages.emplace_back(size.x(), size.y(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  }
  return pages;
}

void WritePatch(Image& page, const PatchPlacement& placement, const uint8_t* codes, int first,
                int count) {
  const int n = placement.edge_samples;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const Eigen::Vector2i texel = TexelOfSample(placement, i, j);
      std::copy_n(codes + size_t{1} * PatchSampleIndex(n, i, j) * count, count,
                  &page.At<uint8_t>(texel.x(), texel.y(), first));
    }
  }
}

std::vector<uint8_t> ReadPatch(const Image& page, const PatchPlacement& placement, int first,
                               int count) {
  const int n = placement.edge_samples;
  std::vector<uint8_t> codes(size_t{1} * count * PatchSampleCount(n));
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const Eigen::Vector2i texel = TexelOfSample(placement, i, j);
      std::copy_n(&page.At<uint8_t>(texel.x(), texel.y(), first), count,
                  codes.data() + size_t{1} * PatchSampleIndex(n, i, j) * count);
    }
  }
  return codes;
}

void WriteTile(const std::vector<uint8_t>& codes, int term,
               const LightFieldModel::TilePosition& tile, LightFieldModel& model) {
  for (int row = 0; row < tile.grid; ++row) {
    std::copy_n(codes.data() + size_t{3} * row * tile.grid, 3 * tile.grid,
                &model.view_pages[term][tile.page].At<uint8_t>(tile.x, tile.y + row));
  }
}

namespace {

void WriteTerm(std::span<const int> ring, const TermMaps& maps, int vertex, int term,
               LightFieldModel& model) {
  const size_t range = term * model.vertex_frames.size() + vertex;
  model.surface_ranges[range] = maps.surface_range;
  model.view_ranges[range] = maps.view_range;
  const uint8_t* codes = maps.surface_codes.data();
  for (const int triangle : ring) {
    const PatchPlacement& placement = model.SurfacePlacement(term, triangle);
    WritePatch(model.surface_pages[term][placement.page], placement, codes,
               CornerOf(model.mesh.triangles[triangle], vertex), 1);
    codes += PatchSampleCount(placement.edge_samples);
  }
  WriteTile(maps.view_codes, term, model.ViewTile(term, vertex), model);
}

}  // namespace

LightFieldModel LayOutModel(const LightFieldSource& source, std::span<const int> edge_samples,
                            std::vector<int> vertex_terms, int max_texture_size,
                            PatchSpacing spacing) {
  LightFieldModel model;
  model.mesh = source.mesh;
  model.vertex_frames = source.vertex_frames;
  model.direction_map = source.direction_map;
  model.grid = source.grid;
  model.vertex_terms = std::move(vertex_terms);
  model.view_slots = RankByTerms(model.vertex_terms);
  const size_t vertices = model.vertex_terms.size();
  std::vector<int> triangle_terms;
  for (size_t t = 0; t < edge_samples.size(); ++t) {
    triangle_terms.push_back(model.TriangleTerms(static_cast<int>(t)));
  }
  PatchLayout patches = PlacePatches(edge_samples, triangle_terms, max_texture_size, spacing);
  const auto tiles_of_term = [&](int k) {
    return static_cast<int>(std::count_if(model.vertex_terms.begin(), model.vertex_terms.end(),
                                          [k](int terms) { return terms > k; }));
  };
  const ViewLayout views = PlaceViews(tiles_of_term(0), source.grid, max_texture_size);
  model.terms = model.vertex_terms.empty()
                    ? 0
                    : *std::max_element(model.vertex_terms.begin(), model.vertex_terms.end());
  patches.term_page_sizes.resize(model.terms);  // vertices of no triangle have tiles alone
  model.placements = std::move(patches.placements);
  model.mean_pages = MakePages(patches.page_sizes);
  for (int k = 0; k < model.terms; ++k) {
    model.surface_pages.push_back(MakePages(patches.term_page_sizes[k]));
    model.view_pages.push_back(MakePages(ViewPageSizes(views, tiles_of_term(k), source.grid)));
  }
  model.view_tiles_per_row = views.tiles_per_row;
  model.view_tiles_per_page = views.tiles_per_page;
  model.surface_ranges.assign(model.terms * vertices, MapRange{0, 0});
  model.view_ranges.assign(model.terms * vertices, MapRange{0, 0});
  return model;
}

void WriteMean(const std::vector<uint8_t>& codes, int triangle, LightFieldModel& model) {
  const PatchPlacement& placement = model.placements[triangle];
  WritePatch(model.mean_pages[placement.page], placement, codes.data(), 0, 3);
}

void WriteVertexTerms(std::span<const int> ring, const std::vector<TermMaps>& terms, int vertex,
                      LightFieldModel& model) {
  for (int k = 0; k < model.vertex_terms[vertex]; ++k) {
    WriteTerm(ring, terms[k], vertex, k, model);
  }
}

std::vector<uint8_t> ReadMean(const LightFieldModel& model, int triangle) {
  const PatchPlacement& placement = model.placements[triangle];
  return ReadPatch(model.mean_pages[placement.page], placement, 0, 3);
}

TermMaps ReadVertexTerm(const LightFieldModel& model, std::span<const int> ring, int vertex,
                        int term) {
  const size_t range = term * model.vertex_frames.size() + vertex;
  TermMaps maps{model.surface_ranges[range], model.view_ranges[range], {}, {}};
  for (const int triangle : ring) {
    const PatchPlacement& placement = model.SurfacePlacement(term, triangle);
    const std::vector<uint8_t> codes =
        ReadPatch(model.surface_pages[term][placement.page], placement,
                  CornerOf(model.mesh.triangles[triangle], vertex), 1);
    maps.surface_codes.insert(maps.surface_codes.end(), codes.begin(), codes.end());
  }
  const LightFieldModel::TilePosition tile = model.ViewTile(term, vertex);
  maps.view_codes.resize(size_t{3} * tile.grid * tile.grid);
  for (int row = 0; row < tile.grid; ++row) {
    std::copy_n(&model.view_pages[term][tile.page].At<uint8_t>(tile.x, tile.y + row), 3 * tile.grid,
                maps.view_codes.data() + size_t{3} * row * tile.grid);
  }
  return maps;
}

}  // namespace lfm
