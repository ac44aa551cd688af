// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "encode/light_field_source.h"

namespace lfm {

/// Bytes of one vertex's mask: a bit for each of its grid^2 directions, rounded up.
size_t GuessedBytes(int grid);

/// Which directions of each vertex's view map nobody saw (Chen 2002, section 5.2, leaves them
/// open): V x GuessedBytes(grid) bytes, as LightFieldModel::guessed.
///
/// A direction counts as seen when it lies inside the convex hull of the photographs that show one
/// of the triangles around the vertex (ViewWeights::seen); all are guessed where no photograph
/// shows any, and where the photographs lie on one line. A hull margin that draws hulls in does not
/// change that. Parallel over vertices.
std::vector<uint8_t> FindGuessedDirections(const LightFieldSource& source);

}  // namespace lfm
