// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/capture.h"
#include "core/progress.h"
#include "fields/field.h"

namespace lfm {

/// The light transport of a capture, `capture.transport`, which must be there, as a field (Mahajan
/// 2007, T): a column a texel of the cube map (core/cube_map.h), a point a row of the matrix file.
///
/// Of an image, points are pixels row by row from the top; of a mesh, the vertices as the first eye
/// sees them, then as the second does, and so on: point = view * vertices + vertex, with the
/// vertex's position. `which`: the points that are read, in this order (0 x 0 pixels then); empty:
/// all of them. Takes 4 bytes x points x channels x columns, padded.
///
/// Parallel over points. Throws Error, naming the file, when it is missing or damaged, when its
/// size is not that of the camera's pictures or of the mesh and its eyes, when its cube map is not
/// the one that is stated, when a number is not finite, when a point in `which` does not exist, and
/// when the machine has not the memory.
Field ReadTransportField(const Capture& capture, const std::vector<int64_t>& which,
                         Progress& progress);

}  // namespace lfm
