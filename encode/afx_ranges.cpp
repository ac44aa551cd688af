// SPDX-License-Identifier: BSD-3-Clause
// Rounding errors of u' and v' are independent and uniform with variance proportional to R^2, so
// that the squared error of the M x 3N product u' v'^T is expected to be proportional to
//   R^2 (3N |u|^2 c^2 + M |v|^2 / c^2),   u' = c u, v' = v / c.
#include "encode/afx_ranges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lfm {
namespace {

constexpr size_t kMostCandidates = 256;  // places where groups may begin

double NeededRange(const TermExtents& term) {
  return std::sqrt(static_cast<double>(term.surface.max_abs()) * term.view.max_abs());
}

// The share c of equal maxima, and the error that the product then has in units of R^2.
double BalancedShare(const TermExtents& term) {
  return SplitAlpha(term.surface.max_abs(), term.view.max_abs()).surface;
}
double ErrorWeight(const TermExtents& term) {
  const double c2 = BalancedShare(term) * BalancedShare(term);
  return term.view_samples * term.surface_norm2 * c2 + term.surface_samples * term.view_norm2 / c2;
}

// First elements of at most `groups` runs of the descending `needed`, such that the sum over runs
// of (first needed)^2 * (sum of weights) is least.
std::vector<size_t> SplitRuns(const std::vector<double>& needed, const std::vector<double>& weights,
                              int groups) {
  const size_t count = needed.size();
  std::vector<size_t> begins;
  const size_t step = (count + kMostCandidates - 1) / kMostCandidates;
  for (size_t i = 0; i < count; i += step) begins.push_back(i);
  std::vector<double> sums(count + 1, 0.0);
  for (size_t i = 0; i < count; ++i) sums[i + 1] = sums[i] + weights[i];

  const size_t n = begins.size();
  begins.push_back(count);
  // least[g][i]: cost of what comes from candidate i on, with at most g + 1 runs.
  std::vector<std::vector<double>> least(groups, std::vector<double>(n + 1, 0.0));
  std::vector<std::vector<size_t>> next(groups, std::vector<size_t>(n + 1, n));
  for (int g = 0; g < groups; ++g) {
    for (size_t i = 0; i < n; ++i) {
      const double square = needed[begins[i]] * needed[begins[i]];
      least[g][i] = square * (sums[count] - sums[begins[i]]);
      for (size_t j = i + 1; g > 0 && j < n; ++j) {
        const double cost = square * (sums[begins[j]] - sums[begins[i]]) + least[g - 1][j];
        if (cost >= least[g][i]) continue;
        least[g][i] = cost;
        next[g][i] = j;
      }
    }
  }
  std::vector<size_t> runs;
  size_t i = 0;
  for (int g = groups - 1; i < n; --g) {
    runs.push_back(begins[i]);
    i = next[g][i];
  }
  return runs;
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

SharedRanges ShareRanges(std::span<const TermExtents> terms, int light_maps) {
  SharedRanges shared;
  shared.scales.resize(terms.size());
  if (terms.empty()) return shared;
  std::vector<size_t> order(terms.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return NeededRange(terms[a]) > NeededRange(terms[b]);
  });
  std::vector<double> needed, weights;
  for (const size_t i : order) {
    needed.push_back(NeededRange(terms[i]));
    weights.push_back(ErrorWeight(terms[i]));
  }
  const std::vector<size_t> runs = SplitRuns(needed, weights, light_maps);
  for (size_t g = 0; g < runs.size(); ++g) {
    const size_t end = g + 1 < runs.size() ? runs[g + 1] : order.size();
    Extent extent;
    for (size_t i = runs[g]; i < end; ++i) {
      const Extent joined = Joined(terms[order[i]], SignedBalancedShare(terms[order[i]]));
      extent.Include(joined.low);
      extent.Include(joined.high);
    }
    shared.ranges.push_back(SurfaceRange(extent.low, extent.high));
    for (size_t i = runs[g]; i < end; ++i) {
      const TermExtents& term = terms[order[i]];
      shared.scales[order[i]] = {static_cast<int>(g),
                                 BestShare(term, extent, SignedBalancedShare(term))};
    }
  }
  return shared;
}

}  // namespace lfm
