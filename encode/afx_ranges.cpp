// SPDX-License-Identifier: BSD-3-Clause
// Rounding errors of u' and v' are independent and uniform with variance proportional to R^2, so
// that the squared error of the M x 3N product u' v'^T is expected to be proportional to
//   R^2 (3N |u|^2 c^2 + M |v|^2 / c^2),   u' = c u, v' = v / c.
#include "encode/afx_ranges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lfm {
namespace {

// The share c of equal maxima.
double BalancedShare(const TermExtents& term) {
  return SplitAlpha(term.surface.max_abs(), term.view.max_abs()).surface;
}

Extent Scaled(const Extent& extent, double factor) {
  const auto a = static_cast<float>(extent.low * factor),
             b = static_cast<float>(extent.high * factor);
  Extent scaled;
  scaled.Include(a);
  scaled.Include(b);
  return scaled;
}

Extent Joined(const TermExtents& term, double share) {
  Extent joined = Scaled(term.surface, share);
  const Extent view = Scaled(term.view, 1 / share);
  joined.Include(view.low);
  joined.Include(view.high);
  return joined;
}

double SignedBalancedShare(const TermExtents& term) {
  const double share = BalancedShare(term);
  const Extent joined = Joined(term, share);
  return -joined.low > joined.high ? -share : share;
}

// The share nearest to the best one with which both maps still lie in `range`.
double BestShare(const TermExtents& term, const Extent& range, double balanced) {
  if (!(term.surface_norm2 > 0) || !(term.view_norm2 > 0)) return balanced;
  double least = 0, most = std::numeric_limits<double>::infinity();
  const Extent u = Scaled(term.surface, balanced < 0 ? -1 : 1);
  const Extent v = Scaled(term.view, balanced < 0 ? -1 : 1);
  if (u.high > 0) most = std::min<double>(most, range.high / u.high);
  if (u.low < 0) most = std::min<double>(most, range.low / u.low);
  if (v.high > 0) least = std::max<double>(least, v.high / range.high);
  if (v.low < 0) least = std::max<double>(least, v.low / range.low);
  const double best = std::pow(
      term.surface_samples * term.view_norm2 / (term.view_samples * term.surface_norm2), 0.25);
  // The balanced share fits by the range's making; rounding must not turn the bounds round.
  const double size = std::abs(balanced);
  const double share = std::clamp(best, std::min(least, size), std::max(most, size));
  return balanced < 0 ? -share : share;
}

}  // namespace

SharedRange ShareRange(std::span<const TermExtents> terms) {
  SharedRange shared;
  if (terms.empty()) return shared;
  Extent extent;
  for (const TermExtents& term : terms) {
    const Extent joined = Joined(term, SignedBalancedShare(term));
    extent.Include(joined.low);
    extent.Include(joined.high);
  }
  shared.range = SurfaceRange(extent.low, extent.high);
  for (const TermExtents& term : terms) {
    shared.surface_scales.push_back(BestShare(term, extent, SignedBalancedShare(term)));
  }
  return shared;
}

}  // namespace lfm
