// SPDX-License-Identifier: BSD-3-Clause
#include "encode/patch_codebook.h"

#include <algorithm>
#include <cmath>

#include "encode/gutters.h"
#include "encode/linked_codebooks.h"
#include "encode/map_quantization.h"
#include "encode/model_layout.h"
#include "encode/quantization.h"

namespace lfm {
namespace {

// The patches of one codebook, several groups one after the other, and who uses which.
struct PatchCodes {
  std::vector<int> edge_samples;
  std::vector<std::vector<uint8_t>> texels;  // 3 a sample
  std::vector<int> code_of;                  // a triangle; -1 where it has none

  // Codes of a group whose triangles are coded by `book`; `texel(code, sample, channel)` gives one.
  template <typename Texel>
  void Add(const MapGroup& group, const Codebook& book, const Texel& texel) {
    const int first = static_cast<int>(texels.size()),
              samples = PatchSampleCount(group.edge_samples);
    for (int code = 0; code < book.codes; ++code) {
      edge_samples.push_back(group.edge_samples);
      std::vector<uint8_t>& own = texels.emplace_back();
      for (int s = 0; s < samples; ++s) {
        for (int c = 0; c < 3; ++c) own.push_back(texel(code, s, c));
      }
    }
    for (size_t i = 0; i < group.owners.size(); ++i) {
      code_of[group.owners[i]] = first + book.indices[i];
    }
  }
};

struct PatchPages {
  std::vector<Image> pages;
  std::vector<PatchPlacement> placements;  // a triangle
};

PatchPages LayOutCodes(const PatchCodes& codes, PatchSpacing spacing, const CodebookLayout& how) {
  const PatchLayout layout =
      PlacePatches(codes.edge_samples, {}, how.max_texture_size, spacing, how.alignment);
  PatchPages result{MakePages(layout.page_sizes), {}};
  for (size_t i = 0; i < codes.texels.size(); ++i) {
    const PatchPlacement& placement = layout.placements[i];
    WritePatch(result.pages[placement.page], placement, codes.texels[i].data(), 0, 3);
    if (spacing != PatchSpacing::kNone) {
      CompletePatch(result.pages[placement.page], placement);
    }
  }
  for (const int code : codes.code_of) {
    result.placements.push_back(code >= 0 ? layout.placements[code] : PatchPlacement{});
  }
  return result;
}

uint8_t Rounded(double value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

LightFieldModel ShareMeanViews(LightFieldModel model, std::span<const MapGroup> groups,
                               std::span<const int> codes, const CodebookLayout& layout) {
  PatchCodes patches{{}, {}, std::vector<int>(model.placements.size(), -1)};
  const std::vector<Codebook> books = QuantizeLinkedGroups(
      model.mesh, PatchChannels::kColors, groups, codes, {layout.start, layout.edge_weight});
  for (size_t g = 0; g < groups.size(); ++g) {
    const Codebook& book = books[g];
    const int dimensions = groups[g].vectors.dimensions;
    patches.Add(groups[g], book, [&](int code, int sample, int channel) {
      return Rounded(255.0 * book.values[size_t{1} * code * dimensions + 3 * sample + channel]);
    });
  }
  PatchPages pages = LayOutCodes(patches, layout.mean_spacing, layout);
  model.mean_pages = std::move(pages.pages);
  model.placements = std::move(pages.placements);
  return model;
}

LightFieldModel ShareSurfaceMaps(LightFieldModel model, std::span<const MapGroup> groups,
                                 std::span<const int> codes, int term, const MapScales& scales,
                                 const CodebookLayout& layout) {
  // Codes 3 to 253: completions of rounded codes stay inside.
  constexpr float kZero = 128, kReach = 125;
  const std::vector<Codebook> books = QuantizeLinkedGroups(
      model.mesh, PatchChannels::kCorners, groups, codes, {layout.start, layout.edge_weight});
  float peak = 0;
  for (size_t g = 0; g < groups.size(); ++g) {
    const size_t samples = PatchSampleCount(groups[g].edge_samples);
    for (size_t map = 0; map < books[g].values.size() / samples; ++map) {
      const std::span<const float> values(books[g].values.data() + map * samples, samples);
      peak =
          std::max(peak, SurfaceExtent(std::vector<int>{groups[g].edge_samples}, values).max_abs());
    }
  }
  PatchCodes patches{{}, {}, std::vector<int>(model.placements.size(), -1)};
  for (size_t g = 0; g < groups.size(); ++g) {
    const int dimensions = groups[g].vectors.dimensions;
    patches.Add(groups[g], books[g], [&](int code, int sample, int channel) {
      const float value =
          books[g].values[size_t{1} * code * dimensions + channel * (dimensions / 3) + sample];
      return Rounded(peak > 0 ? kZero + kReach * value / peak : kZero);
    });
  }
  PatchPages pages = LayOutCodes(patches, layout.surface_spacing, layout);
  model.surface_pages[term] = std::move(pages.pages);
  model.surface_placements.resize(model.terms);
  model.surface_placements[term] = std::move(pages.placements);
  const size_t vertices = model.vertex_terms.size();
  for (size_t v = 0; v < vertices; ++v) {
    const float scale = scales.surface_rms[term * vertices + v] * peak * 255 / kReach;
    model.surface_ranges[term * vertices + v] = {scale, -(scale * kZero / 255)};
  }
  return model;
}

LightFieldModel ShareViewMaps(LightFieldModel model, std::span<const FittedViews> views,
                              std::span<const int> codes, const CodebookLayout& layout) {
  std::vector<Codebook> books;
  model.view_codes.assign(model.terms, std::vector<int>(views.size(), 0));
  int most = 0;
  for (int k = 0; k < model.terms; ++k) {
    const MapGroup group = ViewGroup(model, views, k);
    books.push_back(QuantizeVectors(group.vectors, codes[k], {.start = layout.start}));
    for (size_t i = 0; i < group.owners.size(); ++i) {
      model.view_codes[k][group.owners[i]] = books[k].indices[i];
    }
    most = std::max(most, books[k].codes);
  }
  const ViewLayout tiles = PlaceViews(most, model.grid, layout.max_texture_size);
  model.view_tiles_per_row = tiles.tiles_per_row;
  model.view_tiles_per_page = tiles.tiles_per_page;
  const size_t length = size_t{3} * model.grid * model.grid;
  for (int k = 0; k < model.terms; ++k) {
    model.view_pages[k] = MakePages(ViewPageSizes(tiles, books[k].codes, model.grid));
    for (int code = 0; code < books[k].codes; ++code) {
      const std::span<const float> values(books[k].values.data() + code * length, length);
      const auto [low, high] = std::minmax_element(values.begin(), values.end());
      const MapRange range = ViewRange(*low, *high);
      std::vector<uint8_t> texels;
      for (const float value : values) texels.push_back(QuantizeValue(range, value));
      WriteTile(texels, k, model.ViewMapAt(k, code), model);
    }
  }
  return model;
}

}  // namespace lfm
