// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_selection.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <numeric>

namespace lfm {
namespace {

constexpr int kSweeps = 8;
constexpr int kBisections = 30;
constexpr double kNearby = 5;  // of the logarithm of lambda
constexpr int kSteps = 14;

// Bits of the corners of a triangle that have a term.
int CornersWith(const Eigen::Vector3i& corners, int term, const std::vector<int>& terms) {
  int bits = 0;
  for (int c = 0; c < 3; ++c) bits |= (terms[corners[c]] > term ? 1 : 0) << c;
  return bits;
}

int TermsOf(const Eigen::Vector3i& corners, const std::vector<int>& terms) {
  return std::max({terms[corners[0]], terms[corners[1]], terms[corners[2]]});
}

struct Price {
  double lambda = 0;         // squared error that a byte is worth
  bool whole_views = false;  // when terms are chosen, view maps count as those of the finest grid
  int most_terms = INT_MAX;  // of any vertex; where it is given, tables are paid for
};

// A vertex's choice when its neighbours keep theirs.
int BestTerms(const MapCosts& costs, const VertexRings& rings, int vertex, const Price& price,
              const std::vector<int>& terms) {
  const std::vector<double>& errors = costs.squared_errors[vertex];
  int best = 0;
  double maps = 0, least = errors[0];
  const int most = std::min(static_cast<int>(errors.size()) - 1, price.most_terms);
  for (int k = 1; k <= most; ++k) {
    for (int e = rings.offsets[vertex]; e < rings.offsets[vertex + 1]; ++e) {
      const Eigen::Vector3i& corners = costs.mesh.triangles[rings.triangles[e]];
      const PatchCosts& patch = costs.patches[rings.triangles[e]];
      const int own = corners[0] == vertex ? 1 : corners[1] == vertex ? 2 : 4;
      const int others = CornersWith(corners, k - 1, terms) & ~own;
      maps += patch.TermCost(k - 1, others | own, price.lambda) -
              patch.TermCost(k - 1, others, price.lambda);
    }
    const int grid = costs.BestViewGrid(vertex, k - 1, price.lambda);
    const int64_t view_bytes = costs.view_bytes[price.whole_views ? 0 : grid];
    maps += costs.ViewError(vertex, k - 1, grid) + price.lambda * static_cast<double>(view_bytes);
    const double cost = errors[k] + maps;
    if (cost < least) {
      least = cost;
      best = k;
    }
  }
  return best;
}

MapSelection WithLevels(const MapCosts& costs, std::vector<int> terms, double lambda) {
  MapSelection maps{std::move(terms), {}, {}};
  for (size_t t = 0; t < costs.patches.size(); ++t) {
    const Eigen::Vector3i& corners = costs.mesh.triangles[t];
    std::vector<uint8_t>& levels = maps.levels.emplace_back();
    levels.push_back(static_cast<uint8_t>(costs.patches[t].BestMeanLevel(lambda)));
    for (int k = 0; k < TermsOf(corners, maps.terms); ++k) {
      levels.push_back(static_cast<uint8_t>(
          costs.patches[t].BestTermLevel(k, CornersWith(corners, k, maps.terms), lambda)));
    }
  }
  for (size_t v = 0; v < maps.terms.size(); ++v) {
    std::vector<uint8_t>& grids = maps.view_levels.emplace_back();
    for (int k = 0; k < maps.terms[v]; ++k) {
      grids.push_back(static_cast<uint8_t>(costs.BestViewGrid(static_cast<int>(v), k, lambda)));
    }
  }
  return maps;
}

int64_t MostTerms(const std::vector<int>& terms) {
  return terms.empty() ? 0 : *std::max_element(terms.begin(), terms.end());
}

// Without the last term of all vertices, as long as that costs less than its tables.
MapSelection TrimRanks(const MapCosts& costs, MapSelection maps, double lambda) {
  const auto cost = [&](const MapSelection& some) {
    return costs.SquaredError(some) + lambda * static_cast<double>(costs.Bytes(some));
  };
  if (costs.rank_bytes == 0 || !(lambda > 0)) return maps;
  double least = cost(maps);
  for (int64_t most = MostTerms(maps.terms) - 1; most >= 0; --most) {
    std::vector<int> terms = maps.terms;
    for (int& own : terms) own = std::min(own, static_cast<int>(most));
    MapSelection fewer = WithLevels(costs, std::move(terms), lambda);
    const double now = cost(fewer);
    if (now > least) break;
    least = now;
    maps = std::move(fewer);
  }
  return maps;
}

MapSelection Descend(const MapCosts& costs, const VertexRings& rings, const Price& price,
                     std::vector<int> terms) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool changed = false;
    for (int v = 0; v < static_cast<int>(terms.size()); ++v) {
      const int best = BestTerms(costs, rings, v, price, terms);
      changed = changed || best != terms[v];
      terms[v] = best;
    }
    if (!changed) break;
  }
  MapSelection maps = WithLevels(costs, std::move(terms), price.lambda);
  if (price.most_terms < INT_MAX) return maps;
  return TrimRanks(costs, std::move(maps), price.lambda);
}

MapSelection NoTerms(const MapCosts& costs) {
  return WithLevels(costs, std::vector<int>(costs.entries.size(), 0), INFINITY);
}

enum class Wanted { kFewestBytes, kLeastError };

// The fewest or the most maps, as lambda goes, that `fits`.
template <typename Fits>
MapSelection Search(const MapCosts& costs, Wanted wanted, const MapSelection& fallback,
                    const Fits& fits) {
  const VertexRings rings = ComputeVertexRings(costs.mesh);
  const std::vector<int> all = AllMaps(costs).terms;
  double energy = 0;
  for (const auto& errors : costs.squared_errors) energy += errors.front();
  for (const PatchCosts& patch : costs.patches) energy += patch.mean_errors.back();
  if (!(energy > 0)) return NoTerms(costs);
  // A term may at most take all energy for one byte, and must at least be worth rounding errors.
  MapSelection best = fallback;
  const auto bisect = [&](double low, double high, int steps, int most_terms) {
    for (int i = 0; i < steps; ++i) {
      const double middle = (low + high) / 2;
      MapSelection maps = Descend(costs, rings, {std::exp(middle), false, most_terms}, all);
      const bool fitting = fits(maps);
      const bool better = wanted == Wanted::kFewestBytes
                              ? costs.Bytes(maps) < costs.Bytes(best)
                              : costs.SquaredError(maps) < costs.SquaredError(best);
      if (fitting && (better || !fits(best))) best = std::move(maps);
      (fitting == (wanted == Wanted::kFewestBytes) ? low : high) = middle;
    }
    return low;
  };
  const double low = std::log(energy * 1e-16);
  const double found = bisect(low, std::log(energy), kBisections, INT_MAX);
  // Whether the last term of all is worth its tables is decided at once for a lambda, so that sizes
  // leap there: with the terms given they do not.
  const auto most = static_cast<int>(MostTerms(best.terms));
  for (const int terms : {most, most + 1}) bisect(found - kNearby, found + kNearby, kSteps, terms);
  return best;
}

}  // namespace

double PatchCosts::TermError(int term, int corners, int level) const {
  if (level == 0) return 0;
  double error = 0;
  for (int c = 0; c < 3; ++c) {
    if ((corners >> c & 1) == 0) continue;
    const size_t at = (size_t{3} * term + c) * term_bytes.size() + level;
    error += term_errors[at];
  }
  return error;
}

int PatchCosts::BestMeanLevel(double lambda) const {
  if (lambda == INFINITY) return levels() - 1;
  int best = 0;
  const auto cost = [&](int level) {
    return mean_errors[level] + lambda * static_cast<double>(mean_bytes[level]);
  };
  for (int level = 1; level < levels(); ++level) {
    if (cost(level) < cost(best)) best = level;
  }
  return best;
}

int PatchCosts::BestTermLevel(int term, int corners, double lambda) const {
  if (lambda == INFINITY) return levels() - 1;
  int best = 0;
  const auto cost = [&](int level) {
    return TermError(term, corners, level) + lambda * static_cast<double>(term_bytes[level]);
  };
  for (int level = 1; level < levels(); ++level) {
    if (cost(level) < cost(best)) best = level;
  }
  return best;
}

double PatchCosts::TermCost(int term, int corners, double lambda) const {
  if (corners == 0) return 0;
  const int level = BestTermLevel(term, corners, lambda);
  return TermError(term, corners, level) + lambda * static_cast<double>(term_bytes[level]);
}

int MapCosts::BestViewGrid(int vertex, int term, double lambda) const {
  int best = 0;
  const auto cost = [&](int grid) {
    return ViewError(vertex, term, grid) + lambda * static_cast<double>(view_bytes[grid]);
  };
  for (int grid = 1; grid < grids(); ++grid) {
    if (cost(grid) < cost(best)) best = grid;
  }
  return best;
}

double MapCosts::SquaredError(const MapSelection& maps) const {
  double sum = 0;
  for (size_t v = 0; v < maps.terms.size(); ++v) {
    sum += squared_errors[v][maps.terms[v]];
    for (int k = 0; k < maps.terms[v]; ++k) {
      sum += ViewError(static_cast<int>(v), k, maps.view_levels[v][k]);
    }
  }
  for (size_t t = 0; t < patches.size(); ++t) {
    const std::vector<uint8_t>& levels = maps.levels[t];
    sum += patches[t].mean_errors[levels[0]];
    for (int k = 0; k + 1 < static_cast<int>(levels.size()); ++k) {
      sum += patches[t].TermError(k, CornersWith(mesh.triangles[t], k, maps.terms), levels[k + 1]);
    }
  }
  return sum;
}

int64_t MapCosts::Bytes(const MapSelection& maps) const {
  int64_t bytes = MostTerms(maps.terms) * rank_bytes;
  for (const auto& grids : maps.view_levels) {
    for (const uint8_t grid : grids) bytes += view_bytes[grid];
  }
  for (size_t t = 0; t < patches.size(); ++t) {
    const std::vector<uint8_t>& levels = maps.levels[t];
    bytes += patches[t].mean_bytes[levels[0]];
    for (size_t k = 1; k < levels.size(); ++k) bytes += patches[t].term_bytes[levels[k]];
  }
  return bytes;
}

MapSelection AllMaps(const MapCosts& costs) {
  std::vector<int> terms;
  for (const auto& errors : costs.squared_errors) {
    terms.push_back(static_cast<int>(errors.size()) - 1);
  }
  return WithLevels(costs, std::move(terms), 0);
}

MapSelection MapsForTolerance(const MapCosts& costs, double rms) {
  std::vector<int> terms;
  for (size_t v = 0; v < costs.entries.size(); ++v) {
    const std::vector<double>& errors = costs.squared_errors[v];
    const double allowed = rms * rms * static_cast<double>(costs.entries[v]);
    int k = 0;
    while (k + 1 < static_cast<int>(errors.size()) && errors[k] > allowed) ++k;
    terms.push_back(k);
  }
  return WithLevels(costs, std::move(terms), 0);
}

MapSelection MapsForLambda(const MapCosts& costs, double lambda) {
  return Descend(costs, ComputeVertexRings(costs.mesh), {lambda}, AllMaps(costs).terms);
}

MapSelection MapsForGain(const MapCosts& costs, double rms) {
  const auto vertices = static_cast<double>(costs.entries.size());
  double bytes = vertices * static_cast<double>(costs.view_bytes.front());
  for (const PatchCosts& patch : costs.patches) {
    bytes += static_cast<double>(patch.term_bytes.front());
  }
  const auto entries =
      static_cast<double>(std::accumulate(costs.entries.begin(), costs.entries.end(), int64_t{0}));
  const Price price{bytes > 0 ? rms * rms * entries / bytes : 0, true};
  return Descend(costs, ComputeVertexRings(costs.mesh), price, AllMaps(costs).terms);
}

MapSelection MapsForError(const MapCosts& costs, double squared_error) {
  return Search(costs, Wanted::kFewestBytes, AllMaps(costs), [&](const MapSelection& maps) {
    return costs.SquaredError(maps) <= squared_error;
  });
}

MapSelection MapsForBytes(const MapCosts& costs, int64_t bytes,
                          const std::function<int64_t(const MapSelection&)>& bytes_of) {
  const auto fits = [&](const MapSelection& maps) {
    return (bytes_of ? bytes_of(maps) : costs.Bytes(maps)) <= bytes;
  };
  MapSelection least = NoTerms(costs);
  return fits(least) ? Search(costs, Wanted::kLeastError, least, fits) : least;
}

}  // namespace lfm
