// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/afx.h"
#include "encode/afx_layout.h"
#include "encode/afx_ranges.h"
#include "encode/disc_views.h"
#include "encode/gutters.h"
#include "encode/model_layout.h"
#include "encode/separate_layout.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

// One vertex's term in numbers.
struct TermValues {
  std::vector<float> surface;  // as TermMaps::surface_codes
  std::vector<float> view;     // channels outer
};

// What the maps of a model are read by.
class MapReader {
 public:
  MapReader(const LightFieldModel& model, bool onto_disc)
      : model_(model), rings_(ComputeVertexRings(model.mesh)) {
    if (onto_disc) disc_.emplace(model.grid, model.direction_map);
  }

  std::span<const int> Ring(int vertex) const {
    return std::span(rings_.triangles)
        .subspan(rings_.offsets[vertex], rings_.offsets[vertex + 1] - rings_.offsets[vertex]);
  }
  std::vector<int> EdgeSamples(int vertex) const {
    std::vector<int> edge_samples;
    for (const int t : Ring(vertex)) edge_samples.push_back(model_.placements[t].edge_samples);
    return edge_samples;
  }
  SharedSamples Shared(int vertex) const {
    std::vector<Eigen::Vector3i> triangles;
    for (const int t : Ring(vertex)) triangles.push_back(model_.mesh.triangles[t]);
    return FindSharedSamples(triangles, EdgeSamples(vertex));
  }
  TermMaps Codes(int vertex, int term) const {
    return ReadVertexTerm(model_, Ring(vertex), vertex, term);
  }
  TermValues Values(int vertex, int term) const {
    const TermMaps maps = Codes(vertex, term);
    TermValues values;
    for (const uint8_t code : maps.surface_codes) {
      values.surface.push_back(DecodeValue(maps.surface_range, code));
    }
    const size_t directions = maps.view_codes.size() / 3;
    values.view.resize(maps.view_codes.size());
    for (size_t i = 0; i < maps.view_codes.size(); ++i) {
      values.view[i % 3 * directions + i / 3] = DecodeValue(maps.view_range, maps.view_codes[i]);
    }
    if (disc_) values.view = disc_->FromSquare(values.view);
    return values;
  }

 private:
  const LightFieldModel& model_;
  VertexRings rings_;
  std::optional<DiscViews> disc_;
};

double SquaredNorm(const std::vector<float>& values) {
  return std::transform_reduce(values.begin(), values.end(), 0.0, std::plus<>(),
                               [](float v) { return static_cast<double>(v) * v; });
}

TermExtents Extents(const MapReader& reader, int vertex, int term) {
  const TermValues values = reader.Values(vertex, term);
  TermExtents extents;
  extents.surface = SurfaceExtent(reader.EdgeSamples(vertex), values.surface);
  for (const float value : values.view) extents.view.Include(value);
  extents.surface_norm2 = SquaredNorm(values.surface);
  extents.view_norm2 = SquaredNorm(values.view);
  extents.surface_samples = static_cast<int>(values.surface.size());
  extents.view_samples = static_cast<int>(values.view.size());
  return extents;
}

TermMaps Quantized(const MapReader& reader, int vertex, int term, const MapRange& range,
                   double share) {
  const TermValues values = reader.Values(vertex, term);
  TermMaps maps{range, range, {}, {}};
  for (const float value : values.surface) {
    maps.surface_codes.push_back(QuantizeValue(range, static_cast<float>(value * share)));
  }
  std::vector<uint8_t*> patches;
  uint8_t* patch = maps.surface_codes.data();
  for (const int n : reader.EdgeSamples(vertex)) {
    patches.push_back(patch);
    patch += PatchSampleCount(n);
  }
  MakeCodesContinuous(reader.Shared(vertex), 1, patches);
  const size_t directions = values.view.size() / 3;
  for (size_t i = 0; i < values.view.size(); ++i) {
    const float value = values.view[i % 3 * directions + i / 3];
    maps.view_codes.push_back(QuantizeValue(range, static_cast<float>(value / share)));
  }
  return maps;
}

// Every vertex's maps in ranges that vertices share.
std::vector<std::vector<TermMaps>> SharedRangeMaps(const LightFieldModel& model,
                                                   const MapReader& reader) {
  std::vector<std::vector<TermMaps>> maps(model.vertex_terms.size());
  for (int k = 0; k < model.terms; ++k) {
    std::vector<int> vertices;
    for (size_t v = 0; v < maps.size(); ++v) {
      if (model.vertex_terms[v] > k) vertices.push_back(static_cast<int>(v));
    }
    const auto count = static_cast<int64_t>(vertices.size());
    std::vector<TermExtents> extents(vertices.size());
    ParallelFor(0, count, [&](int64_t i) { extents[i] = Extents(reader, vertices[i], k); });
    const SharedRange shared = ShareRange(extents);
    ParallelFor(0, count, [&](int64_t i) {
      maps[vertices[i]].push_back(
          Quantized(reader, vertices[i], k, shared.range, shared.surface_scales[i]));
    });
  }
  return maps;
}

std::vector<std::vector<TermMaps>> SameMaps(const LightFieldModel& model, const MapReader& reader) {
  std::vector<std::vector<TermMaps>> maps(model.vertex_terms.size());
  for (size_t v = 0; v < maps.size(); ++v) {
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      maps[v].push_back(reader.Codes(static_cast<int>(v), k));
    }
  }
  return maps;
}

// Every coefficient as the float next to it. Through a list of floats: GCC 12 at -O3 leaves the
// last values of a loop that rounds doubles in place as they were.
template <typename Matrix>
void RoundToFloat(std::vector<Matrix>& matrices) {
  std::vector<float> rounded;
  for (const Matrix& matrix : matrices) {
    for (const double value : matrix.reshaped()) rounded.push_back(static_cast<float>(value));
  }
  for (size_t i = 0; i < matrices.size(); ++i) {
    using Floats = Eigen::Matrix<float, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>;
    constexpr int kSize = Matrix::SizeAtCompileTime;
    matrices[i] = Eigen::Map<const Floats>(rounded.data() + i * kSize).template cast<double>();
  }
}

// What a file keeps of coordinates and frames.
void KeepFloats(LightFieldModel& model) {
  RoundToFloat(model.mesh.vertices);
  RoundToFloat(model.vertex_frames);
  model.mesh.normals.clear();
  for (const Eigen::Matrix3d& frame : model.vertex_frames) {
    model.mesh.normals.push_back(frame.col(2));
  }
  model.mesh.confidence.clear();
  model.mesh.colors.clear();
}

}  // namespace

LightFieldModel AfxForm(const LightFieldModel& model, AfxViewMaps view_maps) {
  ValidateModel(model, "the model");
  if (model.mean_in_terms) {
    throw Error(
        "nonnegative terms hold the mean view, which AFX would add twice; take --factorization "
        "pca, or leave --afx out");
  }
  if (!HasWholeMaps(model)) {
    throw Error(
        "AFX is written of whole maps: leave --vq-ratio and --vq-db out and take --patch-detail "
        "full and --view-detail full, or leave --afx out");
  }
  const LightFieldModel ordered =
      InPageOrder(model.surface_placements.empty() ? model : JoinSurfaceMaps(model));
  const bool onto_disc = view_maps == AfxViewMaps::kDisc && model.terms > 0 &&
                         model.direction_map != DirectionMap::kOrthographic;
  const MapReader reader(ordered, onto_disc);
  const auto maps = !onto_disc && HasSharedRanges(ordered) ? SameMaps(ordered, reader)
                                                           : SharedRangeMaps(ordered, reader);
  LightFieldModel form = StableLayout(ordered);
  if (onto_disc) form.direction_map = DirectionMap::kOrthographic;
  for (size_t t = 0; t < form.placements.size(); ++t) {
    WriteMean(ReadMean(ordered, static_cast<int>(t)), static_cast<int>(t), form);
  }
  ParallelFor(0, static_cast<int64_t>(maps.size()), [&](int64_t v) {
    const auto vertex = static_cast<int>(v);
    WriteVertexTerms(reader.Ring(vertex), maps[v], vertex, form);
  });
  KeepFloats(form);
  return FillGutters(std::move(form));
}

}  // namespace lfm
