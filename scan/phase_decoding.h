// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scan/axis_frames.h"
#include "scan/decode.h"
#include "scan/frame_planes.h"
#include "scan/gray_decoding.h"

namespace lfm {

/// Phase shift: the shortest period gives the position up to its multiple, Gray code, longer
/// periods or both say which (scan/period_choice.h).
///
/// The N frames of a period give amplitude A and phase by least squares (the first DFT
/// coefficient); the position's standard deviation is
///   period / (2 pi) sqrt(2 / N) sigma_I / A
/// with sigma_I from what the frames leave over: pattern + inverse of the Gray code when there is
/// one, else the residual of the fit beyond three harmonics, else the differences of the periods'
/// means. A fringe a few millimetres wide sees most interreflections as constant light (Nayar et
/// al. 2006): 2 A / (white - black) is the share of light that came straight, and pixels below
/// half of `min_modulation` are rejected: where light and camera graze a surface little comes
/// straight, the phase is still right, and its sigma says how well; so are those whose best period
/// leads by less than `min_margin`.
AxisCoordinates DecodePhaseAxis(const FramePlanes& planes, const AxisFrames& frames,
                                const PixelLight& light, const DecodeOptions& options);

}  // namespace lfm
