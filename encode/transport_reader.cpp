// SPDX-License-Identifier: BSD-3-Clause
// Trusts nothing: sizes are bounded before memory is taken, parts carry checksums, and what damaged
// bits decode to stays within the bounds of its type.
#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "encode/afx.h"
#include "encode/file_errors.h"
#include "encode/glb.h"
#include "encode/gutters.h"
#include "encode/map_quantization.h"
#include "encode/mean_view.h"
#include "encode/model_layout.h"
#include "encode/transport_form.h"
#include "encode/transport_geometry.h"
#include "encode/transport_stream.h"
#include "encode/transport_terms.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

using transport::Geometry;
using transport::Stream;
using transport::TermPart;

struct Parts {
  std::string_view geometry, mean;
  std::vector<TermPart> terms;
  int missing = 0;
};

Parts FindParts(Stream stream) {
  transport::FileHeader header;
  stream.Require(stream.Take(header) && header.magic == transport::kMagic,
                 "not a light field model");
  if (header.version != transport::kVersion) {
    stream.Fail("version " + std::to_string(header.version) + " is not known");
  }
  Parts parts;
  uint32_t count = 0;
  for (; count < header.parts; ++count) {
    TermPart part;
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

void CheckMeanBytes(const Stream& stream, const Geometry& geometry) {
  int64_t texels = transport::TexelBudget(stream);
  for (const int n : geometry.edge_samples) texels -= int64_t{3} * PatchSampleCount(n);
  stream.Require(texels > 0, "its mean view is too short for its patches");
}

using TermsOfVertices = std::vector<std::vector<TermMaps>>;

// The parts of each chunk of vertices, term after term.
std::vector<std::vector<TermPart>> PartsOfChunks(const std::string& name, const Parts& parts,
                                                 const Geometry& geometry) {
  const Stream stream{{}, name};
  const auto vertices = static_cast<uint32_t>(geometry.mesh.vertices.size());
  const uint32_t chunks = (vertices + transport::kChunk - 1) / transport::kChunk;
  std::vector<std::vector<TermPart>> by_chunk(chunks);
  for (const TermPart& part : parts.terms) {
    const uint32_t first = part.header.first_vertex;
    const bool fits =
        first % transport::kChunk == 0 && first < vertices &&
        part.header.count == std::min<uint32_t>(transport::kChunk, vertices - first) &&
        part.header.term < static_cast<uint32_t>(geometry.terms) &&
        part.header.term == by_chunk[first / transport::kChunk].size();
    stream.Require(fits, "a term comes before the one that it adds to");
    by_chunk[first / transport::kChunk].push_back(part);
  }
  // Nonnegative terms hold the mean view between them: some of them would show part of the light.
  if (parts.missing > 0 && geometry.mean_in_terms) {
    for (auto& chunk : by_chunk) {
      if (static_cast<int>(chunk.size()) < geometry.terms) chunk.clear();
    }
  }
  return by_chunk;
}

struct Maps {
  std::vector<std::vector<uint8_t>> mean;
  TermsOfVertices terms;
};

Maps DecodeMaps(const std::string& name, const Parts& parts, const transport::MapContext& context) {
  const Geometry& geometry = context.geometry;
  const auto by_chunk = PartsOfChunks(name, parts, geometry);
  Maps maps;
  maps.terms.resize(geometry.mesh.vertices.size());
  // The mean view is one stream: it goes first, beside the terms.
  ParallelFor(0, static_cast<int64_t>(by_chunk.size()) + 1, [&](int64_t job) {
    if (job > 0) {
      transport::DecodeChunk(context, by_chunk[job - 1], name, maps.terms);
      return;
    }
    const std::vector<uint8_t> measured(geometry.edge_samples.size(), 1);
    maps.mean = ContinuousMeanCodes(
        FindSharedSamples(geometry.mesh.triangles, geometry.edge_samples), geometry.edge_samples,
        measured, transport::DecodeMean(context, {parts.mean, name}));
  });
  return maps;
}

DecodedModel Decode(std::string_view bytes, const std::string& name) {
  const Parts parts = FindParts({bytes, name});
  const Geometry geometry = transport::DecodeGeometry({parts.geometry, name});
  ValidateMesh(geometry.mesh, name.c_str());
  CheckMeanBytes({parts.mean, name}, geometry);
  const MapTransform transform = transport::MakeTransform(geometry.edge_samples, geometry.grid);
  const VertexRings rings = ComputeVertexRings(geometry.mesh);
  const Maps maps = DecodeMaps(name, parts, {geometry, transform, rings});

  std::vector<int> vertex_terms;
  for (const auto& terms : maps.terms) vertex_terms.push_back(static_cast<int>(terms.size()));
  LightFieldModel model = LayOutModel(geometry.Source(), geometry.edge_samples,
                                      std::move(vertex_terms), geometry.max_texture);
  model.mean_in_terms = geometry.mean_in_terms;
  ParallelFor(0, static_cast<int64_t>(maps.mean.size()),
              [&](int64_t t) { WriteMean(maps.mean[t], static_cast<int>(t), model); });
  ParallelFor(0, static_cast<int64_t>(maps.terms.size()), [&](int64_t v) {
    const auto ring = rings.Ring(v);
    WriteVertexTerms(ring, maps.terms[v], static_cast<int>(v), model);
  });
  ValidateModel(model, name);
  return {FillGutters(std::move(model)), parts.missing};
}

}  // namespace

DecodedModel DecodeTransport(std::string_view bytes, const std::string& name) {
  return NamingFile(name, [&] { return Decode(bytes, name); });
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
