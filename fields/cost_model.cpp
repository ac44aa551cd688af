// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cost_model.h"

#include <cmath>
#include <limits>

namespace lfm {

RenderingCost CostOf(std::span<const PatchSize> patches, double global_terms) {
  RenderingCost cost;
  for (const PatchSize& patch : patches) {
    const auto terms = static_cast<double>(patch.terms);
    cost.overhead += terms * global_terms;
    cost.per_pixel += terms * static_cast<double>(patch.pixels);
    cost.pixels += patch.pixels;
  }
  return cost;
}

double GainOfDivision(const PatchSize& whole, std::span<const PatchSize> parts,
                      double global_terms) {
  return CostOf({&whole, 1}, global_terms).Total() - CostOf(parts, global_terms).Total();
}

double MuOfSlope(double slope, double parts) { return std::pow(parts, -slope); }

double GainOfDivision(const PatchSize& whole, const Shrinkage& shrinkage, double global_terms) {
  const auto terms = static_cast<double>(whole.terms), pixels = static_cast<double>(whole.pixels);
  return (1 - shrinkage.mu) * terms * pixels +
         (1 - shrinkage.parts * shrinkage.mu) * terms * global_terms;
}

double OptimalPatchPixels(const Shrinkage& shrinkage, double global_terms) {
  const double more = shrinkage.parts * shrinkage.mu - 1;
  if (more <= 0) return 0;
  if (shrinkage.mu >= 1) return std::numeric_limits<double>::infinity();
  return global_terms * more / (1 - shrinkage.mu);
}

double GrowthOfCost(double mu, double doublings) { return std::pow(2 * mu, doublings); }

double SlopeOfTerms(std::span<const PatchSize> patches) {
  double count = 0, x_sum = 0, y_sum = 0;
  for (const PatchSize& patch : patches) {
    if (patch.pixels <= 0 || patch.terms <= 0) continue;
    count += 1;
    x_sum += std::log(static_cast<double>(patch.pixels));
    y_sum += std::log(static_cast<double>(patch.terms));
  }
  if (count < 2) return 0;
  double spread = 0, together = 0;
  for (const PatchSize& patch : patches) {
    if (patch.pixels <= 0 || patch.terms <= 0) continue;
    const double x = std::log(static_cast<double>(patch.pixels)) - x_sum / count;
    spread += x * x;
    together += x * (std::log(static_cast<double>(patch.terms)) - y_sum / count);
  }
  return spread > 1e-12 * count ? together / spread : 0;
}

}  // namespace lfm
