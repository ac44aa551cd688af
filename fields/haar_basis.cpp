// SPDX-License-Identifier: BSD-3-Clause
#include "fields/haar_basis.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

// A set of directions: its scaling coefficient stands in `column`.
struct Set {
  int column = 0, size = 1;
  Eigen::Vector3d direction;
};

struct Pair {
  double squared_distance = 0;
  int a = 0, b = 0;  // a < b
};

constexpr int kNeighbours = 6;

bool Closer(const Pair& x, const Pair& y) {
  if (x.squared_distance != y.squared_distance) return x.squared_distance < y.squared_distance;
  return x.a != y.a ? x.a < y.a : x.b < y.b;
}

// Of every set, the pairs with its nearest few.
std::vector<Pair> NearPairs(const std::vector<Set>& sets) {
  std::vector<std::vector<Pair>> of_set(sets.size());
  ParallelFor(
      0, static_cast<int64_t>(sets.size()),
      [&](int64_t i) {
        std::vector<Pair> all;
        for (int64_t j = 0; j < static_cast<int64_t>(sets.size()); ++j) {
          if (j == i) continue;
          all.push_back({(sets[i].direction - sets[j].direction).squaredNorm(),
                         static_cast<int>(std::min(i, j)), static_cast<int>(std::max(i, j))});
        }
        const size_t kept = std::min<size_t>(kNeighbours, all.size());
        std::partial_sort(all.begin(), all.begin() + static_cast<ptrdiff_t>(kept), all.end(),
                          Closer);
        all.resize(kept);
        of_set[i] = std::move(all);
      },
      16);
  std::vector<Pair> pairs;
  for (const auto& some : of_set) pairs.insert(pairs.end(), some.begin(), some.end());
  std::sort(pairs.begin(), pairs.end(), Closer);
  return pairs;
}

Set Merge(const Set& a, const Set& b) {
  const Eigen::Vector3d sum = a.size * a.direction + b.size * b.direction;
  const double length = sum.norm();
  return {a.column, a.size + b.size, length > 1e-9 ? Eigen::Vector3d(sum / length) : a.direction};
}

// Pairs the sets of one level; those left over go up alone.
std::vector<Set> PairLevel(const std::vector<Set>& sets, std::vector<HaarStep>& steps) {
  std::vector<char> taken(sets.size());
  std::vector<Set> next;
  for (const Pair& pair : NearPairs(sets)) {
    if (taken[pair.a] || taken[pair.b]) continue;
    taken[pair.a] = taken[pair.b] = 1;
    const Set &a = sets[pair.a], &b = sets[pair.b];
    const double both = a.size + b.size;
    steps.push_back({a.column, b.column, std::sqrt(a.size / both), std::sqrt(b.size / both)});
    next.push_back(Merge(a, b));
  }
  for (size_t i = 0; i < sets.size(); ++i) {
    if (!taken[i]) next.push_back(sets[i]);
  }
  return next;
}

void CheckColumns(const HaarBasis& basis, const FunctionRows& rows) {
  if (rows.columns == basis.columns) return;
  throw Error("haar basis: of " + std::to_string(basis.columns) +
              " directions, asked for rows of " + std::to_string(rows.columns));
}

}  // namespace

HaarBasis MakeHaarBasis(const std::vector<Eigen::Vector3d>& directions) {
  if (directions.empty()) throw Error("haar basis: no directions");
  HaarBasis basis;
  basis.columns = static_cast<int>(directions.size());
  std::vector<Set> sets;
  for (const Eigen::Vector3d& direction : directions) {
    if (!direction.allFinite()) throw Error("haar basis: a direction is not finite");
    sets.push_back({static_cast<int>(sets.size()), 1, direction});
  }
  while (sets.size() > 1) sets = PairLevel(sets, basis.steps);
  return basis;
}

FunctionRows ToHaar(const HaarBasis& basis, FunctionRows rows) {
  CheckColumns(basis, rows);
  ParallelChunks(rows.rows, 64, [&](int64_t begin, int64_t end, int64_t) {
    std::vector<double> c(static_cast<size_t>(basis.columns));
    for (int64_t r = begin; r < end; ++r) {
      std::copy_n(rows.Row(r), basis.columns, c.begin());
      for (const HaarStep& step : basis.steps) {
        const double p = c[step.mean], q = c[step.difference];
        c[step.mean] = step.cosine * p + step.sine * q;
        c[step.difference] = step.sine * p - step.cosine * q;
      }
      std::transform(c.begin(), c.end(), rows.Row(r), [](double v) { return float(v); });
    }
  });
  return rows;
}

FunctionRows FromHaar(const HaarBasis& basis, FunctionRows rows) {
  CheckColumns(basis, rows);
  ParallelChunks(rows.rows, 64, [&](int64_t begin, int64_t end, int64_t) {
    std::vector<double> c(static_cast<size_t>(basis.columns));
    for (int64_t r = begin; r < end; ++r) {
      std::copy_n(rows.Row(r), basis.columns, c.begin());
      for (auto step = basis.steps.rbegin(); step != basis.steps.rend(); ++step) {
        const double mean = c[step->mean], difference = c[step->difference];
        c[step->mean] = step->cosine * mean + step->sine * difference;
        c[step->difference] = step->sine * mean - step->cosine * difference;
      }
      std::transform(c.begin(), c.end(), rows.Row(r), [](double v) { return float(v); });
    }
  });
  return rows;
}

}  // namespace lfm
