// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scan/axis_frames.h"
#include "scan/decode.h"
#include "scan/gray_decoding.h"
#include "scan/stripe_tracker.h"

namespace lfm {

/// The moving stripe of Chen 2002 (section 2.1), Bouguet and Perona 1998, Curless and Levoy 1995:
/// each pixel's temporal peak to a fraction of a frame (scan/stripe_fit.h), from what the tracker
/// saw. One blur holds for the whole picture, the one that fits a sample of pixels best; a blur
/// that differs from it is symmetric and moves no peak. Noise is fitted to the sample's residuals.
/// Rejected are pixels whose peak is lower than `min_modulation` of white - black, that saw a
/// second stripe more than half as high (interreflection, glossy paint), or whose moments fit no
/// stripe.
AxisCoordinates DecodeStripeAxis(const StripeTracker& tracker, const AxisFrames& frames,
                                 const PixelLight& light, const DecodeOptions& options);

}  // namespace lfm
