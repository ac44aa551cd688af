// SPDX-License-Identifier: BSD-3-Clause
#include "tests/viewer/compressed_models.h"

#include <algorithm>
#include <random>

#include "encode/gutters.h"
#include "encode/map_coarsening.h"
#include "encode/model_layout.h"
#include "encode/patch_resolution.h"
#include "encode/view_resolution.h"

namespace lfm {
namespace {

/// Pages whose sides are whole blocks.
std::vector<Image> Padded(const std::vector<Image>& pages) {
  std::vector<Image> padded;
  for (const Image& page : pages) {
    Image larger((page.width() + 3) / 4 * 4, (page.height() + 3) / 4 * 4, 3, PixelType::kUint8,
                 ColorEncoding::kSrgb);
    for (int y = 0; y < larger.height(); ++y) {
      for (int x = 0; x < larger.width(); ++x) {
        std::copy_n(
            &page.At<uint8_t>(std::min(x, page.width() - 1), std::min(y, page.height() - 1)), 3,
            &larger.At<uint8_t>(x, y));
      }
    }
    padded.push_back(std::move(larger));
  }
  return padded;
}

std::vector<BlockPage> Coded(std::vector<Image>& pages, BlockFormat format) {
  std::vector<BlockPage> blocks;
  for (Image& page : pages) {
    blocks.push_back(EncodePage(page, format, {}, BlockQuality::kFast));
    page = DecodePage(blocks.back());
  }
  return blocks;
}

}  // namespace

LightFieldModel InBlocks(LightFieldModel model, BlockFormat surface_format) {
  model.mean_pages = Padded(model.mean_pages);
  model.blocks.mean = Coded(model.mean_pages, BlockFormat::kBc1);
  for (int k = 0; k < model.terms; ++k) {
    model.surface_pages[k] = Padded(model.surface_pages[k]);
    model.view_pages[k] = Padded(model.view_pages[k]);
    model.blocks.surface.push_back(Coded(model.surface_pages[k], surface_format));
    model.blocks.view.push_back(Coded(model.view_pages[k], BlockFormat::kBc1));
  }
  return model;
}

LightFieldModel Sharing(LightFieldModel model) {
  std::mt19937 random(7);
  const int triangles = static_cast<int>(model.placements.size());
  const int vertices = static_cast<int>(model.vertex_terms.size());
  for (int k = 0; k < model.terms; ++k) {
    auto& placements = model.surface_placements.emplace_back(model.placements);
    for (int t = 0; t < triangles; ++t) {
      const int other = static_cast<int>(random() % triangles);
      if (model.TriangleTerms(other) > k) placements[t] = model.placements[other];
    }
    std::vector<int>& codes = model.view_codes.emplace_back(model.view_slots);
    for (int v = 0; v < vertices; ++v) {
      const int other = static_cast<int>(random() % vertices);
      if (model.vertex_terms[other] > k) codes[v] = model.view_slots[other];
    }
  }
  return model;
}

LightFieldModel Coarser(const LightFieldModel& model) {
  std::mt19937 random(9);
  MapSelection maps{model.vertex_terms, std::vector<std::vector<uint8_t>>(model.placements.size()),
                    std::vector<std::vector<uint8_t>>(model.vertex_terms.size())};
  std::vector<std::vector<uint8_t>>& levels = maps.levels;
  for (size_t v = 0; v < model.vertex_terms.size(); ++v) {
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      maps.view_levels[v].push_back(
          static_cast<uint8_t>(random() % ViewGridLevels(model.grid).size()));
    }
  }
  const auto level = [&](int t) {
    const size_t count = EdgeSampleLevels(model.placements[t].edge_samples).size();
    return static_cast<uint8_t>(random() % count);
  };
  for (int t = 0; t < static_cast<int>(levels.size()); ++t) {
    for (int k = 0; k <= model.TriangleTerms(t); ++k) levels[t].push_back(level(t));
  }
  LightFieldModel coarse = LayOutCoarsened(model, maps, 512);
  for (int v = 0; v < static_cast<int>(model.vertex_terms.size()); ++v) {
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      const auto from = model.ViewTile(k, v), to = coarse.ViewTile(k, v);
      for (int y = 0; y < to.grid; ++y) {
        std::copy_n(&model.view_pages[k][from.page].At<uint8_t>(from.x, from.y + y), 3 * to.grid,
                    &coarse.view_pages[k][to.page].At<uint8_t>(to.x, to.y + y));
      }
    }
  }
  const auto copy = [](const Image& from_page, const PatchPlacement& from, Image& to_page,
                       const PatchPlacement& to) {
    for (int c = 0; c < 3; ++c) {
      const std::vector<uint8_t> codes = ReadPatch(from_page, from, c, 1);
      const std::vector<uint8_t> kept =
          SubsamplePatch(std::span<const uint8_t>(codes), from.edge_samples, to.edge_samples);
      WritePatch(to_page, to, kept.data(), c, 1);
    }
    CompletePatch(to_page, to);
  };
  for (int t = 0; t < static_cast<int>(levels.size()); ++t) {
    const PatchPlacement& from = model.placements[t];
    const PatchPlacement& mean = coarse.placements[t];
    copy(model.mean_pages[from.page], from, coarse.mean_pages[mean.page], mean);
    for (int k = 0; k < model.TriangleTerms(t); ++k) {
      const PatchPlacement& to = coarse.SurfacePlacement(k, t);
      copy(model.surface_pages[k][from.page], from, coarse.surface_pages[k][to.page], to);
    }
  }
  return coarse;
}

}  // namespace lfm
