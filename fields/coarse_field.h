// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/field.h"

namespace lfm {

/// A field at low resolution (Yamada 2009, Section 3.3): points are gathered in cells, squares of
/// a picture's pixels or cubes of space, and the rows of a cell are averaged.
struct CoarseField {
  int64_t cells = 0;
  std::vector<int32_t> cell;  ///< a point of the field
  FunctionRows rows;          ///< row = channel * cells + cell
  /// The cells about a cell, itself in front: cells `neighbours[first[c]]` to `first[c + 1]`.
  std::vector<int64_t> first;
  std::vector<int32_t> neighbours;
};

/// A picture's cells are squares of `factor` pixels, the last of a row or column perhaps smaller;
/// neighbours lie within one cell, diagonals too. Vertices' cells are the occupied cubes of a grid
/// whose side makes about factor^2 points share one; neighbours are the occupied ones of the 27
/// about. Points with neither picture nor position, and any with factor 1 and no picture, are cells
/// of their own without neighbours.
/// Throws Error when factor < 1, sizes do not fit, or a position is not finite.
CoarseField MakeCoarseField(const Field& field, int factor);

}  // namespace lfm
