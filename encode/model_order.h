// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "encode/model.h"

namespace lfm {

/// Where the parts of a mesh in a new order lie in the old one: of each new vertex and triangle the
/// old index; corner c of a new triangle is corner (c + turn) % 3 of the old.
struct MeshOrder {
  std::vector<int> vertices;   ///< V
  std::vector<int> triangles;  ///< T
  std::vector<int> turns;      ///< T; 0 to 2
};

/// Everything where it is.
MeshOrder KeptOrder(const TriangleMesh& mesh);

/// The way back.
MeshOrder Inverse(const MeshOrder& order);

/// A patch (`channels` values a sample) whose triangle's corners are turned: corner c becomes what
/// corner (c + turn) % 3 was. Every sample is one of the old ones.
std::vector<uint8_t> TurnPatch(int edge_samples, int turn, int channels,
                               const std::vector<uint8_t>& values);

/// The same model with vertices, triangles and corners in another order: all codes and ranges are
/// kept, pages and gutters laid out anew, as large as they were at most. `order` must hold every
/// vertex and triangle once (Error, kSystem, where its lengths are not the model's).
LightFieldModel ReorderModel(const LightFieldModel& model, const MeshOrder& order);

/// The largest side of a model's pages, 256 at least.
int LargestPageSide(const LightFieldModel& model);

}  // namespace lfm
