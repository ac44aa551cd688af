// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "encode/separate_layout.h"
#include "encode/transport_form.h"
#include "encode/transport_geometry.h"
#include "encode/transport_maps.h"
#include "encode/transport_stream.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

using transport::Append;
using transport::Ring;

int QuantizeCoefficient(float value, float step) {
  constexpr auto kMost = static_cast<float>(transport::kMostMagnitude);
  return static_cast<int>(std::lround(std::clamp(value / step, -kMost, kMost)));
}

void QuantizeInto(const Eigen::MatrixXf& coefficients, float step, int channel,
                  CoefficientBlock& block) {
  for (int row = 0; row < block.side; ++row) {
    for (int column = 0; column < block.side; ++column) {
      block.At(channel, row, column) = QuantizeCoefficient(coefficients(row, column), step);
    }
  }
}

// How many coefficients have which magnitude, in eighths of an octave: counts do not depend on the
// order in which threads add them.
class Magnitudes {
 public:
  void Add(float value) {
    const double magnitude = std::abs(static_cast<double>(value));
    if (!(magnitude > 0)) return;
    const int bin = static_cast<int>(std::lround(kBinsAnOctave * std::log2(magnitude))) + kZero;
    ++counts_[std::clamp(bin, 0, kBins - 1)];
  }
  void Add(const Magnitudes& other) {
    for (int bin = 0; bin < kBins; ++bin) counts_[bin] += other.counts_[bin];
  }
  // Squared error when quantised with this step.
  double Error(double step) const {
    double error = 0;
    for (int bin = 0; bin < kBins; ++bin) {
      const double magnitude = std::exp2((bin - kZero) / kBinsAnOctave);
      error += static_cast<double>(counts_[bin]) *
               (magnitude < step / 2 ? magnitude * magnitude : step * step / 12);
    }
    return error;
  }

 private:
  static constexpr double kBinsAnOctave = 8;
  static constexpr int kBins = 1024, kZero = 768;
  std::array<int64_t, kBins> counts_{};
};

double StepForError(const Magnitudes& magnitudes, double error) {
  double low = -100, high = 60;  // log2
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (magnitudes.Error(std::exp2(middle)) <= error ? low : high) = middle;
  }
  return std::exp2(low);
}

struct EncodedPart {
  transport::PartHeader header;
  std::string bytes;
  double worth = 0;  // squared norm that it holds, a byte
};

EncodedPart MakePart(transport::Part part, std::string bytes) {
  EncodedPart encoded;
  encoded.header.part = static_cast<uint32_t>(part);
  encoded.header.bytes = bytes.size();
  encoded.header.checksum = Checksum(bytes.data(), bytes.size());
  encoded.bytes = std::move(bytes);
  return encoded;
}

// Filled up to what its texels need (kTexelsAByte).
std::string PartBytes(float step, const std::string& coded, int64_t texels) {
  std::string bytes;
  Append(bytes, step);
  bytes += coded;
  const auto least = static_cast<size_t>(texels / transport::kTexelsAByte);
  if (bytes.size() < least) bytes.resize(least, '\0');
  return bytes;
}

EncodedPart EncodeMean(const LightFieldModel& model, const std::vector<int>& edge_samples,
                       const MapTransform& transform, double psnr_db) {
  // Rounding to multiples of a step errs by its twelfth, squared.
  const auto step = static_cast<float>(std::sqrt(12 * std::pow(10.0, -psnr_db / 10)));
  const std::vector<Eigen::Vector3i> neighbors = ComputeTriangleNeighbors(model.mesh);
  std::vector<Eigen::Vector3f> colors(edge_samples.size());
  RangeEncoder coder;
  std::array<CoefficientModels, transport::kSizeClasses> models;
  for (int t = 0; t < static_cast<int>(edge_samples.size()); ++t) {
    const int n = edge_samples[t];
    const Eigen::Vector3f predicted = transport::PredictMean(neighbors[t], t, colors);
    const auto coefficients = transport::CoefficientsOfMean(model, transform, t, predicted);
    CoefficientBlock block = MakeBlock(n, 3, true);
    for (int c = 0; c < 3; ++c) QuantizeInto(coefficients[c], step, c, block);
    colors[t] = predicted + transport::MeanOffset(block, step);
    models[transport::SizeClass(n)].Encode(coder, block);
  }
  int64_t texels = 0;
  for (const int n : edge_samples) texels += 3 * PatchSampleCount(n);
  return MakePart(transport::Part::kMean, PartBytes(step, coder.Finish(), texels));
}

std::vector<Ring> MakeRings(const TriangleMesh& mesh, const std::vector<int>& edge_samples) {
  const VertexRings rings = ComputeVertexRings(mesh);
  std::vector<Ring> result(mesh.vertices.size());
  ParallelFor(0, static_cast<int64_t>(result.size()), [&](int64_t v) {
    result[v] = transport::MakeRing(mesh, rings, edge_samples, static_cast<int>(v));
  });
  return result;
}

class TermWriter {
 public:
  TermWriter(const LightFieldModel& model, const MapTransform& transform, std::vector<Ring> rings)
      : model_(model), transform_(transform), rings_(std::move(rings)) {}

  double StepFor(double psnr_db) const {
    const auto vertices = static_cast<int64_t>(rings_.size());
    const int64_t chunks = (vertices + transport::kChunk - 1) / transport::kChunk;
    std::vector<Magnitudes> magnitudes(chunks);
    ParallelFor(0, chunks, [&](int64_t chunk) {
      const int64_t end = std::min((chunk + 1) * transport::kChunk, vertices);
      for (int64_t v = chunk * transport::kChunk; v < end; ++v) {
        CountVertex(static_cast<int>(v), magnitudes[chunk]);
      }
    });
    Magnitudes all;
    double entries = 0;
    for (const Magnitudes& part : magnitudes) all.Add(part);
    for (const Ring& ring : rings_) entries += 3.0 * model_.grid * model_.grid * ring.samples;
    return StepForError(all, entries * std::pow(10.0, -psnr_db / 10));
  }

  // The parts of one chunk of vertices, a term each.
  std::vector<EncodedPart> Chunk(int first, float step) const {
    const int end = std::min(first + transport::kChunk, static_cast<int>(rings_.size()));
    std::vector<uint8_t> has(end - first, 1);
    std::vector<EncodedPart> parts;
    for (int k = 0; k < model_.terms; ++k) {
      EncodedPart part = EncodePart(first, end, k, step, has);
      if (std::count(has.begin(), has.end(), 1) == 0) break;
      part.header.term = static_cast<uint32_t>(k);
      part.header.first_vertex = static_cast<uint32_t>(first);
      part.header.count = static_cast<uint32_t>(end - first);
      // A term never comes before the one that it adds to.
      if (!parts.empty()) part.worth = std::min(part.worth, parts.back().worth);
      parts.push_back(std::move(part));
    }
    return parts;
  }

 private:
  std::optional<transport::TermCoefficients> Term(int vertex, int k) const {
    if (k >= model_.vertex_terms[vertex]) return std::nullopt;
    return transport::CoefficientsOfTerm(model_, transform_, rings_[vertex], vertex, k);
  }

  void CountVertex(int vertex, Magnitudes& magnitudes) const {
    for (int k = 0; k < model_.vertex_terms[vertex]; ++k) {
      const auto term = Term(vertex, k);
      if (!term) continue;
      for (const Eigen::MatrixXf& patch : term->surface) {
        for (int column = 0; column < patch.cols(); ++column) {
          for (int row = column; row < patch.rows(); ++row) magnitudes.Add(patch(row, column));
        }
      }
      for (const Eigen::MatrixXf& view : term->view) {
        for (const float value : view.reshaped()) magnitudes.Add(value);
      }
    }
  }

  static bool AnyNonzero(const CoefficientBlock& block) {
    return std::any_of(block.values.begin(), block.values.end(), [](int v) { return v != 0; });
  }

  // Vertices that do not have the term, or lose it to quantisation, lose it in `has`.
  EncodedPart EncodePart(int first, int end, int k, float step, std::vector<uint8_t>& has) const {
    RangeEncoder coder;
    transport::TermModels models;
    double energy = 0;
    int64_t texels = 0;
    int sigma = 0;
    bool before = true;
    for (int v = first; v < end; ++v) {
      if (!has[v - first]) continue;
      std::vector<CoefficientBlock> surface;
      CoefficientBlock view = MakeBlock(model_.grid, 3, false);
      const auto term = Term(v, k);
      bool own = term.has_value();
      if (own) {
        bool any = false;
        for (const Eigen::MatrixXf& patch : term->surface) {
          surface.push_back(MakeBlock(static_cast<int>(patch.rows()), 1, true));
          QuantizeInto(patch, step, 0, surface.back());
          any = any || AnyNonzero(surface.back());
        }
        for (int c = 0; c < 3; ++c) QuantizeInto(term->view[c], step, c, view);
        own = any && AnyNonzero(view);
      }
      coder.Encode(models.has[before], own);
      before = own;
      has[v - first] = own;
      if (!own) continue;
      models.sigma.Encode(coder, transport::Zigzag(term->sigma - sigma));
      sigma = term->sigma;
      energy += transport::SigmaOf(sigma) * transport::SigmaOf(sigma);
      texels += rings_[v].samples + 3 * int64_t{model_.grid} * model_.grid;
      for (const CoefficientBlock& block : surface) {
        models.surface[transport::SizeClass(block.side)].Encode(coder, block);
      }
      models.view.Encode(coder, view);
    }
    EncodedPart part = MakePart(transport::Part::kTerm, PartBytes(step, coder.Finish(), texels));
    part.worth = energy / static_cast<double>(part.header.bytes);
    return part;
  }

  const LightFieldModel& model_;
  const MapTransform& transform_;
  std::vector<Ring> rings_;
};

}  // namespace

bool FitsTransportForm(const LightFieldModel& model) {
  transport::Work work(model.terms, static_cast<int64_t>(model.mesh.vertices.size()), model.grid);
  for (const PatchPlacement& place : model.placements) work.AddPatch(place.edge_samples);
  double largest = 0;
  for (const Eigen::Vector3d& p : model.mesh.vertices) {
    largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  return model.mesh.vertices.size() >= 3 &&
         model.mesh.vertices.size() <= transport::kMostVertices &&
         model.mesh.triangles.size() <= transport::kMostTriangles && model.terms <= 16 &&
         model.grid <= 256 && work.IsBounded() && largest < transport::kMostCoordinate;
}

EncodedTransport EncodeTransport(const LightFieldModel& given, const TransportOptions& options) {
  if (!(options.psnr_db >= 20 && options.psnr_db <= 90)) {
    throw Error("--transport-db must lie in [20, 90]");
  }
  if (!(options.geometry_error >= 0.001 && options.geometry_error <= 10)) {
    throw Error("--geometry-error must lie in [0.001, 10]");
  }
  ValidateModel(given, "the model");
  if (!HasWholeMaps(given)) {
    throw Error(
        "the transport form is made of whole maps: of the model without codebooks, and with "
        "--patch-detail full and --view-detail full");
  }
  if (!FitsTransportForm(given)) {
    throw Error("the model is too large for the transport form; --transport-db 0 leaves it out");
  }
  transport::EncodedGeometry geometry = transport::EncodeGeometry(given, options.geometry_error);
  const LightFieldModel model = ReorderModel(given, geometry.order);
  std::vector<int> edge_samples;
  for (const PatchPlacement& place : model.placements) edge_samples.push_back(place.edge_samples);
  const MapTransform transform = transport::MakeTransform(edge_samples, model.grid);
  EncodedPart mean = EncodeMean(model, edge_samples, transform, options.psnr_db);

  const TermWriter writer(model, transform, MakeRings(model.mesh, edge_samples));
  const auto step =
      static_cast<float>(std::min<double>(writer.StepFor(options.psnr_db), transport::kMostStep));
  const auto vertices = static_cast<int64_t>(model.mesh.vertices.size());
  const int64_t chunks = (vertices + transport::kChunk - 1) / transport::kChunk;
  std::vector<std::vector<EncodedPart>> by_chunk(chunks);
  ParallelFor(0, chunks, [&](int64_t chunk) {
    by_chunk[chunk] = writer.Chunk(static_cast<int>(chunk * transport::kChunk), step);
  });
  std::vector<EncodedPart> parts;
  for (auto& chunk : by_chunk) {
    std::move(chunk.begin(), chunk.end(), std::back_inserter(parts));
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const EncodedPart& a, const EncodedPart& b) { return a.worth > b.worth; });
  parts.insert(parts.begin(),
               {MakePart(transport::Part::kGeometry, std::move(geometry.bytes)), std::move(mean)});

  EncodedTransport encoded;
  encoded.geometry_bytes = static_cast<int64_t>(parts[0].bytes.size());
  encoded.mean_bytes = static_cast<int64_t>(parts[1].bytes.size());
  encoded.order = std::move(geometry.order);
  transport::FileHeader header;
  header.parts = static_cast<uint32_t>(parts.size());
  Append(encoded.bytes, header);
  for (const EncodedPart& part : parts) {
    Append(encoded.bytes, part.header);
    encoded.bytes += part.bytes;
  }
  return encoded;
}

}  // namespace lfm
