// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace lfm {

enum class PatternAxis { kColumn, kRow };
enum class PatternKind { kWhite, kBlack, kGray, kGrayInverse, kPhase, kStripe };

/// How a stripe's light falls off across it.
enum class StripeProfile {
  kBox,    ///< full inside the width, nothing outside: a projected stripe (Bouguet and Perona 1998)
  kGauss,  ///< Gaussian, the width at half its height: a laser's sheet (Curless and Levoy 1995)
};

/// A bright stripe that moves across the picture: in frame i its centre is at
///   c_i = i step - width    (column or row, pixels)
/// so that it comes in from outside and leaves the picture whole.
struct StripeShape {
  StripeProfile profile = StripeProfile::kGauss;
  int width_px = 12;
  int step_px = 4;
  bool operator==(const StripeShape&) const = default;
};

/// What the projector shows in one frame. Its name in a manifest: "white", "black",
/// "column-gray-3", "column-gray-3-inverse", "row-phase-5" (step 5 of the sequence's own period),
/// "column-phase-64-3" (step 3 of period 64 px), "column-stripe-gauss-12-4-37" (width 12 px, moving
/// by 4 px, frame 37; or "box").
///
/// Gray bit `index` 0 is the most significant bit of the reflected Gray code of the column (row)
/// number, as many bits as the largest number needs. Phase frame `index` of `steps` has the value
///   1/2 + 1/2 cos(2 pi (x / period - index / steps))
/// at column (row) x, x = 0 at the centre of the first column. A stripe of box profile has the
/// share of the pixel that lies within width / 2 of its centre; of Gaussian profile
///   exp(-4 ln 2 ((x - c) / width)^2).
/// All patterns but white and black are constant along the other axis.
struct Pattern {
  PatternKind kind = PatternKind::kWhite;
  PatternAxis axis = PatternAxis::kColumn;
  int index = 0;
  int period_px = 0;        ///< kPhase: 0 means the sequence's own period
  StripeShape stripe = {};  ///< kStripe only
};

/// A projector's sequence: its size and the parameters that names alone do not carry.
struct PatternSequence {
  int projector_width = 0, projector_height = 0;
  int phase_steps = 8;  ///< of every period
  int phase_period_px = 16;
  std::vector<Pattern> patterns;
};

/// Name of a pattern in a manifest, and back (Error on anything else).
std::string PatternName(const Pattern& pattern);
Pattern ParsePatternName(const std::string& name);

/// What a sequence finds its way across the picture by.
enum class PatternScheme {
  kGrayPhase,   ///< white, black, Gray code with inverses, one phase period
  kGray,        ///< white, black, Gray code with inverses
  kMultiPhase,  ///< white, black, phase shifts of several periods, the longest over the picture
  kStripe,      ///< white, black, a stripe that moves across
};

struct PatternOptions {
  PatternScheme scheme = PatternScheme::kGrayPhase;
  int phase_steps = 8;   ///< 3 to 256
  int period_ratio = 4;  ///< kMultiPhase: of one period to the next shorter, 2 to 64
  StripeShape stripe;    ///< kStripe
};

/// Along the columns; with `rows`, along the rows too.
enum class PatternRows { kWithout, kWith };

/// A whole sequence. Throws Error for a size outside 1..65536 or options outside their ranges.
PatternSequence MakePatternSequence(int projector_width, int projector_height, PatternRows rows,
                                    const PatternOptions& options = {});

/// The sequence that a manifest's role names describe; the number of phase steps is what is there.
/// Throws Error when a name is unknown or repeated, a phase or stripe frame is missing between
/// others, periods have different numbers of steps, an axis has stripes of two shapes, or a frame
/// lies outside the projector's picture.
PatternSequence SequenceFromNames(int projector_width, int projector_height,
                                  const std::vector<std::string>& names);

/// Number of Gray code bits along an axis.
int GrayBits(const PatternSequence& sequence, PatternAxis axis);

/// Periods of a multi-frequency phase shift over `size` pixels, shortest first: `finest_px` times
/// powers of `ratio`, up to the first that is at least `size` (so that its phase is unambiguous).
std::vector<int> PhasePeriods(int size, int finest_px, int ratio);

/// Number of frames in which a stripe crosses `size` pixels: its centre goes from -width to at
/// least size - 1 + width.
int StripeFrames(int size, const StripeShape& stripe);

/// Radiance in [0, 1] (linear) that the projector sends through continuous projector coordinates
/// (column, row) in pixels, centre of the first pixel = (0, 0). Pixels are squares of constant
/// value; 0 outside the picture.
double PatternValue(const PatternSequence& sequence, const Pattern& pattern, double column,
                    double row);

}  // namespace lfm
