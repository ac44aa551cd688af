// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "encode/model_order.h"

namespace lfm {

/// A triangle mesh whose coordinates are whole numbers.
struct LatticeMesh {
  std::vector<Eigen::Vector3i> vertices, triangles;
};

/// A coded mesh, and where its vertices and triangles lay before.
struct CodedMesh {
  std::string bytes;
  LatticeMesh mesh;  ///< as DecodeMesh gives it
  MeshOrder order;
};

/// Codes a mesh with libdraco: connectivity by edgebreaker (Rossignac 1999), coordinates by
/// parallelogram prediction, both without loss. The order of what comes back is the coder's own, so
/// that no order needs to be sent.
///
/// None where the mesh does not come back as it is: isolated vertices, triangles that repeat a
/// vertex, edges of more than two triangles, vertices of more than one fan. Coordinates must be
/// below 2^26.
std::optional<CodedMesh> EncodeMesh(const LatticeMesh& mesh);

/// The mesh, in the coder's order; none where the bytes are damaged or hold another number of
/// vertices or triangles. Takes memory in proportion to these numbers.
std::optional<LatticeMesh> DecodeMesh(std::string_view bytes, int vertices, int triangles);

}  // namespace lfm
