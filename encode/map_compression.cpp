// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_compression.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/error.h"
#include "encode/map_groups.h"
#include "encode/page_blocks.h"
#include "encode/patch_codebook.h"
#include "encode/separate_layout.h"
#include "encode/view_refit.h"

namespace lfm {
namespace {

// All groups of a model: mean views, then surface maps term by term, then view maps.
struct Groups {
  std::vector<MapGroup> all;
  size_t mean = 0;
  std::vector<size_t> surface;  // a term each
  std::span<const MapGroup> Mean() const { return std::span(all).subspan(0, mean); }
};

Groups CollectGroups(const LightFieldModel& model, const MapScales& scales,
                     std::span<const FittedViews> views) {
  Groups groups{MeanGroups(model), 0, {}};
  groups.mean = groups.all.size();
  for (int k = 0; k < model.terms; ++k) {
    std::vector<MapGroup> term = SurfaceGroups(model, scales, k);
    groups.surface.push_back(term.size());
    std::move(term.begin(), term.end(), std::back_inserter(groups.all));
  }
  for (int k = 0; k < model.terms; ++k) groups.all.push_back(ViewGroup(model, views, k));
  return groups;
}

std::vector<GroupChoice> ChooseForms(const LightFieldModel& model, const Groups& groups,
                                     const MapCompressionOptions& options, Progress& progress) {
  if (options.vq_db > 0) {
    double entries = 0;
    for (const PatchPlacement& placement : model.placements) {
      entries += 3.0 * PatchSampleCount(placement.edge_samples) * model.grid * model.grid;
    }
    return ChooseForDistortion(groups.all, entries * std::pow(10.0, -options.vq_db / 10)).choices;
  }
  constexpr int64_t kIndexBytes = 2;
  int64_t all = 0, indices = 0;
  for (const MapGroup& group : groups.all) {
    const auto owners = static_cast<int64_t>(group.owners.size());
    all += owners * group.code_bytes;
    indices += owners * kIndexBytes;
  }
  const double budget = static_cast<double>(all) / options.vq_ratio - static_cast<double>(indices);
  GroupAllocation chosen =
      ChooseForBytes(groups.all, std::max<int64_t>(0, static_cast<int64_t>(budget)));
  if (static_cast<double>(chosen.bytes) > budget) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "--vq-ratio %g is not reached: indices and one code a group of maps take a "
                  "%.1fth of all maps",
                  options.vq_ratio,
                  static_cast<double>(all) / static_cast<double>(chosen.bytes + indices));
    progress.Note(text);
  }
  return std::move(chosen.choices);
}

// Groups at the resolutions chosen, and their numbers of codes.
std::vector<int> TakeForms(std::span<const GroupChoice> choices, Groups& groups) {
  std::vector<int> codes;
  for (size_t g = 0; g < choices.size(); ++g) {
    for (int i = 0; i < choices[g].halvings; ++i) groups.all[g] = *HalfResolution(groups.all[g]);
    codes.push_back(choices[g].codes);
  }
  return codes;
}

LightFieldModel SharePatches(const LightFieldModel& model, const MapScales& scales,
                             const Groups& groups, std::span<const int> codes,
                             const CodebookLayout& layout) {
  LightFieldModel shared = ShareMeanViews(model, groups.Mean(), codes, layout);
  size_t first = groups.mean;
  for (int k = 0; k < model.terms; ++k) {
    const auto term = std::span(groups.all).subspan(first, groups.surface[k]);
    shared = ShareSurfaceMaps(std::move(shared), term, codes.subspan(first), k, scales, layout);
    first += groups.surface[k];
  }
  return shared;
}

// Blocks that hold texels of several rectangles save a tenth of the bytes and lose quality: most in
// the mean view, and in BC1, whose four colours are those of all of them.
SeparateSpacing SpacingForBlocks(PageBlocks blocks) {
  return {PatchSpacing::kCompletions, PatchSpacing::kNone, PatchAlignment::kRectangles,
          blocks == PageBlocks::kBc4 ? PatchAlignment::kPages : PatchAlignment::kShelves};
}

}  // namespace

void CheckMapCompression(const MapCompressionOptions& options, int grid) {
  if (options.vq_ratio > 1 && options.vq_db > 0) {
    throw Error("give one of --vq-ratio and --vq-db");
  }
  if (options.blocks != PageBlocks::kNone && grid % 4 != 0) {
    throw Error("--blocks needs view maps of whole blocks, and a grid of " + std::to_string(grid) +
                " is no multiple of 4; run lfm-resample with --view-grid " +
                std::to_string((grid + 3) / 4 * 4));
  }
}

LightFieldModel CompressMaps(const LightFieldSource& source, const LightFieldModel& model,
                             const MapCompressionOptions& options,
                             const MapCompressionLimits& limits, Progress& progress) {
  CheckMapCompression(options, model.grid);
  const bool in_blocks = options.blocks != PageBlocks::kNone;
  const CodebookLayout layout{options.vq_start,
                              PatchSpacing::kCompletions,
                              in_blocks ? PatchSpacing::kNone : PatchSpacing::kCompletions,
                              in_blocks ? PatchAlignment::kRectangles : PatchAlignment::kTexels,
                              limits.max_texture_size,
                              options.edge_weight};
  const MapScales scales = MeasureMapScales(model);
  LightFieldModel result = model;
  std::vector<int> view_codes;
  if (options.WantsCodebooks()) {
    progress.Start("grouping maps", 3);
    Groups groups = CollectGroups(model, scales, RefitViews(source, model, limits.guessed_weight));
    const std::vector<int> codes = TakeForms(ChooseForms(model, groups, options, progress), groups);
    view_codes.assign(codes.end() - model.terms, codes.end());
    progress.Advance();
    result = SharePatches(model, scales, groups, codes, layout);
    progress.Advance();
  } else if (in_blocks) {
    result = SeparateSurfaceMaps(model, limits.max_texture_size, SpacingForBlocks(options.blocks));
  }
  if (in_blocks) result = CodePatchPages(std::move(result), scales, options);
  const std::vector<FittedViews> views = RefitViews(source, result, limits.guessed_weight);
  if (options.WantsCodebooks()) {
    result = ShareViewMaps(std::move(result), views, view_codes, layout);
    progress.Advance();
  } else {
    WriteViews(views, result);
  }
  if (in_blocks) result = CodeViewPages(std::move(result), options);
  result = FitViewRanges(std::move(result), views);
  ValidateModel(result, "the compressed model");
  return result;
}

}  // namespace lfm
