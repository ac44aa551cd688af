// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lfm {

/// Least-squares fits of offset + A cos(phi - 2 pi i / N) to the N phase frames of many pixels.
struct PhaseFits {
  std::vector<float> offset, cosine, sine;  ///< cosine = A cos phi, sine = A sin phi
  /// Mean square that is left a degree of freedom, once up to three harmonics are fitted too:
  /// they are the projector's curve, not noise. 0 where there is no freedom left.
  std::vector<float> residual;
};

/// Harmonics beside the first that `steps` frames leave room for, and what is free after them.
int FittedHarmonics(int steps);
int ResidualFreedom(int steps);

/// Fits `count` pixels; frame i's linear values are frames[i * stride + pixel].
void FitPhases(const float* frames, size_t stride, int steps, size_t count, PhaseFits& fits);

/// Correction of phases for a projector that does not show cosines. With N steps, the harmonics
/// N - 1 and N + 1 pass for the first and shift a phase by a sinusoid of N phi. Phases of many
/// pixels lie evenly over the turn; with M = mean(exp(i N phi)) of those measured,
///   corrected = phi + 2 / N Im(conj(M) exp(i N phi))
/// spreads them evenly again, to first order (Ma et al. 2012 equalise the whole histogram).
struct PhaseCorrection {
  int steps = 0;
  double cosine = 0, sine = 0;  ///< of M
  double Apply(double phase) const;
};

/// None (zeros) where M is below what an uneven scene causes, 0.02, or fewer than 4096 pixels
/// tell.
PhaseCorrection EstimateCorrection(const std::vector<float>& phases, int steps);

}  // namespace lfm
