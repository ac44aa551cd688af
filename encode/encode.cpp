// SPDX-License-Identifier: BSD-3-Clause
#include "encode/encode.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/guessed_directions.h"
#include "encode/gutters.h"
#include "encode/map_budget.h"
#include "encode/map_coarsening.h"
#include "encode/map_selection.h"
#include "encode/mean_view.h"
#include "encode/memory_need.h"
#include "encode/model_error.h"
#include "encode/model_layout.h"
#include "encode/nonnegative_terms.h"
#include "encode/reflection_model.h"
#include "encode/separate_layout.h"
#include "encode/vertex_factorization.h"

namespace lfm {
namespace {

std::vector<int> EdgeSamples(const LightFieldSource& source) {
  std::vector<int> edge_samples;
  for (size_t t = 0; t < source.mesh.triangles.size(); ++t) {
    edge_samples.push_back(source.patch(static_cast<int>(t)).edge_samples);
  }
  return edge_samples;
}

bool HasTarget(const EncodeOptions& options) {
  return options.tolerance > 0 || options.target_db > 0 || options.target_mb > 0;
}

VertexTerms FactorizeRing(const LightFieldSource& source, const MeanView& mean_view,
                          std::span<const int> ring, int vertex, const EncodeOptions& options) {
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
  const SharedSamples shared = FindSharedSamples(triangles, edge_samples);
  const FactorizationOptions wanted = {.terms = MostTerms(options),
                                       .solver = options.solver,
                                       .precision = options.precision,
                                       .guessed_weight = options.guessed_weight};
  if (options.factorization == Factorization::kPca) return FactorizeVertex(f, shared, wanted);
  const double mean_only = ComputeEnergies(f, std::vector<float>(f.directions, 1.f)).plain;
  const VertexOperator whole = BuildVertexOperator(source, vertex, ring, [&](int triangle) {
    return PatchMean(mean_view.codes[triangle].size(), 0.f);
  });
  return FactorizeNonnegative(whole, shared, mean_only, wanted);
}

void CountBytes(const LightFieldSource& source, EncodeResult& result) {
  result.maps_bytes = result.model.MapsBytes();
  result.compression_ratio =
      static_cast<double>(source.dense_bytes) / static_cast<double>(result.maps_bytes);
}

void Summarize(const std::vector<VertexTerms>& vertices, const LightFieldSource& source,
               EncodeResult& result) {
  double energy = 0, error = 0;
  int64_t entries = 0, terms = 0, with_energy = 0;
  result.terms_max = result.model.terms;
  result.singular_value_share.assign(result.terms_max, 0.0);
  result.vertices_by_terms.assign(result.terms_max + 1, 0);
  for (size_t v = 0; v < vertices.size(); ++v) {
    const VertexTerms& vertex = vertices[v];
    const int own = result.model.vertex_terms[v];
    energy += vertex.squared_errors.front();
    error += vertex.squared_errors[own];
    entries += vertex.entries;
    with_energy += vertex.squared_errors.front() > 0;
    terms += own;
    ++result.vertices_by_terms[own];
    for (size_t k = 0; k < result.singular_value_share.size(); ++k) {
      result.singular_value_share[k] += vertex.singular_value_share[k];
    }
  }
  for (int first = 0; first <= result.terms_max; ++first) {
    double of_first = 0;
    for (size_t v = 0; v < vertices.size(); ++v) {
      of_first += vertices[v].squared_errors[std::min(first, result.model.vertex_terms[v])];
    }
    result.matrix_psnr_by_terms_db.push_back(ModelError{of_first, entries}.psnr_db());
  }
  for (double& share : result.singular_value_share) {
    share /= static_cast<double>(std::max<int64_t>(1, with_energy));
  }
  result.terms_mean = static_cast<double>(terms) / static_cast<double>(vertices.size());
  result.matrix_psnr_db = ModelError{error, entries}.psnr_db();
  result.matrix_psnr_mean_only_db = ModelError{energy, entries}.psnr_db();
  CountBytes(source, result);
}

void CheckOptions(const EncodeOptions& options) {
  EncodeOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  if ((options.terms >= 0) + (options.tolerance > 0) + (options.target_db > 0) +
          (options.target_mb > 0) >
      1) {
    throw Error("give one of --terms, --tolerance, --target-db and --target-mb");
  }
  if (options.factorization == Factorization::kNmf && HasTarget(options)) {
    throw Error(
        "nonnegative terms do not add up one by one: with --factorization nmf give --terms alone");
  }
  if (options.factorization == Factorization::kNmf && options.solver == PcaSolver::kDense) {
    throw Error(
        "--solver dense finds singular values: with --factorization nmf take factored or paper");
  }
  if (options.precision == Precision::kDouble &&
      (options.solver != PcaSolver::kFactored || options.factorization == Factorization::kNmf)) {
    throw Error("--precision double is the factored PCA's: leave out --solver and --factorization");
  }
  if (options.transport_db > 0 && options.transport_db < 20) {
    throw Error("--transport-db must be 0 or lie in [20, 90]");
  }
}

// Codes are chosen by what they are estimated to lose; this is what was lost.
void NoteLoss(double before_db, double after_db, const MapCompressionOptions& options,
              Progress& progress) {
  const double lost = std::pow(10.0, -after_db / 10) - std::pow(10.0, -before_db / 10);
  const double lost_db = lost > 0 ? -10 * std::log10(lost) : HUGE_VAL;
  if (lost_db >= options.vq_db) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "codebooks%s lose %.1f dB where --vq-db %g was asked for: %.1f dB of the light "
                "field, %.1f dB before",
                options.blocks == PageBlocks::kNone ? "" : " and blocks", lost_db, options.vq_db,
                after_db, before_db);
  progress.Note(text);
}

// The transport form was made before: it has its own ways.
void Compress(const LightFieldSource& source, const EncodeOptions& options, Progress& progress,
              EncodeResult& result) {
  result.model = CompressMaps(source, result.model, options.compression,
                              {options.guessed_weight, options.max_texture_size}, progress);
  const double before_db =
      std::exchange(result.matrix_psnr_db, CompareWithLightField(source, result.model).psnr_db());
  NoteLoss(before_db, result.matrix_psnr_db, options.compression, progress);
  CountBytes(source, result);
}

void CheckSource(const LightFieldSource& source) {
  ValidateMesh(source.mesh, source.name.c_str());
  if (source.vertex_frames.size() != source.mesh.vertices.size()) {
    source.Fail("one frame a vertex is needed");
  }
  if (source.grid < 2 || source.grid > 256) {
    source.Fail("the view grid must lie in [2, 256]");
  }
}

// Nonnegative terms cannot take a change of either sign.
LightFieldSource FillDirections(const LightFieldSource& source, const EncodeOptions& options,
                                Progress& progress) {
  if (options.fill == DirectionFill::kBlend || source.eyes.empty() ||
      options.factorization == Factorization::kNmf) {
    return source;
  }
  progress.Start("reflections", 1);
  LightFieldSource filled = WithReflections(source, FitReflections(source, options.mirror_lights));
  progress.Advance();
  return filled;
}

// What factorisation gives, before anything is chosen.
struct Factors {
  std::vector<int> edge_samples;
  MeanView mean_view;
  VertexRings rings;
  std::vector<VertexTerms> vertices;
};

Factors Factorize(const LightFieldSource& source, const EncodeOptions& options,
                  Progress& progress) {
  Factors factors{EdgeSamples(source), {}, ComputeVertexRings(source.mesh), {}};
  factors.mean_view =
      ComputeMeanView(source, FindSharedSamples(source.mesh.triangles, factors.edge_samples),
                      options.guessed_weight, progress);
  const auto vertices = static_cast<int64_t>(source.mesh.vertices.size());
  factors.vertices.resize(vertices);
  progress.Start("factorising", vertices);
  ParallelFor(0, vertices, [&](int64_t v) {
    factors.vertices[v] = FactorizeRing(source, factors.mean_view, factors.rings.Ring(v),
                                        static_cast<int>(v), options);
    progress.Advance();
  });
  return factors;
}

// The first terms of every vertex, every sample of them.
LightFieldModel WholeModel(const LightFieldSource& source, const Factors& factors,
                           const std::vector<int>& terms, const EncodeOptions& options) {
  LightFieldModel model =
      LayOutModel(source, factors.edge_samples, terms, options.max_texture_size);
  model.mean_in_terms = options.factorization == Factorization::kNmf;
  for (size_t t = 0; t < factors.edge_samples.size(); ++t) {
    WriteMean(factors.mean_view.codes[t], static_cast<int>(t), model);
  }
  ParallelFor(0, static_cast<int64_t>(terms.size()), [&](int64_t v) {
    WriteVertexTerms(factors.rings.Ring(v), factors.vertices[v].terms, static_cast<int>(v), model);
  });
  return FillGutters(std::move(model));
}

void TakeCoarsened(Coarsened coarsened, const LightFieldSource& source, EncodeResult& result) {
  result.model = std::move(coarsened.model);
  result.matrix_psnr_by_terms_db.clear();
  for (const ModelError& error : coarsened.errors) {
    result.matrix_psnr_by_terms_db.push_back(error.psnr_db());
  }
  result.matrix_psnr_db = result.matrix_psnr_by_terms_db.back();
  result.matrix_psnr_mean_only_db = result.matrix_psnr_by_terms_db.front();
  CountBytes(source, result);
}

}  // namespace

bool ChoosesDetail(const EncodeOptions& options) {
  return (options.patch_detail == MapDetail::kAsNeeded ||
          options.view_detail == MapDetail::kAsNeeded) &&
         options.factorization == Factorization::kPca &&
         options.terms == EncodeOptions::kAsNeeded && !(options.tolerance > 0) &&
         !options.compression.WantsAnything();
}

EncodeResult Encode(const LightFieldSource& blended, const EncodeOptions& options,
                    Progress& progress) {
  CheckOptions(options);
  CheckSource(blended);
  CheckMapCompression(options.compression, blended.grid);
  const std::vector<int> edge_samples = EdgeSamples(blended);
  RequireRoomForMeanView(blended, edge_samples, options);
  RequireMemory(blended, edge_samples, options);
  const LightFieldSource source = FillDirections(blended, options, progress);
  const Factors factors = Factorize(source, options, progress);
  const MapCosts costs =
      MeasureMapCosts(source, factors.edge_samples, factors.mean_view.codes, factors.vertices,
                      ChoosesDetail(options) ? MapDetails{options.patch_detail, options.view_detail}
                                             : MapDetails{MapDetail::kFull, MapDetail::kFull});
  MapSelection maps = ChooseMaps(source, factors.edge_samples, costs, options, progress);
  EncodeResult result;
  result.unseen_triangles = factors.mean_view.unseen_triangles;
  Coarsened coarsened;
  if (ChoosesDetail(options)) {
    coarsened = CoarsenToTarget(
        source, costs, options, maps,
        [&](const std::vector<int>& terms) { return WholeModel(source, factors, terms, options); },
        progress);
    maps = std::move(coarsened.maps);
  }
  result.model = WholeModel(source, factors, maps.terms, options);
  Summarize(factors.vertices, source, result);
  if (options.transport_db > 0 && !FitsTransportForm(result.model)) {
    progress.Note("the model is too large for the transport form: no model.lfz");
  } else if (options.transport_db > 0) {
    result.transport =
        EncodeTransport(result.model, {options.transport_db, options.geometry_error});
  }
  if (options.compression.WantsAnything()) {
    Compress(source, options, progress, result);
    return result;  // beside codebooks the masks would be a large part of the file
  }
  if (ChoosesDetail(options)) {
    TakeCoarsened(std::move(coarsened), source, result);
  } else {
    result.model = SeparateSurfaceMaps(result.model, options.max_texture_size);
    CountBytes(source, result);
  }
  result.model.guessed = FindGuessedDirections(source);
  return result;
}

EncodeResult Encode(const LightField& light_field, const EncodeOptions& options,
                    Progress& progress) {
  return Encode(SourceFromLightField(light_field), options, progress);
}

}  // namespace lfm
