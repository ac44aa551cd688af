// SPDX-License-Identifier: BSD-3-Clause
#include "encode/page_blocks.h"

#include <algorithm>

#include "encode/edge_links.h"
#include "encode/linked_blocks.h"
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

// How much the corners' maps of a triangle count.
Channels CornerWeights(const LightFieldModel& model, const MapScales& scales, int term,
                       int triangle) {
  Channels channels{};
  for (int c = 0; c < 3; ++c) {
    const size_t range = term * model.vertex_terms.size() + model.mesh.triangles[triangle][c];
    const float scale = model.surface_ranges[range].scale;
    channels[c] = scale * scale * scales.view_energy[range];
  }
  return channels;
}

std::vector<PageWeights> SurfaceWeights(const LightFieldModel& model, const MapScales& scales,
                                        int term) {
  std::vector<PageWeights> weights = EmptyWeights(model.surface_pages[term]);
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    if (model.TriangleTerms(t) <= term) continue;
    const PatchPlacement& placement = model.SurfacePlacement(term, t);
    AddSamples(placement, model.surface_pages[term][placement.page].width(),
               CornerWeights(model, scales, term, t), weights[placement.page]);
  }
  return weights;
}

std::vector<BlockPage> CodeMeanPages(const LightFieldModel& model,
                                     const MapCompressionOptions& options) {
  std::vector<int> edge_samples;
  for (const PatchPlacement& placement : model.placements) {
    edge_samples.push_back(placement.edge_samples);
  }
  std::vector<PatchLink> links;
  for (const EdgeLink& link : FindEdgeLinks(model.mesh, edge_samples, PatchChannels::kColors)) {
    links.push_back(InPages(link, model.placements, 1));
  }
  return EncodeLinkedPages(model.mean_pages, BlockFormat::kBc1, MeanWeights(model), links,
                           options.edge_weight, options.block_quality);
}

std::vector<BlockPage> CodeSurfacePages(const LightFieldModel& model, const MapScales& scales,
                                        int term, const MapCompressionOptions& options) {
  const std::vector<PatchPlacement>& placements =
      model.surface_placements.empty() ? model.placements : model.surface_placements[term];
  std::vector<int> edge_samples;
  for (int t = 0; t < static_cast<int>(placements.size()); ++t) {
    edge_samples.push_back(model.TriangleTerms(t) > term ? placements[t].edge_samples : 0);
  }
  std::vector<PatchLink> links;
  for (const EdgeLink& link : FindEdgeLinks(model.mesh, edge_samples, PatchChannels::kCorners)) {
    const Channels channels = CornerWeights(model, scales, term, link.triangle);
    links.push_back(InPages(link, placements, (channels[0] + channels[1] + channels[2]) / 3));
  }
  const BlockFormat format =
      options.blocks == PageBlocks::kBc4 ? BlockFormat::kBc4 : BlockFormat::kBc1;
  return EncodeLinkedPages(model.surface_pages[term], format, SurfaceWeights(model, scales, term),
                           links, options.edge_weight, options.block_quality);
}

std::vector<Image> DecodePages(const std::vector<BlockPage>& blocks) {
  std::vector<Image> pages;
  for (const BlockPage& page : blocks) pages.push_back(DecodePage(page));
  return pages;
}

}  // namespace

LightFieldModel CodePatchPages(LightFieldModel model, const MapScales& scales,
                               const MapCompressionOptions& options) {
  model.blocks.mean = CodeMeanPages(model, options);
  model.mean_pages = DecodePages(model.blocks.mean);
  model.blocks.surface.clear();
  for (int k = 0; k < model.terms; ++k) {
    model.blocks.surface.push_back(CodeSurfacePages(model, scales, k, options));
    model.surface_pages[k] = DecodePages(model.blocks.surface[k]);
  }
  return model;
}

LightFieldModel CodeViewPages(LightFieldModel model, const MapCompressionOptions& options) {
  model.blocks.view.clear();
  for (int k = 0; k < model.terms; ++k) {
    std::vector<BlockPage>& pages = model.blocks.view.emplace_back();
    for (const Image& page : model.view_pages[k]) {
      pages.push_back(EncodePage(page, BlockFormat::kBc1, {}, options.block_quality));
    }
    model.view_pages[k] = DecodePages(model.blocks.view[k]);
  }
  return model;
}

}  // namespace lfm
