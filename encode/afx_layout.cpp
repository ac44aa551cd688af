// SPDX-License-Identifier: BSD-3-Clause
#include "encode/afx_layout.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "encode/model_layout.h"

namespace lfm {
namespace {

std::vector<int> EdgeSamples(const LightFieldModel& model) {
  std::vector<int> edge_samples;
  for (const PatchPlacement& p : model.placements) edge_samples.push_back(p.edge_samples);
  return edge_samples;
}

int LongestOf(const std::vector<Image>& pages) {
  int side = 0;
  for (const Image& page : pages) side = std::max({side, page.width(), page.height()});
  return side;
}

}  // namespace

bool HasSharedRanges(const LightFieldModel& model) {
  const size_t vertices = model.vertex_terms.size();
  for (int k = 0; k < model.terms; ++k) {
    std::set<std::pair<float, float>> ranges;
    for (size_t v = 0; v < vertices; ++v) {
      if (model.vertex_terms[v] <= k) continue;
      const MapRange& surface = model.surface_ranges[k * vertices + v];
      const MapRange& view = model.view_ranges[k * vertices + v];
      if (surface.scale != view.scale || surface.bias != view.bias) return false;
      ranges.emplace(surface.scale, surface.bias);
      if (ranges.size() > kMostLightMapsPerTerm) return false;
    }
  }
  return true;
}

int LongestSide(const LightFieldModel& model) {
  int side = std::max(kLeastSide, LongestOf(model.mean_pages));
  for (const auto& pages : model.surface_pages) side = std::max(side, LongestOf(pages));
  for (const auto& pages : model.view_pages) side = std::max(side, LongestOf(pages));
  for (const PatchPlacement& p : model.placements) side = std::max(side, p.edge_samples + 4);
  return model.terms > 0 ? std::max(side, model.grid) : side;
}

LightFieldModel LayOutOnSide(const LightFieldSource& source, std::span<const int> edge_samples,
                             const std::vector<int>& vertex_terms, int side) {
  while (true) {
    LightFieldModel model = LayOutModel(source, edge_samples, vertex_terms, side);
    const int longest = LongestSide(model);
    if (longest >= side) return model;
    side = longest;
  }
}

LightFieldModel StableLayout(const LightFieldModel& model) {
  // Without view maps a file does not say what grid they would have.
  const int grid = model.terms > 0 ? model.grid : 2;
  const LightFieldSource source{model.mesh, model.vertex_frames, model.direction_map, grid, {}, {},
                                0};
  return LayOutOnSide(source, EdgeSamples(model), model.vertex_terms, LongestSide(model));
}

LightFieldModel InPageOrder(const LightFieldModel& model) {
  const LightFieldModel layout = StableLayout(model);
  std::vector<size_t> order(model.placements.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return layout.placements[a].page < layout.placements[b].page;
  });
  LightFieldModel ordered = model;
  for (size_t i = 0; i < order.size(); ++i) {
    ordered.mesh.triangles[i] = model.mesh.triangles[order[i]];
    ordered.placements[i] = model.placements[order[i]];
  }
  return ordered;
}

}  // namespace lfm
