// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/shapes/shape.h"

namespace lfm {

/// The parts of the toy turtle, each a closed body; they grow into each other.
enum class TurtlePart { kBody, kShell, kBelly, kEyes };

/// A stuffed toy turtle, 57 mm high, 125 mm long, 95 mm wide, that lies on z = 0 and looks to -y:
/// round head, four flippers, a tail, a domed shell of nineteen scutes with a rolled rim. Closed
/// for edges up to 3 mm (eyes: 1.5 mm).
Shape MakeTurtle(TurtlePart part, double edge_mm);

}  // namespace lfm
