// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lfm {

/// A patch as its cost sees it: p pixels (or vertices), n basis functions.
struct PatchSize {
  int64_t pixels = 0;
  int64_t terms = 0;
};

/// Multiplications a frame, and as many numbers stored (Mahajan 2007, Section 4.1): light in N
/// global functions goes into each patch's local functions, and from these to each of its pixels.
struct RenderingCost {
  double overhead = 0;   ///< sum of n N
  double per_pixel = 0;  ///< sum of n p
  int64_t pixels = 0;    ///< sum of p

  double Total() const { return overhead + per_pixel; }
  /// Equation 18, averaged over the pixels: basis functions a pixel. 0 without pixels.
  double PerPixel() const { return pixels > 0 ? Total() / static_cast<double>(pixels) : 0; }
};

/// Equations 17 and 19 summed over patches: n (p + N), `global_terms` being N, or l where light
/// comes as it is.
RenderingCost CostOf(std::span<const PatchSize> patches, double global_terms);

/// Equation 22: d = c - c', what is saved when a patch is divided into `parts`, measured numbers
/// all. Divide when it is positive.
double GainOfDivision(const PatchSize& whole, std::span<const PatchSize> parts,
                      double global_terms);

/// How dimensionality shrinks when a patch is divided into r parts (Equation 21: each of them needs
/// mu n terms).
struct Shrinkage {
  double parts = 2;  ///< r: 2 for clusters, 4 for blocks (Section 5.1)
  double mu = 0.5;
};

/// mu = r^-s (Section 5.1), s the slope of log n over log p.
double MuOfSlope(double slope, double parts);
/// Equation 23: d of a patch that divides by the rule.
double GainOfDivision(const PatchSize& whole, const Shrinkage& shrinkage, double global_terms);
/// Equation 27: p* = N (r mu - 1) / (1 - mu). 0 where every division pays (r mu <= 1), infinity
/// where none does (mu >= 1).
double OptimalPatchPixels(const Shrinkage& shrinkage, double global_terms);
/// Equation 29: by what the total cost grows when the pixels are doubled `doublings` times:
/// (2 mu)^doublings; 4 mu^2 for twice the resolution. mu is of r = 2.
double GrowthOfCost(double mu, double doublings);

/// The slope of log terms over log pixels by least squares (Section 5.1's s). Patches without
/// pixels or terms do not count; fewer than two different sizes give 0.
double SlopeOfTerms(std::span<const PatchSize> patches);

}  // namespace lfm
