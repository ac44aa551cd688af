// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "scan/patterns.h"

namespace lfm {

/// Phase shift of one period: steps[i] is the frame of step i.
struct PeriodFrames {
  int period_px = 0;
  std::vector<int> steps;
};

/// Which frames of a sequence say something about one axis; numbers index `sequence.patterns`, and
/// -1 stands for a frame that is not there.
struct AxisFrames {
  int size = 0;                      ///< projector pixels
  int bits = 0;                      ///< that a whole Gray code of this size has
  std::vector<int> gray, inverse;    ///< from the coarsest bit, as many as there are
  std::vector<PeriodFrames> phases;  ///< shortest period first
  std::vector<int> stripes;          ///< in order of the stripe's way
  StripeShape stripe;

  bool HasAllInverses() const;
  /// Projector pixels between neighbouring edges of the Gray code that is there.
  int CellPx() const { return 1 << (bits - static_cast<int>(gray.size())); }
};

/// A sequence sorted by what Decode does with it.
struct SortedFrames {
  int white = -1, black = -1;
  AxisFrames column, row;
};

/// Throws Error when what is there cannot be decoded: a Gray bit or a phase step is missing between
/// others, phase shifts repeat across the picture and neither Gray code nor another period tells
/// the repetitions apart, or a Gray code without inverses lacks white or black. Frames may have
/// any order. Fine bits may be missing: cells are then as wide as the finest that is there.
SortedFrames SortFrames(const PatternSequence& sequence);

}  // namespace lfm
