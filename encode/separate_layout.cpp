// SPDX-License-Identifier: BSD-3-Clause
#include "encode/separate_layout.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/gutters.h"
#include "encode/model_layout.h"
#include "encode/model_order.h"

namespace lfm {
namespace {

// What is the same in any layout of the same terms.
LightFieldModel WithoutPages(const LightFieldModel& model) {
  LightFieldModel other;
  other.mesh = model.mesh;
  other.vertex_frames = model.vertex_frames;
  other.direction_map = model.direction_map;
  other.grid = model.grid;
  other.terms = model.terms;
  other.mean_in_terms = model.mean_in_terms;
  other.vertex_terms = model.vertex_terms;
  other.view_slots = model.view_slots;
  other.surface_ranges = model.surface_ranges;
  other.view_ranges = model.view_ranges;
  return other;
}

void CopyMaps(const LightFieldModel& from, LightFieldModel& to) {
  for (int t = 0; t < static_cast<int>(to.placements.size()); ++t) {
    WriteMean(ReadMean(from, t), t, to);
  }
  const VertexRings rings = ComputeVertexRings(from.mesh);
  ParallelFor(0, static_cast<int64_t>(from.vertex_terms.size()), [&](int64_t v) {
    const auto vertex = static_cast<int>(v);
    std::vector<TermMaps> terms;
    for (int k = 0; k < from.vertex_terms[v]; ++k) {
      terms.push_back(ReadVertexTerm(from, rings.Ring(v), vertex, k));
    }
    WriteVertexTerms(rings.Ring(v), terms, vertex, to);
  });
}

// Of each term the maps of the model's grid first, then smaller ones; among equals, vertices with
// more terms.
void PlaceSeparateViews(const std::function<int(int vertex, int term)>& level_of,
                        int max_texture_size, LightFieldModel& model) {
  const size_t vertices = model.vertex_terms.size();
  std::vector<size_t> order(vertices);
  for (size_t v = 0; v < vertices; ++v) order[model.view_slots[v]] = v;
  int most = 0;
  bool any_smaller = false;
  model.view_codes.assign(model.terms, std::vector<int>(vertices, 0));
  std::vector<ViewTileCounts> counts(model.terms, ViewTileCounts{});
  for (int k = 0; k < model.terms; ++k) {
    int first = 0;
    for (int level = 0; level < static_cast<int>(counts[k].size()); ++level) {
      const int maps_a_tile = 1 << (2 * level);
      int maps = 0;
      for (const size_t v : order) {
        const bool has = model.vertex_terms[v] > k;
        if (has && level == (level_of ? level_of(static_cast<int>(v), k) : 0)) {
          model.view_codes[k][v] = first + maps++;
        }
      }
      counts[k][level] = (maps + maps_a_tile - 1) / maps_a_tile;
      first += counts[k][level] * maps_a_tile;
      any_smaller = any_smaller || (level > 0 && maps > 0);
    }
    most = std::max(most, std::accumulate(counts[k].begin(), counts[k].end(), 0));
  }
  const ViewLayout layout = PlaceViews(most, model.grid, max_texture_size);
  model.view_tiles_per_row = layout.tiles_per_row;
  model.view_tiles_per_page = layout.tiles_per_page;
  for (const ViewTileCounts& own : counts) {
    model.view_pages.push_back(
        MakePages(ViewPageSizes(layout, std::accumulate(own.begin(), own.end(), 0), model.grid)));
  }
  if (any_smaller) model.view_tile_counts = std::move(counts);
}

// What stands beyond the hypotenuses, where there is room.
void Complete(const SeparateSpacing& spacing, LightFieldModel& model) {
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    if (spacing.mean != PatchSpacing::kNone) {
      CompletePatch(model.mean_pages[model.placements[t].page], model.placements[t]);
    }
    for (int k = 0; k < model.TriangleTerms(t) && spacing.surface != PatchSpacing::kNone; ++k) {
      const PatchPlacement& own = model.SurfacePlacement(k, t);
      CompletePatch(model.surface_pages[k][own.page], own);
    }
  }
}

}  // namespace

LightFieldModel LayOutSeparately(const LightFieldModel& model, const SeparateSizes& wanted,
                                 int max_texture_size, const SeparateSpacing& spacing) {
  LightFieldModel separate = WithoutPages(model);
  const auto triangles = static_cast<int>(model.mesh.triangles.size());
  std::vector<int> sizes;
  for (int t = 0; t < triangles; ++t) sizes.push_back(wanted.edge_samples(t, 0));
  PatchLayout mean =
      PlacePatches(sizes, {}, max_texture_size, spacing.mean, spacing.mean_alignment);
  separate.placements = std::move(mean.placements);
  separate.mean_pages = MakePages(mean.page_sizes);
  for (int k = 0; k < model.terms; ++k) {
    std::vector<int> owners;
    sizes.clear();
    for (int t = 0; t < triangles; ++t) {
      if (model.TriangleTerms(t) <= k) continue;
      owners.push_back(t);
      sizes.push_back(wanted.edge_samples(t, k + 1));
    }
    const PatchLayout layout =
        PlacePatches(sizes, {}, max_texture_size, spacing.surface, spacing.surface_alignment);
    separate.surface_pages.push_back(MakePages(layout.page_sizes));
    separate.surface_placements.emplace_back(triangles, PatchPlacement{});
    for (size_t i = 0; i < owners.size(); ++i) {
      separate.surface_placements[k][owners[i]] = layout.placements[i];
    }
  }
  PlaceSeparateViews(wanted.view_level, max_texture_size, separate);
  return separate;
}

LightFieldModel SeparateSurfaceMaps(const LightFieldModel& model, int max_texture_size,
                                    const SeparateSpacing& spacing) {
  if (model.terms == 0 && spacing.mean_alignment == PatchAlignment::kTexels) return model;
  LightFieldModel separate =
      LayOutSeparately(model, {[&](int t, int layer) {
                         return layer == 0 ? model.placements[t].edge_samples
                                           : model.SurfacePlacement(layer - 1, t).edge_samples;
                       }},
                       max_texture_size, spacing);
  CopyMaps(model, separate);
  if (spacing.mean == PatchSpacing::kNeighbors) return FillGutters(std::move(separate));
  Complete(spacing, separate);
  return separate;
}

bool HasWholeMaps(const LightFieldModel& model) {
  if (!model.view_tile_counts.empty()) return false;
  const auto triangles = static_cast<int>(model.placements.size());
  if (FindSharedPlacements(model.placements).codes.size() < model.placements.size()) return false;
  for (int k = 0; k < model.terms; ++k) {
    std::vector<PatchPlacement> patches;
    for (int t = 0; t < triangles; ++t) {
      if (model.TriangleTerms(t) > k) patches.push_back(model.SurfacePlacement(k, t));
      if (model.TriangleTerms(t) > k &&
          patches.back().edge_samples != model.placements[t].edge_samples) {
        return false;
      }
    }
    if (FindSharedPlacements(patches).codes.size() < patches.size()) return false;
    if (model.view_codes.empty()) continue;
    std::set<int> tiles;
    for (size_t v = 0; v < model.vertex_terms.size(); ++v) {
      if (model.vertex_terms[v] > k && !tiles.insert(model.view_codes[k][v]).second) return false;
    }
  }
  return true;
}

LightFieldModel JoinSurfaceMaps(const LightFieldModel& model) {
  if (!HasWholeMaps(model)) {
    throw Error("maps that are shared, or of fewer samples than the mean view, cannot be joined");
  }
  return ReorderModel(model, KeptOrder(model.mesh));
}

}  // namespace lfm
