// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "encode/map_quantization.h"
#include "encode/map_transform.h"
#include "encode/transport_geometry.h"
#include "encode/transport_stream.h"

/// Decoding the maps of the transport form.
namespace lfm::transport {

/// What all maps are decoded with; outlives every call.
struct MapContext {
  const Geometry& geometry;
  const MapTransform& transform;
  const VertexRings& rings;
};

/// A part of the stream with terms.
struct TermPart {
  PartHeader header;
  std::string_view bytes;
};

/// The step at the head of a mean view or a term.
float TakeStep(Stream& stream);

/// Texels that a part may fill: its bytes bound the memory that it takes.
int64_t TexelBudget(const Stream& stream);

/// Decodes the terms of a chunk of vertices, in order, and appends each to the `maps` of those that
/// have all earlier ones. Throws Error, beginning with `name`, where the bytes are damaged. Chunks
/// write to vertices of their own: many threads may decode at once.
void DecodeChunk(const MapContext& context, std::span<const TermPart> parts,
                 const std::string& name, std::vector<std::vector<TermMaps>>& maps);

/// Mean views of all triangles, 3 values a sample, as they were transformed.
std::vector<std::vector<float>> DecodeMean(const MapContext& context, Stream stream);

}  // namespace lfm::transport
