// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace lfm {

/// Vectors to be grouped. Each is made of `segments` runs of equal length with a weight each:
///
///   d(x_i, y) = sum_s weights[i * segments + s] * |x_i,s - y_s|^2
///
/// (a triangle's block of three maps, whose corners count differently, is one vector of three
/// segments).
struct WeightedVectors {
  int dimensions = 1;               ///< D, a multiple of segments
  int segments = 1;                 ///< S
  std::vector<float> values = {};   ///< count x D
  std::vector<float> weights = {};  ///< count x S, >= 0

  int64_t count() const { return static_cast<int64_t>(values.size()) / dimensions; }
};

/// Where the iteration starts (Chen 2002, Section 5; Gersho and Gray 1992, Sections 11.2 to 11.3).
enum class CodebookStart {
  kSplitting,  ///< one code; those with the largest distortion are split along their main axis
  kPairwise,   ///< all vectors; the pair whose union costs least becomes one (Equitz 1989)
};

struct CodebookOptions {
  CodebookStart start = CodebookStart::kSplitting;
  int max_iterations = 30;
  double tolerance =
      1e-3;  ///< ends when an iteration lowers the distortion by less, relative to it
};

struct Codebook {
  int codes = 0;
  std::vector<float> values;  ///< codes x D
  std::vector<int> indices;   ///< the code of each vector
  double distortion = 0;      ///< sum over vectors of d(vector, its code)
};

/// A codebook of at most `codes` >= 1 codes by the generalised Lloyd algorithm: no code without a
/// vector (empty cells take the vector that is coded worst). When there are no more distinct
/// vectors than codes, they are the codes and nothing is lost. Distortion never rises from one
/// iteration to the next. The result does not depend on the number of threads.
///
/// Cost: count x codes x D multiplications an iteration, and for kPairwise 4096 x 4096 distances of
/// 48 numbers (more vectors are first split into 4096 cells). No vectors give an empty codebook;
/// vectors without weight take any code. Throws Error when the sizes do not fit, a value or weight
/// is not finite, or a weight is negative.
Codebook QuantizeVectors(const WeightedVectors& vectors, int codes, const CodebookOptions& options);

/// Goes on from the cells of a codebook (every code used) of other vectors of the same number and
/// dimensions, with codes of their own; throws as QuantizeVectors.
Codebook ImproveCodebook(const WeightedVectors& vectors, const Codebook& cells,
                         const CodebookOptions& options);

/// The fewest codes whose distortion is at most `max_distortion`, by doubling and bisection to a
/// thirtieth of their number. 0 or less: nothing may be lost.
Codebook QuantizeToDistortion(const WeightedVectors& vectors, double max_distortion,
                              const CodebookOptions& options);

/// What 1, 2, 4, ... codes would lose, up to as many as there are distinct vectors (distortion 0),
/// after a few iterations each: for a choice between groups. `codes` rises, `distortion` falls.
struct RatePoint {
  int codes = 0;
  double distortion = 0;
};
std::vector<RatePoint> MeasureRates(const WeightedVectors& vectors);

}  // namespace lfm
