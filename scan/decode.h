// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
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
  double min_modulation = 0.3;  ///< least share of light that comes straight; fringes need half
  double min_margin = 0.35;     ///< least lead of the best period over the next, in Gray bits
};

/// Loads the picture of `sequence.patterns[index]`.
using FrameLoader = std::function<Image(int index)>;

/// Throws Error, naming what is missing, when Decode could not decode the sequence: a Gray bit or
/// a phase step is missing between others, phase shifts repeat across the picture with nothing to
/// tell the repetitions apart, or a Gray code without inverses has no white or black.
void RequireComplete(const PatternSequence& sequence);

/// Decodes projector coordinates with sub-pixel precision, in linear light, pixel by pixel.
///
/// An axis is decoded by the best that the sequence shows of it: phase shift (with Gray code or
/// several periods, scan/phase_decoding.h), else a moving stripe (scan/stripe_decoding.h), else
/// Gray code alone (scan/gray_decoding.h). Each gives position, standard deviation and confidence.
/// Rejected are pixels that the projector does not reach (white - black), that any frame saturates
/// in any channel, that are not finite, whose patterns contradict each other, and that see too
/// little of the projector's light directly: narrow stripes and fringes average the light that
/// wanders between surfaces (Nayar et al. 2006), so the rest of their swing is the direct light.
/// Where white or black is missing, the brightest and darkest value of the other frames stand in.
///
/// Frames are loaded one by one in any order; all but those of stripes are held (8-bit gray ones as
/// they are). Throws Error as RequireComplete, before anything is loaded, when frames differ in
/// size, and passes on what `load` throws. A sequence of no patterns along either axis gives white
/// and contrast only.
DecodedPixels Decode(const PatternSequence& sequence, const FrameLoader& load,
                     const DecodeOptions& options);

/// The same of pictures in memory, `frames[i]` showing `sequence.patterns[i]`.
DecodedPixels Decode(const PatternSequence& sequence, std::span<const Image> frames,
                     const DecodeOptions& options);

}  // namespace lfm
