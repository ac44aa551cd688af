// SPDX-License-Identifier: BSD-3-Clause
// Trusts nothing: sizes are bounded before memory is taken, parts carry checksums, and what damaged
// bits decode to stays within the bounds of its type.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "encode/afx.h"
#include "encode/glb.h"
#include "encode/gutters.h"
#include "encode/map_quantization.h"
#include "encode/mean_view.h"
#include "encode/model_layout.h"
#include "encode/transport_form.h"
#include "encode/transport_stream.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

using transport::Ring;

struct Stream {
  std::string_view bytes;
  const std::string& name;

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(name + ": " + problem + "; get the file again, or run lfm-encode again");
  }
  void Require(bool condition, const std::string& problem) const {
    if (!condition) Fail(problem);
  }
  // Takes a value off the front; false where it has ended.
  template <typename T>
  bool Take(T& value) {
    if (bytes.size() < sizeof value) return false;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes.remove_prefix(sizeof value);
    return true;
  }
};

struct Part {
  transport::PartHeader header;
  std::string_view bytes;
};

struct Parts {
  std::string_view geometry, mean;
  std::vector<Part> terms;
  int missing = 0;
};

Parts FindParts(Stream stream) {
  transport::FileHeader header;
  stream.Require(stream.Take(header) && header.magic == transport::kMagic,
                 "not a light field model");
  stream.Require(header.version == transport::kVersion,
                 "version " + std::to_string(header.version) + " is not known");
  Parts parts;
  uint32_t count = 0;
  for (; count < header.parts; ++count) {
    Part part;
    if (!stream.Take(part.header) || stream.bytes.size() < part.header.bytes) break;
    part.bytes = stream.bytes.substr(0, part.header.bytes);
    stream.bytes.remove_prefix(part.header.bytes);
    stream.Require(Checksum(part.bytes.data(), part.bytes.size()) == part.header.checksum,
                   "damaged: a checksum does not fit");
    const auto expected = count == 0   ? transport::Part::kGeometry
                          : count == 1 ? transport::Part::kMean
                                       : transport::Part::kTerm;
    const bool of_all =
        part.header.term == 0 && part.header.first_vertex == 0 && part.header.count == 0;
    stream.Require(part.header.part == static_cast<uint32_t>(expected) && (count >= 2 || of_all),
                   "its parts are not in order");
    if (count == 0) parts.geometry = part.bytes;
    if (count == 1) parts.mean = part.bytes;
    if (count >= 2) parts.terms.push_back(part);
  }
  stream.Require(count >= 2, "it ends before its mean view: cut off too early");
  parts.missing = static_cast<int>(std::min<uint32_t>(header.parts - count, 1U << 30));
  return parts;
}

// The geometry and the layout, as far as a model keeps them.
struct Frame {
  TriangleMesh mesh;
  std::vector<Eigen::Matrix3d> vertex_frames;
  std::vector<int> edge_samples;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 2, terms = 0, max_texture = 256;
  bool mean_in_terms = false;

  LightFieldSource Source() const { return {mesh, vertex_frames, direction_map, grid, {}, {}, 0}; }
};

void CheckHeader(const Stream& stream, const transport::GeometryHeader& header) {
  const bool counts = header.vertices >= 3 && header.vertices <= transport::kMostVertices &&
                      header.triangles >= 1 && header.triangles <= transport::kMostTriangles;
  stream.Require(counts, "it has no triangles, or more than a model may have");
  stream.Require(header.terms <= 16 && header.grid >= 2 && header.grid <= 256 &&
                     header.direction_map <= 1 && header.mean_in_terms <= 1 &&
                     header.max_texture >= 256 && header.max_texture <= 16384,
                 "its terms, view grid or pages are out of range");
  bool finite = std::isfinite(header.step) && header.step > 0 && header.step < 1e9;
  for (const double value : header.origin) finite = finite && std::abs(value) < 1e12;
  stream.Require(finite, "its coordinates are not finite");
}

Frame DecodeGeometry(Stream stream) {
  transport::GeometryHeader header;
  stream.Require(stream.Take(header), "its geometry is too short");
  CheckHeader(stream, header);
  Frame frame;
  frame.grid = static_cast<int>(header.grid);
  frame.terms = static_cast<int>(header.terms);
  frame.max_texture = static_cast<int>(header.max_texture);
  frame.mean_in_terms = header.mean_in_terms != 0;
  frame.direction_map = static_cast<DirectionMap>(header.direction_map);
  RangeDecoder coder(stream.bytes);
  NumberModels index, coordinate, size, turn;
  const auto go_on = [&] { stream.Require(!coder.overrun(), "its geometry is too short"); };
  Eigen::Vector3i before = Eigen::Vector3i::Zero();
  for (uint32_t t = 0; t < header.triangles; ++t) {
    Eigen::Vector3i triangle;
    for (int c = 0; c < 3; ++c) {
      const int64_t predicted = c == 0 ? before[0] : triangle[c - 1];
      const int64_t vertex = predicted + transport::Unzigzag(index.Decode(coder));
      stream.Require(vertex >= 0 && vertex < header.vertices,
                     "a triangle names a vertex that is not there");
      triangle[c] = static_cast<int>(vertex);
    }
    frame.mesh.triangles.push_back(before = triangle);
    go_on();
  }
  const Eigen::Vector3d origin = Eigen::Map<const Eigen::Vector3d>(header.origin.data());
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (uint32_t v = 0; v < header.vertices; ++v) {
    for (int a = 0; a < 3; ++a) {
      last[a] += static_cast<double>(transport::Unzigzag(coordinate.Decode(coder)));
    }
    frame.mesh.vertices.push_back(origin + header.step * last);
    go_on();
  }
  transport::Work work(header.terms, header.vertices, header.grid);
  for (uint32_t t = 0; t < header.triangles; ++t) {
    const int64_t n = int64_t{size.Decode(coder)} + 2;
    stream.Require(n + 4 <= header.max_texture, "a patch is larger than a page");
    work.AddPatch(static_cast<int>(n));
    stream.Require(work.IsBounded(), "its maps hold more texels than a model may have");
    frame.edge_samples.push_back(static_cast<int>(n));
  }
  go_on();
  frame.vertex_frames = ComputeVertexFrames(frame.mesh);
  for (Eigen::Matrix3d& axes : frame.vertex_frames) {
    Eigen::Vector3d turned;
    for (int a = 0; a < 3; ++a) {
      turned[a] =
          transport::kFrameStep * static_cast<double>(transport::Unzigzag(turn.Decode(coder)));
    }
    if (turned.norm() > 0) {
      axes = Eigen::AngleAxisd(turned.norm(), turned.normalized()).toRotationMatrix() * axes;
    }
    frame.mesh.normals.push_back(axes.col(2));
    go_on();
  }
  return frame;
}

float TakeStep(Stream& stream) {
  float step = 0;
  stream.Require(stream.Take(step) && step > 0 && step <= transport::kMostStep,
                 "a step is out of range");
  return step;
}

// The low frequencies that hold anything.
Eigen::MatrixXf Dequantized(const CoefficientBlock& block, int channel, float step) {
  const int used = std::min(block.diagonals[channel], block.side);
  Eigen::MatrixXf coefficients(used, used);
  for (int row = 0; row < used; ++row) {
    for (int column = 0; column < used; ++column) {
      coefficients(row, column) = step * static_cast<float>(block.At(channel, row, column));
    }
  }
  return coefficients;
}

std::vector<std::vector<float>> DecodeMean(Stream stream, const Frame& frame,
                                           const MapTransform& transform) {
  const float step = TakeStep(stream);
  const std::vector<Eigen::Vector3i> neighbors = ComputeTriangleNeighbors(frame.mesh);
  std::vector<Eigen::Vector3f> colors(frame.edge_samples.size());
  std::vector<std::vector<float>> means(frame.edge_samples.size());
  RangeDecoder coder(stream.bytes);
  std::array<CoefficientModels, transport::kSizeClasses> models;
  for (int t = 0; t < static_cast<int>(means.size()); ++t) {
    const int n = frame.edge_samples[t];
    CoefficientBlock block = MakeBlock(n, 3, true);
    models[transport::SizeClass(n)].Decode(coder, block);
    stream.Require(!coder.overrun(), "its mean view is too short");
    Eigen::MatrixXf opponent(PatchSampleCount(n), 3);
    for (int c = 0; c < 3; ++c) {
      transform.FromTriangle(n, Dequantized(block, c, step),
                             std::span(opponent.col(c).data(), opponent.rows()));
    }
    const Eigen::Vector3f predicted = transport::PredictMean(neighbors[t], t, colors);
    colors[t] = predicted + transport::MeanOffset(block, step);
    const Eigen::MatrixXf rgb =
        (opponent * OpponentColors().transpose()).rowwise() + predicted.transpose();
    means[t].resize(static_cast<size_t>(rgb.size()));
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(means[t].data(),
                                                                         rgb.rows(), 3) = rgb;
  }
  return means;
}

// One chunk of vertices, its terms one after the other.
class ChunkReader {
 public:
  ChunkReader(const Frame& frame, const MapTransform& transform, const std::vector<Ring>& rings,
              std::vector<std::vector<TermMaps>>& maps)
      : frame_(frame), transform_(transform), rings_(rings), maps_(maps) {}

  void Read(Stream stream, const transport::PartHeader& header) const {
    const float step = TakeStep(stream);
    RangeDecoder coder(stream.bytes);
    transport::TermModels models;
    int64_t sigma = 0;
    bool before = true;
    for (uint32_t v = header.first_vertex; v < header.first_vertex + header.count; ++v) {
      if (maps_[v].size() != header.term) continue;
      const bool has = coder.Decode(models.has[before]);
      stream.Require(!coder.overrun(), "a term is too short");
      before = has;
      if (!has) continue;
      stream.Require(rings_[v].samples > 0, "a vertex of no triangle has terms");
      sigma += transport::Unzigzag(models.sigma.Decode(coder));
      stream.Require(std::abs(sigma) <= transport::kMostSigma, "the scale of a term is too large");
      stream.Require(!coder.overrun(), "a term is too short");
      maps_[v].push_back(
          ReadTerm(static_cast<int>(v), static_cast<int>(sigma), step, coder, models));
    }
  }

 private:
  TermMaps ReadTerm(int vertex, int sigma, float step, RangeDecoder& coder,
                    transport::TermModels& models) const {
    const Ring& ring = rings_[vertex];
    const auto scale = static_cast<float>(1 / transport::SigmaOf(sigma));
    std::vector<float> surface(ring.samples);
    std::vector<PatchValues> patches;
    float* patch = surface.data();
    for (size_t i = 0; i < ring.triangles.size(); ++i) {
      const int n = ring.edge_samples[i];
      CoefficientBlock block = MakeBlock(n, 1, true);
      models.surface[transport::SizeClass(n)].Decode(coder, block);
      const std::span<float> values(patch, static_cast<size_t>(PatchSampleCount(n)));
      transform_.FromTriangle(n, Dequantized(block, 0, step * scale), values);
      // Maps end at the far edges of a ring, where the triangles beyond do not know the vertex.
      const int far_edge = (ring.corners[i] + 1) % 3;
      for (int along = 0; along < n; ++along) values[EdgeSampleIndex(n, far_edge, along)] = 0;
      patches.push_back({patch, true});
      patch += values.size();
    }
    MakeContinuous(ring.shared, 1, patches);
    CoefficientBlock block = MakeBlock(frame_.grid, 3, false);
    models.view.Decode(coder, block);
    Eigen::MatrixXf opponent(frame_.grid * frame_.grid, 3);
    for (int c = 0; c < 3; ++c) {
      const Eigen::MatrixXf plane =
          transform_.FromSquare(frame_.grid, Dequantized(block, c, step)).transpose();
      opponent.col(c) = plane.reshaped();
    }
    Eigen::MatrixXf view = opponent * OpponentColors().transpose();
    const Extent extent = SurfaceExtent(ring.edge_samples, surface);
    const AlphaSplit split = SplitAlpha(extent.max_abs(), view.cwiseAbs().maxCoeff());
    view *= static_cast<float>(split.view);
    TermMaps maps;
    QuantizeSurface(ring.edge_samples, ring.shared, surface, extent, split.surface, maps);
    QuantizeView(std::span(view.data(), static_cast<size_t>(view.size())), maps);
    return maps;
  }

  const Frame& frame_;
  const MapTransform& transform_;
  const std::vector<Ring>& rings_;
  std::vector<std::vector<TermMaps>>& maps_;
};

std::vector<std::vector<TermMaps>> DecodeTerms(const std::string& name, const Parts& parts,
                                               const Frame& frame, const MapTransform& transform,
                                               const std::vector<Ring>& rings) {
  const Stream stream{{}, name};
  const auto vertices = static_cast<uint32_t>(rings.size());
  const uint32_t chunks = (vertices + transport::kChunk - 1) / transport::kChunk;
  std::vector<std::vector<const Part*>> by_chunk(chunks);
  for (const Part& part : parts.terms) {
    const uint32_t first = part.header.first_vertex;
    const bool fits =
        first % transport::kChunk == 0 && first < vertices &&
        part.header.count == std::min<uint32_t>(transport::kChunk, vertices - first) &&
        part.header.term < static_cast<uint32_t>(frame.terms) &&
        part.header.term == by_chunk[first / transport::kChunk].size();
    stream.Require(fits, "a term comes before the one that it adds to");
    by_chunk[first / transport::kChunk].push_back(&part);
  }
  // Nonnegative terms hold the mean view between them: some of them would show part of the light.
  if (parts.missing > 0 && frame.mean_in_terms) {
    for (auto& chunk : by_chunk) {
      if (static_cast<int>(chunk.size()) < frame.terms) chunk.clear();
    }
  }
  std::vector<std::vector<TermMaps>> maps(rings.size());
  const ChunkReader reader(frame, transform, rings, maps);
  ParallelFor(0, chunks, [&](int64_t chunk) {
    for (const Part* part : by_chunk[chunk]) reader.Read({part->bytes, name}, part->header);
  });
  return maps;
}

}  // namespace

DecodedModel DecodeTransport(std::string_view bytes, const std::string& name) {
  const Parts parts = FindParts({bytes, name});
  const Frame frame = DecodeGeometry({parts.geometry, name});
  ValidateMesh(frame.mesh, name.c_str());
  const MapTransform transform = transport::MakeTransform(frame.edge_samples, frame.grid);
  const std::vector<Ring> rings = transport::MakeRings(frame.mesh, frame.edge_samples);
  const std::vector<uint8_t> measured(frame.edge_samples.size(), 1);
  const std::vector<std::vector<uint8_t>> mean_codes = ContinuousMeanCodes(
      FindSharedSamples(frame.mesh.triangles, frame.edge_samples), frame.edge_samples, measured,
      DecodeMean({parts.mean, name}, frame, transform));
  const std::vector<std::vector<TermMaps>> maps = DecodeTerms(name, parts, frame, transform, rings);

  std::vector<int> vertex_terms;
  for (const auto& terms : maps) vertex_terms.push_back(static_cast<int>(terms.size()));
  LightFieldModel model =
      LayOutModel(frame.Source(), frame.edge_samples, std::move(vertex_terms), frame.max_texture);
  model.mean_in_terms = frame.mean_in_terms;
  for (size_t t = 0; t < mean_codes.size(); ++t) {
    WriteMean(mean_codes[t], static_cast<int>(t), model);
  }
  ParallelFor(0, static_cast<int64_t>(maps.size()), [&](int64_t v) {
    WriteVertexTerms(rings[v].triangles, maps[v], static_cast<int>(v), model);
  });
  ValidateModel(model, name);
  return {FillGutters(std::move(model)), parts.missing};
}

std::string CutOffNote(const std::filesystem::path& file, const DecodedModel& decoded) {
  return file.string() + " is cut off: " + std::to_string(decoded.parts_missing) +
         " of its parts are missing, finer terms of some places";
}

DecodedModel ReadModel(const std::filesystem::path& file) {
  const std::string bytes = ReadFile(file);
  const std::string_view magic(transport::kMagic.data(), transport::kMagic.size());
  if (bytes.starts_with(magic)) return DecodeTransport(bytes, file.string());
  if (bytes.starts_with("#VRML")) return {ReadAfx(file), 0};
  return {ReadGlbBytes(bytes, file.string()), 0};
}

}  // namespace lfm
