// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "core/image.h"
#include "scan/patterns.h"

namespace lfm {

/// Where along one projector axis the light of each camera pixel came from. Rows of pixels from
/// the top; empty when the sequence has no pattern along this axis.
struct AxisCoordinates {
  /// Projector column (row), pixels, centre of the first = 0; 0 where not decoded.
  std::vector<float> position;
  /// Standard deviation of `position`, pixels; 0 where not decoded.
  std::vector<float> sigma;
  /// [0, 1]; 0 = not decoded (dark, saturated, contradictory).
  std::vector<float> confidence;
};

/// What one sequence of pattern pictures says at each camera pixel.
struct DecodedPixels {
  int width = 0, height = 0;
  std::vector<float> white;     ///< linear luminance under all-white
  std::vector<float> contrast;  ///< white - black, linear
  AxisCoordinates column, row;
};

struct DecodeOptions {
  double min_contrast = 0.03;   ///< linear; darker pixels are not decoded
  double min_modulation = 0.3;  ///< least ratio of the fringes' swing to white - black
  double min_margin = 0.35;     ///< least lead of the best period over the next, in Gray bits
};

/// Loads the picture of `sequence.patterns[index]`.
using FrameLoader = std::function<Image(int index)>;

/// Throws Error, naming the first such pattern, when the sequence holds phase frames of several
/// periods or a moving stripe, which Decode does not read.
void RequireDecodable(const PatternSequence& sequence);

/// Decodes projector coordinates with sub-pixel precision.
///
/// In linear light, for each pixel and axis:
/// 1. white - black masks what the projector does not reach; a pixel that any bright frame
///    saturates in any channel is rejected.
/// 2. Gray bit i gives a soft value b_i = (pattern - inverse) / (white - black) in [-1, 1] (against
///    the mean of white and black when inverses are missing).
/// 3. The N phase frames give, by least squares (the first DFT coefficient), amplitude A, phase
///    phi and, from the residual, its uncertainty
///      sigma_x = period / (2 pi) sqrt(2 / N) sigma_I / A.
///    The phase knows the position up to a multiple of the period, x_k = period (k + phi / 2 pi).
/// 4. k maximises the agreement sum_i b_i s_i(x_k) with the Gray code s_i expected at x_k. Since
///    candidates lie exactly one period apart, noise of phase or code at a period's border cannot
///    shift the result by a period, and a blurred fine bit weighs little. Near a transition of bit
///    i, s_i falls linearly to 0.
/// A fringe of 4 mm sees most of the scene's interreflections as constant light, which cancels in
/// 2 and 3 (Nayar 2006); what does not cancel lowers the ratio 2 A / (white - black), or makes bits
/// disagree: both lower the confidence, down to rejection.
///
/// A Gray code without phase frames decodes to whole pixels (sigma = 1 / sqrt(12)).
///
/// Frames are loaded one by one (at most two held at a time besides sums). Throws Error when the
/// sequence lacks white, black or a Gray bit of an axis that it uses, is not decodable (see above),
/// when frames differ in size, and passes on what `load` throws. Non-finite picture values are not
/// decoded.
DecodedPixels Decode(const PatternSequence& sequence, const FrameLoader& load,
                     const DecodeOptions& options);

}  // namespace lfm
