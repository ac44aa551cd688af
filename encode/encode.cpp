// SPDX-License-Identifier: BSD-3-Clause
#include "encode/encode.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/image_metrics.h"
#include "core/parallel.h"
#include "encode/gutters.h"
#include "encode/mean_view.h"
#include "encode/quantization.h"
#include "encode/tiling.h"
#include "encode/vertex_factorization.h"

namespace lfm {
namespace {

// What is kept of a vertex once its maps lie in the pages.
struct VertexFigures {
  double energy = 0, squared_error = 0;
  int64_t entries = 0;
  std::vector<double> shares;
};

std::vector<int> EdgeSamples(const LightFieldSource& source) {
  std::vector<int> edge_samples;
  for (size_t t = 0; t < source.mesh.triangles.size(); ++t) {
    edge_samples.push_back(source.patch(static_cast<int>(t)).edge_samples);
  }
  return edge_samples;
}

std::vector<Image> MakePages(const std::vector<Eigen::Vector2i>& sizes) {
  std::vector<Image> pages;
  for (const Eigen::Vector2i& size : sizes) {
    pages.emplace_back(size.x(), size.y(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  }
  return pages;
}

LightFieldModel LayOut(const LightFieldSource& source, std::span<const int> edge_samples,
                       const EncodeOptions& options) {
  LightFieldModel model;
  model.mesh = source.mesh;
  model.vertex_frames = source.vertex_frames;
  model.direction_map = source.direction_map;
  model.grid = source.grid;
  model.terms = options.terms;
  const size_t vertices = source.vertex_frames.size();
  PatchLayout patches = PlacePatches(edge_samples, options.max_texture_size);
  const ViewLayout views =
      PlaceViews(static_cast<int>(vertices), source.grid, options.max_texture_size);
  model.placements = std::move(patches.placements);
  model.mean_pages = MakePages(patches.page_sizes);
  model.surface_pages.assign(options.terms, MakePages(patches.page_sizes));
  model.view_pages.assign(options.terms, MakePages(views.page_sizes));
  model.view_tiles_per_row = views.tiles_per_row;
  model.view_tiles_per_page = views.tiles_per_page;
  model.vertex_terms.assign(vertices, 0);
  model.surface_ranges.assign(options.terms * vertices, MapRange{0, 0});
  model.view_ranges.assign(options.terms * vertices, MapRange{0, 0});
  return model;
}

// Writes one channel set of a patch: texel channel `first` on, `count` codes a sample.
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

// Vertices write to their own channels and tiles: no two threads touch one byte.
void WriteTerm(const VertexOperator& f, const TermMaps& maps, int vertex, int term,
               LightFieldModel& model) {
  const size_t range = term * model.vertex_frames.size() + vertex;
  model.surface_ranges[range] = maps.surface_range;
  model.view_ranges[range] = maps.view_range;
  for (const RingBlock& block : f.blocks) {
    const PatchPlacement& placement = model.placements[block.triangle];
    WritePatch(model.surface_pages[term][placement.page], placement,
               maps.surface_codes.data() + block.first_row, block.corner, 1);
  }
  const LightFieldModel::TilePosition tile = model.ViewTile(vertex);
  for (int row = 0; row < model.grid; ++row) {
    std::copy_n(maps.view_codes.data() + size_t{3} * row * model.grid, 3 * model.grid,
                &model.view_pages[term][tile.page].At<uint8_t>(tile.x, tile.y + row));
  }
}

VertexFigures EncodeVertex(const LightFieldSource& source, const MeanView& mean_view,
                           std::span<const int> ring, int vertex, const EncodeOptions& options,
                           LightFieldModel& model) {
  const auto mean = [&](int triangle) {
    const std::vector<uint8_t>& codes = mean_view.codes[triangle];
    PatchMean values(codes.size());
    for (size_t k = 0; k < codes.size(); ++k) values[k] = static_cast<float>(codes[k]) / 255;
    return values;
  };
  const VertexOperator f = BuildVertexOperator(source, vertex, ring, mean);
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> edge_samples;
  for (const RingBlock& block : f.blocks) {
    triangles.push_back(source.mesh.triangles[block.triangle]);
    edge_samples.push_back(block.edge_samples);
  }
  VertexTerms terms = FactorizeVertex(
      f, FindSharedSamples(triangles, edge_samples),
      {.terms = options.terms, .solver = options.solver, .guessed_weight = options.guessed_weight});
  for (size_t k = 0; k < terms.terms.size(); ++k) {
    WriteTerm(f, terms.terms[k], vertex, static_cast<int>(k), model);
  }
  model.vertex_terms[vertex] = static_cast<int>(terms.terms.size());
  return {terms.energy, terms.squared_error, terms.entries, std::move(terms.singular_value_share)};
}

double MatrixPsnr(double squared_error, int64_t entries) {
  return entries == 0 ? 99
                      : PsnrFromMse(255.0 * 255.0 * squared_error / static_cast<double>(entries));
}

// Terms that no vertex has are not part of the model.
void DropEmptyTerms(int terms_max, LightFieldModel& model) {
  model.terms = terms_max;
  model.surface_pages.resize(terms_max);
  model.view_pages.resize(terms_max);
  model.surface_ranges.resize(terms_max * model.vertex_frames.size());
  model.view_ranges.resize(terms_max * model.vertex_frames.size());
}

void Summarize(const std::vector<VertexFigures>& figures, const LightFieldSource& source,
               EncodeResult& result) {
  double energy = 0, error = 0;
  int64_t entries = 0, terms = 0, with_energy = 0;
  for (size_t v = 0; v < figures.size(); ++v) {
    energy += figures[v].energy;
    error += figures[v].squared_error;
    entries += figures[v].entries;
    with_energy += figures[v].energy > 0;
    terms += result.model.vertex_terms[v];
    for (size_t k = 0; k < result.singular_value_share.size(); ++k) {
      result.singular_value_share[k] += figures[v].shares[k];
    }
  }
  for (double& share : result.singular_value_share) {
    share /= static_cast<double>(std::max<int64_t>(1, with_energy));
  }
  result.terms_mean = static_cast<double>(terms) / static_cast<double>(figures.size());
  result.matrix_psnr_db = MatrixPsnr(error, entries);
  result.matrix_psnr_mean_only_db = MatrixPsnr(energy, entries);
  result.maps_bytes = result.model.MapsBytes();
  result.compression_ratio =
      static_cast<double>(source.dense_bytes) / static_cast<double>(result.maps_bytes);
}

void CheckSource(const LightFieldSource& source) {
  ValidateMesh(source.mesh, "light field");
  if (source.vertex_frames.size() != source.mesh.vertices.size()) {
    throw Error("light field: one frame a vertex is needed; run lfm-resample again");
  }
  if (source.grid < 2 || source.grid > 256) {
    throw Error("light field: the view grid must lie in [2, 256]; run lfm-resample again");
  }
}

}  // namespace

EncodeResult Encode(const LightFieldSource& source, const EncodeOptions& options,
                    Progress& progress) {
  EncodeOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  CheckSource(source);
  const std::vector<int> edge_samples = EdgeSamples(source);
  EncodeResult result;
  result.model = LayOut(source, edge_samples, options);
  const MeanView mean_view =
      ComputeMeanView(source, FindSharedSamples(source.mesh.triangles, edge_samples),
                      options.guessed_weight, progress);
  result.unseen_triangles = mean_view.unseen_triangles;
  for (size_t t = 0; t < edge_samples.size(); ++t) {
    const PatchPlacement& placement = result.model.placements[t];
    WritePatch(result.model.mean_pages[placement.page], placement, mean_view.codes[t].data(), 0, 3);
  }
  const VertexRings rings = ComputeVertexRings(source.mesh);
  const auto vertices = static_cast<int64_t>(source.mesh.vertices.size());
  std::vector<VertexFigures> figures(vertices);
  progress.Start("factorising", vertices);
  ParallelFor(0, vertices, [&](int64_t v) {
    const std::span<const int> ring(rings.triangles.data() + rings.offsets[v],
                                    rings.triangles.data() + rings.offsets[v + 1]);
    figures[v] = EncodeVertex(source, mean_view, ring, static_cast<int>(v), options, result.model);
    progress.Advance();
  });
  result.terms_max =
      *std::max_element(result.model.vertex_terms.begin(), result.model.vertex_terms.end());
  result.singular_value_share.assign(options.terms, 0.0);
  DropEmptyTerms(result.terms_max, result.model);
  result.model = FillGutters(std::move(result.model));
  Summarize(figures, source, result);
  result.singular_value_share.resize(result.terms_max);
  return result;
}

EncodeResult Encode(const LightField& light_field, const EncodeOptions& options,
                    Progress& progress) {
  return Encode(SourceFromLightField(light_field), options, progress);
}

}  // namespace lfm
