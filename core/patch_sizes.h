// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lfm {

/// Samples of a triangular patch with `n` along an edge, corners included: n (n + 1) / 2.
constexpr int PatchSampleCount(int n) { return n * (n + 1) / 2; }

/// The smallest patch of the predefined sizes n = 4, 7, 13, 25, 49, 97, 193 with at least so many
/// samples. A size has twice the segments of the one before: patches of
/// different size then share every node of the coarser one along an edge, and no detail is lost
/// there (sizes without a common divisor could only share the edge's ends). 25 samples an edge are
/// the paper's 314 a triangle. At most `max_edge_samples`; 4 when `samples` is not a positive
/// number.
int ChooseEdgeSamples(double samples, int max_edge_samples);

}  // namespace lfm
