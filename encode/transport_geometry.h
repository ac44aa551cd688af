// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "encode/light_field_source.h"
#include "encode/model_order.h"
#include "encode/transport_stream.h"

/// The first part of the transport form (docs/formats.md): mesh, vertex frames, sizes of patches.
namespace lfm::transport {

/// What it holds, in the order of the stream.
struct Geometry {
  TriangleMesh mesh;
  std::vector<Eigen::Matrix3d> vertex_frames;
  std::vector<int> edge_samples;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 2, terms = 0, max_texture = 256;
  bool mean_in_terms = false;

  /// Lives as long as this does.
  LightFieldSource Source() const { return {mesh, vertex_frames, direction_map, grid, {}, {}, 0}; }
};

struct EncodedGeometry {
  std::string bytes;
  MeshOrder order;  ///< of the stream, in the model's
};

/// Coordinates are rounded to a lattice that moves no vertex by more than `error_in_samples` median
/// sample spacings of the model's patches (nor by less than a 2^-20th of its extent). The mesh goes
/// through EncodeMesh; one that does not come back from it is written as differences, in its own
/// order.
EncodedGeometry EncodeGeometry(const LightFieldModel& model, double error_in_samples);

/// Throws as Stream::Require does. Takes memory in proportion to the bytes.
Geometry DecodeGeometry(Stream stream);

/// Median over triangles of the mean distance of samples along the edges, in mm; 0 where all
/// triangles are points.
double MedianSampleSpacing(const LightFieldModel& model);

}  // namespace lfm::transport
