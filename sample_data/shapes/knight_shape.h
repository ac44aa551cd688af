// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/shapes/shape.h"

namespace lfm {

/// What the knight is made of, part by part; parts touch or grow into each other.
enum class KnightPart { kArmour, kMail, kCloth, kCape, kSkin, kShield, kSword, kBase };

/// A standing knight, 120 mm high, on a base on z = 0, facing -y: an open helmet with the face in
/// it, plate on limbs and shoulders, mail under it, a tabard and a cape in folds, the right hand on
/// the pommel of a sword set before him, a shield on the left arm. Every part is closed for edges
/// up to 1.2 mm (sword and skin: 1 mm).
Shape MakeKnight(KnightPart part, double edge_mm);

}  // namespace lfm
