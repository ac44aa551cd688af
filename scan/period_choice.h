// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "scan/axis_frames.h"

namespace lfm {

/// What beside the shortest period's phase speaks about a pixel's period.
struct PeriodEvidence {
  std::vector<float> bits;       ///< soft Gray bits in [-1, 1], coarsest first
  std::vector<float> phases;     ///< of the longer periods, radians
  std::vector<float> variances;  ///< of these phases, from noise
};

struct ChosenPeriod {
  double position = 0;  ///< projector pixels
  double margin = 0;    ///< log-likelihood over the next best period's
};

/// Finds which of the positions x_k = fraction + k period, one a period of the shortest phase
/// shift, is the true one: the most likely given all other patterns.
///
///   L_k = 23 sum_i b_i s_i(x_k) + sum_j (cos(phi_j - 2 pi x_k / P_j) - 1) / s_j^2
///
/// b_i are soft Gray bits and s_i(x) the code expected at x, which falls to 0 near the bit's edges,
/// as far as code and phase may disagree; P_j are the longer periods, s_j^2 = variance_j + (h /
/// 4)^2 with h half the least phase difference between two candidates, so that errors that are no
/// noise (interreflection, the projector's curve) are allowed a quarter of what would mislead.
class PeriodChooser {
 public:
  explicit PeriodChooser(const AxisFrames& frames);
  /// `fraction_px` in [-1, period - 1). No answer when no candidate lies in the picture or all
  /// speaks against the best.
  std::optional<ChosenPeriod> Choose(double fraction_px, const PeriodEvidence& evidence);

 private:
  void MakeBitTable(const AxisFrames& frames);

  int size_ = 0, period_px_ = 0, candidates_ = 0, bits_ = 0, places_ = 0;
  double half_step_ = 0;
  std::vector<float> bit_table_;        ///< [place][bit][candidate]
  std::vector<float> cosines_, sines_;  ///< [longer period][candidate]
  std::vector<int> longer_;
  std::vector<float> scores_;
};

}  // namespace lfm
