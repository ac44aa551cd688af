// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/json_reader.h"
#include "sample_data/shapes/shape.h"
#include "sample_data/shapes/shape_parameters.h"

namespace lfm {

/// Makes the shape of a scene file's "shape" object: {"generator": NAME, parameters ...}, as listed
/// in docs/formats.md. Throws Error (file, key, what was expected) for an unknown generator or
/// parameter, a value out of range, and sizes that cannot be made at the edge length asked for.
Shape GenerateShape(JsonReader& reader, SceneDetail detail);

/// In alphabetical order.
std::vector<std::string> ShapeGeneratorNames();

}  // namespace lfm
