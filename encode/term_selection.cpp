// SPDX-License-Identifier: BSD-3-Clause
#include "encode/term_selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lfm {
namespace {

constexpr int kSweeps = 8;
constexpr int kBisections = 40;

int MostTerms(const Eigen::Vector3i& corners, const std::vector<int>& terms) {
  return std::max({terms[corners[0]], terms[corners[1]], terms[corners[2]]});
}

// A vertex's choice when its neighbours keep theirs.
int BestTerms(const TermCosts& costs, const VertexRings& rings, int vertex, double lambda,
              const std::vector<int>& terms) {
  const std::vector<double>& errors = costs.squared_errors[vertex];
  int best = 0;
  double least = INFINITY;
  for (int k = 0; k < static_cast<int>(errors.size()); ++k) {
    int64_t bytes = k * costs.view_bytes;
    for (int e = rings.offsets[vertex]; e < rings.offsets[vertex + 1]; ++e) {
      const int triangle = rings.triangles[e];
      int others = 0;
      for (const int corner : costs.mesh.triangles[triangle]) {
        if (corner != vertex) others = std::max(others, terms[corner]);
      }
      bytes += std::max(0, k - others) * costs.patch_bytes[triangle];
    }
    const double cost = errors[k] + lambda * static_cast<double>(bytes);
    if (cost < least) {
      least = cost;
      best = k;
    }
  }
  return best;
}

std::vector<int> Descend(const TermCosts& costs, const VertexRings& rings, double lambda,
                         std::vector<int> terms) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool changed = false;
    for (int v = 0; v < static_cast<int>(terms.size()); ++v) {
      const int best = BestTerms(costs, rings, v, lambda, terms);
      changed = changed || best != terms[v];
      terms[v] = best;
    }
    if (!changed) break;
  }
  return terms;
}

enum class Wanted { kFewestTerms, kMostTerms };

// The fewest or the most terms, as lambda goes, that `fits`.
template <typename Fits>
std::vector<int> Search(const TermCosts& costs, Wanted wanted, const std::vector<int>& fallback,
                        const Fits& fits) {
  const VertexRings rings = ComputeVertexRings(costs.mesh);
  const std::vector<int> all = AllTerms(costs);
  double energy = 0;
  for (const auto& errors : costs.squared_errors) energy += errors.front();
  if (!(energy > 0)) return std::vector<int>(all.size(), 0);
  // A term may at most take all energy for one byte, and must at least be worth rounding errors.
  double high = std::log(energy), low = std::log(energy * 1e-16);
  std::vector<int> best = fallback;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = (low + high) / 2;
    const std::vector<int> terms = Descend(costs, rings, std::exp(middle), all);
    const bool fitting = fits(terms);
    if (fitting) best = terms;
    (fitting == (wanted == Wanted::kFewestTerms) ? low : high) = middle;
  }
  return best;
}

}  // namespace

double TermCosts::SquaredError(const std::vector<int>& terms) const {
  double sum = 0;
  for (size_t v = 0; v < terms.size(); ++v) sum += squared_errors[v][terms[v]];
  return sum;
}

int64_t TermCosts::Bytes(const std::vector<int>& terms) const {
  int64_t bytes = 0;
  for (const int k : terms) bytes += k * view_bytes;
  for (size_t t = 0; t < patch_bytes.size(); ++t) {
    bytes += MostTerms(mesh.triangles[t], terms) * patch_bytes[t];
  }
  return bytes;
}

std::vector<int> AllTerms(const TermCosts& costs) {
  std::vector<int> terms;
  for (const auto& errors : costs.squared_errors) {
    terms.push_back(static_cast<int>(errors.size()) - 1);
  }
  return terms;
}

std::vector<int> TermsForTolerance(const TermCosts& costs, double rms) {
  std::vector<int> terms;
  for (size_t v = 0; v < costs.entries.size(); ++v) {
    const std::vector<double>& errors = costs.squared_errors[v];
    const double allowed = rms * rms * static_cast<double>(costs.entries[v]);
    int k = 0;
    while (k + 1 < static_cast<int>(errors.size()) && errors[k] > allowed) ++k;
    terms.push_back(k);
  }
  return terms;
}

std::vector<int> TermsForLambda(const TermCosts& costs, double lambda) {
  return Descend(costs, ComputeVertexRings(costs.mesh), lambda, AllTerms(costs));
}

std::vector<int> TermsForGain(const TermCosts& costs, double rms) {
  const auto sum = [](const std::vector<int64_t>& values) {
    return static_cast<double>(std::accumulate(values.begin(), values.end(), int64_t{0}));
  };
  const auto vertices = static_cast<double>(costs.entries.size());
  const double bytes = vertices * static_cast<double>(costs.view_bytes) + sum(costs.patch_bytes);
  return TermsForLambda(costs, bytes > 0 ? rms * rms * sum(costs.entries) / bytes : 0);
}

std::vector<int> TermsForError(const TermCosts& costs, double squared_error) {
  return Search(costs, Wanted::kFewestTerms, AllTerms(costs), [&](const std::vector<int>& terms) {
    return costs.SquaredError(terms) <= squared_error;
  });
}

std::vector<int> TermsForBytes(const TermCosts& costs, int64_t bytes) {
  return Search(costs, Wanted::kMostTerms, std::vector<int>(costs.entries.size(), 0),
                [&](const std::vector<int>& terms) { return costs.Bytes(terms) <= bytes; });
}

}  // namespace lfm
