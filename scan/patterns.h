// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace lfm {

enum class PatternAxis { kColumn, kRow };
enum class PatternKind { kWhite, kBlack, kGray, kGrayInverse, kPhase };

/// What the projector shows in one frame. Its name in a manifest: "white", "black",
/// "column-gray-3", "column-gray-3-inverse", "row-phase-5".
///
/// Gray bit `index` 0 is the most significant bit of the reflected Gray code of the column (row)
/// number, as many bits as the largest number needs. Phase frame `index` of `steps` has the value
///   1/2 + 1/2 cos(2 pi (x / period - index / steps))
/// at column (row) x, x = 0 at the centre of the first column. All patterns but white and black are
/// constant along the other axis.
struct Pattern {
  PatternKind kind = PatternKind::kWhite;
  PatternAxis axis = PatternAxis::kColumn;
  int index = 0;
};

/// A projector's sequence: its size and the parameters that names alone do not carry.
struct PatternSequence {
  int projector_width = 0, projector_height = 0;
  int phase_steps = 8;
  int phase_period_px = 16;
  std::vector<Pattern> patterns;
};

/// Name of a pattern in a manifest, and back (Error on anything else).
std::string PatternName(const Pattern& pattern);
Pattern ParsePatternName(const std::string& name);

/// White, black, Gray code with inverses and phase shift along the columns; with `rows`, along
/// the rows too.
enum class PatternRows { kWithout, kWith };
PatternSequence MakePatternSequence(int projector_width, int projector_height, PatternRows rows);

/// The sequence that a manifest's role names describe; the number of phase steps is what is there.
PatternSequence SequenceFromNames(int projector_width, int projector_height,
                                  const std::vector<std::string>& names);

/// Number of Gray code bits along an axis.
int GrayBits(const PatternSequence& sequence, PatternAxis axis);

/// Radiance in [0, 1] (linear) that the projector sends through continuous projector coordinates
/// (column, row) in pixels, centre of the first pixel = (0, 0). Pixels are squares of constant
/// value; 0 outside the picture.
double PatternValue(const PatternSequence& sequence, const Pattern& pattern, double column,
                    double row);

}  // namespace lfm
