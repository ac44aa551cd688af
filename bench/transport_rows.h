// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "fields/block_pca.h"
#include "fields/function_rows.h"

namespace lfm::bench {

/// The rows of a transport capture that light leaves: of an image the pixels that see the scene, of
/// a mesh the vertices that are lit.
struct TransportRows {
  std::string name;
  FunctionRows rows;
  RowsOfPicture picture;                   ///< of an image
  std::vector<Eigen::Vector3f> positions;  ///< a row: the vertex, or the pixel's x and y
};

/// Reads `folder`, the first view and channel. A pixel that sees past the scene has one texel for
/// itself: more than 0.2 of its radiance for a unit of one texel's.
TransportRows ReadTransportRows(const std::filesystem::path& folder);

/// The rows with these numbers; the picture keeps the others as not occupied.
TransportRows SomeOf(const TransportRows& all, const std::vector<int64_t>& which);

/// The rows on the most frequent height of the vertices, within 0.5 mm: a street's ground.
std::vector<int64_t> RowsOfGround(const TransportRows& mesh);

/// The picture at half the resolution: pixels averaged two by two. Only whole squares of occupied
/// pixels are occupied.
TransportRows HalfSize(const TransportRows& image);

/// Light at half the resolution: a texel's column is the sum of the four that it covers.
TransportRows CoarserLight(const TransportRows& all);

}  // namespace lfm::bench
