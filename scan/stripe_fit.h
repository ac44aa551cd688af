// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "scan/frame_noise.h"
#include "scan/patterns.h"

namespace lfm {

/// What a pixel sees of a passing stripe: base + height S(x - c), with c the stripe's centre and S
/// its profile, blurred by a Gaussian of sigma `blur_px` (the lens, the pixel's own width, the
/// material), 1 at the centre of a stripe that is not blurred:
///   box    (erf((u + w/2) / (sqrt(2) b)) - erf((u - w/2) / (sqrt(2) b))) / 2
///   gauss  s / t exp(-u^2 / (2 t^2)), s = w / sqrt(8 ln 2), t^2 = s^2 + b^2
struct StripeModel {
  StripeProfile profile = StripeProfile::kGauss;
  double width_px = 12;
  double blur_px = 0.5;

  struct Value {
    double value = 0, slope = 0;  ///< slope: d value / d u
  };
  Value At(double u) const;
};

/// One pixel's moment: value i was taken with the stripe at first_px + i step_px.
struct StripeSamples {
  double first_px = 0, step_px = 1;
  const float* values = nullptr;
  int count = 0;
};

struct StripeFit {
  double position = 0, sigma = 0;  ///< projector pixels
  double base = 0, height = 0;
  /// Mean square of residuals over their noise, a degree of freedom; 1 when noise is all there is.
  double misfit = 0;
};

/// Weighted least squares over base, height and position (Gauss-Newton), each value weighing the
/// inverse of the noise that its model value has: the temporal peak to a fraction of a frame, of
/// least variance. The position does not care what reflectance or shape lie beside the pixel, since
/// it compares moments, not pixels (Curless and Levoy 1995). No answer with fewer than four
/// values, values that are not finite, a stripe that passes outside the moments given, or when the
/// iteration leaves them.
std::optional<StripeFit> FitStripe(const StripeModel& model, const StripeSamples& samples,
                                   const FrameNoise& noise);

}  // namespace lfm
