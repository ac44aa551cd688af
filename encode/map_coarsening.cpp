// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_coarsening.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "encode/gutters.h"
#include "encode/mean_view.h"
#include "encode/model_layout.h"
#include "encode/patch_resolution.h"
#include "encode/quantization.h"
#include "encode/separate_layout.h"
#include "encode/view_refit.h"
#include "encode/view_resolution.h"

namespace lfm {
namespace {

std::vector<float> AsFloats(std::span<const uint8_t> codes, size_t first, size_t step) {
  std::vector<float> values;
  values.reserve(codes.size() / step);
  for (size_t i = first; i < codes.size(); i += step) values.push_back(codes[i]);
  return values;
}

// Squared changes of each sample of a patch when only samples of a resolution `to` are kept.
std::vector<double> SquaredChanges(std::span<const float> values, int from, int to) {
  const std::vector<float> back = InterpolatePatch(SubsamplePatch(values, from, to), to, from);
  std::vector<double> changes;
  changes.reserve(values.size());
  for (size_t s = 0; s < values.size(); ++s) {
    const double change = static_cast<double>(values[s]) - back[s];
    changes.push_back(change * change);
  }
  return changes;
}

// Over the three vertices whose matrices hold the sample: the sum of squared hat weights.
std::vector<double> HatSquares(int n) {
  std::vector<double> weights;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const double b = static_cast<double>(i) / (n - 1), c = static_cast<double>(j) / (n - 1);
      weights.push_back((1 - b - c) * (1 - b - c) + b * b + c * c);
    }
  }
  return weights;
}

double ViewEnergy(const TermMaps& maps) {
  double sum = 0;
  for (const uint8_t code : maps.view_codes) {
    const double value = DecodeValue(maps.view_range, code);
    sum += value * value;
  }
  return sum;
}

// 3 a texel, half of the rectangle that two triangles share; each placement a term has is counted.
constexpr int64_t kPlacementBytes = 8;
int64_t PatchBytes(int n) { return int64_t{3} * (n + 2) * (n + 1) / 2 + kPlacementBytes; }
int64_t PatchBytesWithGutters(int n) { return int64_t{3} * (n + 4) * (n + 3) / 2; }

void AddMeanLevels(std::span<const uint8_t> codes, int n, int grid, PatchCosts& costs) {
  const std::vector<double> weights = HatSquares(n);
  for (const int to : EdgeSampleLevels(n)) {
    costs.mean_bytes.push_back(PatchBytesWithGutters(to));
    costs.term_bytes.push_back(PatchBytes(to));
    double error = 0;
    for (size_t c = 0; c < 3 && to < n; ++c) {
      const std::vector<double> changes = SquaredChanges(AsFloats(codes, c, 3), n, to);
      for (size_t s = 0; s < changes.size(); ++s) error += weights[s] * changes[s];
    }
    costs.mean_errors.push_back(error * grid * grid / (255.0 * 255.0));
  }
}

// Writes into the places of the vertex' own corner: vertices may run at once.
void AddTermErrors(const LightFieldSource& source, std::span<const int> ring, int vertex,
                   std::span<const int> edge_samples, std::span<const TermMaps> terms,
                   std::vector<PatchCosts>& patches) {
  for (size_t k = 0; k < terms.size(); ++k) {
    const double scale = terms[k].surface_range.scale / 255;
    const double energy = scale * scale * ViewEnergy(terms[k]);
    size_t first = 0;
    for (const int triangle : ring) {
      const int n = edge_samples[triangle];
      const std::vector<float> values =
          AsFloats(std::span(terms[k].surface_codes).subspan(first, PatchSampleCount(n)), 0, 1);
      first += values.size();
      PatchCosts& patch = patches[triangle];
      const int corner = CornerOf(source.mesh.triangles[triangle], vertex);
      float* errors = patch.term_errors.data() + (3 * k + corner) * patch.levels();
      for (const int to : EdgeSampleLevels(n)) {
        if (to == n) continue;
        double error = 0;
        for (const double change : SquaredChanges(values, n, to)) error += change;
        *++errors = static_cast<float>(error * energy);
      }
    }
  }
}

// To a coarser grid and back.
struct GridChange {
  ViewResampler to, back;
};

// Of each term at each grid, the finest (no change) first.
std::vector<float> ViewErrors(std::span<const TermMaps> terms,
                              std::span<const GridChange> coarser) {
  std::vector<float> errors;
  for (const TermMaps& maps : terms) {
    double energy = 0;
    for (const uint8_t code : maps.surface_codes) {
      const double value = DecodeValue(maps.surface_range, code);
      energy += value * value;
    }
    const double scale = maps.view_range.scale / 255;
    const std::vector<float> values = AsFloats(maps.view_codes, 0, 1);
    errors.push_back(0);
    for (const GridChange& change_of_grid : coarser) {
      const std::vector<float> back = change_of_grid.back(change_of_grid.to(values));
      double error = 0;
      for (size_t i = 0; i < values.size(); ++i) {
        const double change = static_cast<double>(values[i]) - back[i];
        error += change * change;
      }
      errors.push_back(static_cast<float>(error * scale * scale * energy));
    }
  }
  return errors;
}

int AtLevel(int n, int level) { return EdgeSampleLevels(n)[static_cast<size_t>(level)]; }

// Whether no completion beyond a hypotenuse leaves the range's codes.
bool HoldsExtent(const MapRange& range, const Extent& extent) {
  constexpr float kRounding = 0.01f;  // in codes, which are whole numbers
  if (!(range.scale > 0)) return true;
  const float low = 255 * (extent.low - range.bias) / range.scale;
  const float high = 255 * (extent.high - range.bias) / range.scale;
  return low > -kRounding && high < 255 + kRounding;
}

// The surface map of a vertex over its ring in the resolutions of `to`; with a range of its own
// where coarser completions leave that of the finer map.
void CoarsenSurface(const LightFieldModel& model, std::span<const int> ring,
                    std::span<const int> to, TermMaps& maps) {
  std::vector<Eigen::Vector3i> triangles;
  std::vector<std::vector<uint8_t>> patches;
  size_t first = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    triangles.push_back(model.mesh.triangles[ring[i]]);
    const int n = model.placements[ring[i]].edge_samples;
    const auto own = std::span(maps.surface_codes).subspan(first, PatchSampleCount(n));
    first += own.size();
    patches.push_back(SubsamplePatch(std::span<const uint8_t>(own), n, to[i]));
  }
  std::vector<uint8_t*> pointers;
  for (auto& patch : patches) pointers.push_back(patch.data());
  const SharedSamples shared = FindSharedSamples(triangles, to);
  MakeCodesContinuous(shared, 1, pointers);
  maps.surface_codes.clear();
  std::vector<float> values;
  for (const auto& patch : patches) {
    maps.surface_codes.insert(maps.surface_codes.end(), patch.begin(), patch.end());
    for (const uint8_t code : patch) values.push_back(DecodeValue(maps.surface_range, code));
  }
  const Extent extent = SurfaceExtent(to, values);
  if (!HoldsExtent(maps.surface_range, extent)) {
    QuantizeSurface(to, shared, values, extent, 1, maps);
  }
}

// Codes of the same range, clamped to it.
void ChangeViewGrid(int from, int to, TermMaps& maps) {
  const std::vector<float> values = ResamplerBetween(from, to)(AsFloats(maps.view_codes, 0, 1));
  maps.view_codes.clear();
  for (const float value : values) {
    maps.view_codes.push_back(static_cast<uint8_t>(std::clamp(value + 0.5f, 0.f, 255.f)));
  }
}

void WriteCoarserMeans(const LightFieldModel& from, LightFieldModel& to) {
  std::vector<std::vector<float>> means;
  std::vector<int> edge_samples;
  for (size_t t = 0; t < to.placements.size(); ++t) {
    const int n = from.placements[t].edge_samples;
    edge_samples.push_back(to.placements[t].edge_samples);
    const std::vector<uint8_t> codes = ReadMean(from, static_cast<int>(t));
    std::vector<float>& own = means.emplace_back(size_t{3} * PatchSampleCount(edge_samples[t]));
    for (size_t c = 0; c < 3; ++c) {
      const std::vector<float> channel = AsFloats(codes, c, 3);
      const std::vector<float> kept =
          SubsamplePatch(std::span<const float>(channel), n, edge_samples[t]);
      for (size_t s = 0; s < kept.size(); ++s) own[3 * s + c] = kept[s] / 255;
    }
  }
  const std::vector<uint8_t> measured(means.size(), 1);
  const auto codes = ContinuousMeanCodes(FindSharedSamples(to.mesh.triangles, edge_samples),
                                         edge_samples, measured, std::move(means));
  for (size_t t = 0; t < codes.size(); ++t) WriteMean(codes[t], static_cast<int>(t), to);
}

void WriteCoarserTerms(const LightFieldModel& from, LightFieldModel& to) {
  const VertexRings rings = ComputeVertexRings(from.mesh);
  ParallelFor(0, static_cast<int64_t>(from.vertex_terms.size()), [&](int64_t v) {
    const auto vertex = static_cast<int>(v);
    const std::span<const int> ring = rings.Ring(v);
    std::vector<TermMaps> terms;
    for (int k = 0; k < from.vertex_terms[v]; ++k) {
      std::vector<int> edge_samples;
      for (const int t : ring) edge_samples.push_back(to.SurfacePlacement(k, t).edge_samples);
      CoarsenSurface(from, ring, edge_samples,
                     terms.emplace_back(ReadVertexTerm(from, ring, vertex, k)));
    }
    for (int k = 0; k < from.vertex_terms[v]; ++k) {
      ChangeViewGrid(from.grid, to.ViewTile(k, vertex).grid, terms[k]);
    }
    WriteVertexTerms(ring, terms, vertex, to);
  });
}

}  // namespace

MapCosts MeasureMapCosts(const LightFieldSource& source, std::span<const int> edge_samples,
                         std::span<const std::vector<uint8_t>> mean_codes,
                         std::span<const VertexTerms> vertices, const MapDetails& details) {
  MapCosts costs{source.mesh, {}, {}, {}, {}, {}};
  for (const VertexTerms& vertex : vertices) {
    costs.squared_errors.push_back(vertex.squared_errors);
    costs.entries.push_back(vertex.entries);
  }
  const auto triangles = static_cast<int64_t>(edge_samples.size());
  const bool coarser = details.patches == MapDetail::kAsNeeded;
  const std::vector<int> grids = details.views == MapDetail::kAsNeeded
                                     ? ViewGridLevels(source.grid)
                                     : std::vector<int>{source.grid};
  for (const int grid : grids) costs.view_bytes.push_back(int64_t{3} * grid * grid);
  // Ranges of both maps, and two indices of 16 bits.
  costs.rank_bytes = static_cast<int64_t>(vertices.size() * 2 * sizeof(MapRange)) +
                     2 * (triangles + static_cast<int64_t>(vertices.size()));
  costs.patches.resize(triangles);
  ParallelFor(
      0, triangles,
      [&](int64_t t) {
        PatchCosts& patch = costs.patches[t];
        const int64_t bytes = PatchBytesWithGutters(edge_samples[t]);
        if (!coarser) {
          patch = {{PatchBytes(edge_samples[t])}, {bytes}, {0}, {}};
          return;
        }
        AddMeanLevels(mean_codes[t], edge_samples[t], source.grid, patch);
        size_t terms = 0;
        for (const int v : source.mesh.triangles[t]) {
          terms = std::max(terms, vertices[v].terms.size());
        }
        patch.term_errors.assign(3 * terms * patch.levels(), 0.f);
      },
      16);
  const VertexRings rings = ComputeVertexRings(source.mesh);
  costs.view_errors.resize(vertices.size());
  std::vector<GridChange> coarser_grids;
  for (size_t g = 1; g < grids.size(); ++g) {
    coarser_grids.push_back({{source.grid, grids[g]}, {grids[g], source.grid}});
  }
  ParallelFor(
      0, static_cast<int64_t>(vertices.size()),
      [&](int64_t v) {
        costs.view_errors[v] = ViewErrors(vertices[v].terms, coarser_grids);
        if (!coarser) return;
        AddTermErrors(source, rings.Ring(v), static_cast<int>(v), edge_samples, vertices[v].terms,
                      costs.patches);
      },
      16);
  return costs;
}

LightFieldModel LayOutCoarsened(const LightFieldModel& model, const MapSelection& maps,
                                int max_texture_size) {
  return LayOutSeparately(model,
                          {[&](int t, int layer) {
                             return AtLevel(model.placements[t].edge_samples,
                                            maps.levels[t][layer]);
                           },
                           [&](int vertex, int term) { return maps.view_levels[vertex][term]; }},
                          max_texture_size);
}

LightFieldModel CoarsenMaps(const LightFieldSource& source, const LightFieldModel& model,
                            const MapSelection& maps, double guessed_weight, int max_texture_size) {
  LightFieldModel coarse = LayOutCoarsened(model, maps, max_texture_size);
  WriteCoarserMeans(model, coarse);
  WriteCoarserTerms(model, coarse);
  coarse = FillGutters(std::move(coarse));
  const std::vector<FittedViews> views = RefitViews(source, coarse, guessed_weight);
  WriteViews(views, coarse);
  coarse = FitViewRanges(std::move(coarse), views);
  ValidateModel(coarse, "the coarsened model");
  return coarse;
}

}  // namespace lfm
