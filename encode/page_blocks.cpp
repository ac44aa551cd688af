// SPDX-License-Identifier: BSD-3-Clause
#include "encode/page_blocks.h"

#include <algorithm>

#include "encode/tiling.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

constexpr float kCompletionWeight = 0.25f;
constexpr float kLeast = 1e-12f;  // even what does not count should not become noise

std::vector<PageWeights> EmptyWeights(const std::vector<Image>& pages) {
  std::vector<PageWeights> weights;
  for (const Image& page : pages) {
    const size_t texels = size_t{1} * page.width() * page.height();
    weights.push_back({std::vector<float>(texels, 0.f),
                       std::vector<std::array<float, 3>>(texels / 16, {0, 0, 0})});
  }
  return weights;
}

using Channels = std::array<float, 3>;

void AddTexel(int page_width, const Eigen::Vector2i& texel, const Channels& channels,
              PageWeights& weights) {
  weights.texels[size_t{1} * texel.y() * page_width + texel.x()] +=
      (channels[0] + channels[1] + channels[2]) / 3 + kLeast;
  Channels& block =
      weights.channels[size_t{1} * (texel.y() / 4) * (page_width / 4) + texel.x() / 4];
  for (int c = 0; c < 3; ++c) block[c] += channels[c] + kLeast;
}

void AddSamples(const PatchPlacement& placement, int page_width, const Channels& channels,
                PageWeights& weights) {
  const int n = placement.edge_samples;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      AddTexel(page_width, TexelOfSample(placement, i, j), channels, weights);
    }
  }
}

std::vector<PageWeights> MeanWeights(const LightFieldModel& model) {
  std::vector<PageWeights> weights = EmptyWeights(model.mean_pages);
  for (const PatchPlacement& placement : model.placements) {
    const int width = model.mean_pages[placement.page].width();
    AddSamples(placement, width, {1, 1, 1}, weights[placement.page]);
    for (int i = 1; i < placement.edge_samples; ++i) {
      AddTexel(width, TexelOfSample(placement, i, placement.edge_samples - i),
               {kCompletionWeight, kCompletionWeight, kCompletionWeight}, weights[placement.page]);
    }
  }
  return weights;
}

std::vector<PageWeights> SurfaceWeights(const LightFieldModel& model, const MapScales& scales,
                                        int term) {
  const size_t vertices = model.vertex_terms.size();
  std::vector<PageWeights> weights = EmptyWeights(model.surface_pages[term]);
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    if (model.TriangleTerms(t) <= term) continue;
    Channels channels{};
    for (int c = 0; c < 3; ++c) {
      const size_t range = term * vertices + model.mesh.triangles[t][c];
      const float scale = model.surface_ranges[range].scale;
      channels[c] = scale * scale * scales.view_energy[range];
    }
    const PatchPlacement& placement = model.SurfacePlacement(term, t);
    AddSamples(placement, model.surface_pages[term][placement.page].width(), channels,
               weights[placement.page]);
  }
  return weights;
}

std::vector<BlockPage> CodePages(const std::vector<Image>& pages, BlockFormat format,
                                 const std::vector<PageWeights>& weights, BlockQuality quality) {
  std::vector<BlockPage> blocks;
  for (size_t i = 0; i < pages.size(); ++i) {
    blocks.push_back(
        EncodePage(pages[i], format, weights.empty() ? PageWeights{} : weights[i], quality));
  }
  return blocks;
}

std::vector<Image> DecodePages(const std::vector<BlockPage>& blocks) {
  std::vector<Image> pages;
  for (const BlockPage& page : blocks) pages.push_back(DecodePage(page));
  return pages;
}

}  // namespace

LightFieldModel CodePatchPages(LightFieldModel model, const MapScales& scales,
                               const MapCompressionOptions& options) {
  const BlockFormat surface =
      options.blocks == PageBlocks::kBc4 ? BlockFormat::kBc4 : BlockFormat::kBc1;
  model.blocks.mean =
      CodePages(model.mean_pages, BlockFormat::kBc1, MeanWeights(model), options.block_quality);
  model.mean_pages = DecodePages(model.blocks.mean);
  model.blocks.surface.clear();
  for (int k = 0; k < model.terms; ++k) {
    model.blocks.surface.push_back(CodePages(
        model.surface_pages[k], surface, SurfaceWeights(model, scales, k), options.block_quality));
    model.surface_pages[k] = DecodePages(model.blocks.surface[k]);
  }
  return model;
}

LightFieldModel CodeViewPages(LightFieldModel model, const MapCompressionOptions& options) {
  model.blocks.view.clear();
  for (int k = 0; k < model.terms; ++k) {
    model.blocks.view.push_back(
        CodePages(model.view_pages[k], BlockFormat::kBc1, {}, options.block_quality));
    model.view_pages[k] = DecodePages(model.blocks.view[k]);
  }
  return model;
}

}  // namespace lfm
