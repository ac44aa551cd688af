// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/shapes/shape.h"

namespace lfm {

/// A seated figure on a lotus, 120 mm high and 92 mm wide, that stands on z = 0 and looks to -y:
/// crossed legs, hands in the lap, a robe in folds, curled hair, two rows of petals. Its own parts
/// shade it deeply (the stand-in for the Buddha of Mahajan 2007, Figure 10). One closed body for
/// edges up to 2.5 mm.
Shape MakeStatue(double edge_mm);

}  // namespace lfm
