// SPDX-License-Identifier: BSD-3-Clause
#include "encode/term_selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

// The choices of three vertices.
struct OneTriangle {
  TriangleMesh mesh;
  OneTriangle() {
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
  }
  TermCosts Costs(std::vector<std::vector<double>> errors, int64_t patch = 10,
                  int64_t view = 5) const {
    return {mesh, std::move(errors), {100, 100, 100}, {patch}, view};
  }
};

// Falling errors of 2562 vertices, some convex in the number of terms and some not.
TermCosts RandomCosts(const TriangleMesh& mesh, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  TermCosts costs{mesh, {}, {}, {}, 192};
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    std::vector<double> errors = {std::exp(6 * share(random))};
    const int most = static_cast<int>(random() % 6);
    for (int k = 0; k < most; ++k) errors.push_back(errors.back() * share(random));
    costs.squared_errors.push_back(errors);
    costs.entries.push_back(1000 + static_cast<int64_t>(random() % 1000));
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    costs.patch_bytes.push_back(30 + static_cast<int64_t>(random() % 300));
  }
  return costs;
}

TEST(TermSelection, CountsWhatPatchesAndTilesTake) {
  const OneTriangle one;
  const TermCosts costs = one.Costs({{9, 4, 1}, {9, 4}, {9}});
  EXPECT_EQ(AllTerms(costs), (std::vector<int>{2, 1, 0}));
  EXPECT_EQ(costs.Bytes({2, 1, 0}), 2 * 10 + 3 * 5) << "a patch holds three corners";
  EXPECT_EQ(costs.Bytes({0, 0, 0}), 0);
  EXPECT_DOUBLE_EQ(costs.SquaredError({2, 1, 0}), 1 + 4 + 9);
}

TEST(TermSelection, ToleranceGivesEachVertexTheFewestTerms) {
  const OneTriangle one;
  const TermCosts costs = one.Costs({{9, 4, 1}, {0.5, 0.1, 0.01}, {9, 8, 7}});
  EXPECT_EQ(TermsForTolerance(costs, 0.2), (std::vector<int>{1, 0, 2}));  // 4 = 0.2^2 * 100
  EXPECT_EQ(TermsForTolerance(costs, 1), (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(TermsForTolerance(costs, 1e-9), AllTerms(costs));
}

// A vertex whose neighbour has a term already pays for its view map alone.
TEST(TermSelection, NeighboursShareWhatAPatchCosts) {
  const OneTriangle one;
  const TermCosts alone = one.Costs({{9, 2}, {0}, {0}});
  EXPECT_EQ(TermsForLambda(alone, 1), (std::vector<int>{0, 0, 0})) << "7 for 15 bytes";
  const TermCosts beside = one.Costs({{9, 2}, {100, 0}, {0}});
  EXPECT_EQ(TermsForLambda(beside, 1), (std::vector<int>{1, 1, 0})) << "7 for 5 bytes";
}

// Three vertices of 100 entries; a term takes 10 / 3 + 5 bytes on average.
TEST(TermSelection, AGainIsWeighedByTheBytesThatATermTakes) {
  const OneTriangle one;
  const TermCosts alike = one.Costs({{9, 5}, {9, 5}, {9, 5}});
  EXPECT_EQ(TermsForGain(alike, 0.19), (std::vector<int>{1, 1, 1})) << "4 = 0.2^2 * 100";
  EXPECT_EQ(TermsForGain(alike, 0.3), (std::vector<int>{0, 0, 0}));
  const TermCosts alone = one.Costs({{9, 5}, {0}, {0}});
  EXPECT_EQ(TermsForGain(alone, 0.19), (std::vector<int>{0, 0, 0})) << "it pays the whole patch";
  EXPECT_EQ(TermsForGain(alone, 0.14), (std::vector<int>{1, 0, 0})) << "15 bytes for those of 8.3";
  EXPECT_EQ(TermsForGain(alike, 0), AllTerms(alike));
}

TEST(TermSelection, LeapsOverATermThatBringsNothing) {
  const OneTriangle one;
  const TermCosts costs = one.Costs({{100, 100, 1}, {0}, {0}});
  EXPECT_EQ(TermsForLambda(costs, 1), (std::vector<int>{2, 0, 0}));
}

TEST(TermSelection, IsAsGoodAsTryingEveryChoice) {
  const TriangleMesh mesh = MakeSphere(0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> error(0, 1000);
  double ratio = 0;
  constexpr int kTrials = 20;
  for (int trial = 0; trial < kTrials; ++trial) {
    TermCosts costs{mesh, {}, std::vector<int64_t>(mesh.vertices.size(), 10), {}, 40};
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      const double first = error(random);
      costs.squared_errors.push_back({first, first * error(random) / 1000});
    }
    costs.patch_bytes.assign(mesh.triangles.size(), 20);
    const auto cost = [&](const std::vector<int>& terms) {
      return costs.SquaredError(terms) + 3 * static_cast<double>(costs.Bytes(terms));
    };
    double best = INFINITY;
    const auto vertices = static_cast<int>(mesh.vertices.size());
    for (int bits = 0; bits < 1 << vertices; ++bits) {
      std::vector<int> terms(vertices);
      for (int v = 0; v < vertices; ++v) terms[v] = bits >> v & 1;
      best = std::min(best, cost(terms));
    }
    const double found = cost(TermsForLambda(costs, 3));
    EXPECT_GE(found, best - 1e-9);
    EXPECT_LE(found, 1.1 * best);
    ratio += found / best / kTrials;
  }
  EXPECT_LE(ratio, 1.01);
}

TEST(TermSelection, MeetsABudgetAndBeatsEqualTermsAtIt) {
  const TriangleMesh mesh = MakeSphere(4);
  const TermCosts costs = RandomCosts(mesh, 7);
  for (const int fixed : {1, 2, 3}) {
    std::vector<int> equal = AllTerms(costs);
    for (int& k : equal) k = std::min(k, fixed);
    const std::vector<int> chosen = TermsForBytes(costs, costs.Bytes(equal));
    EXPECT_LE(costs.Bytes(chosen), costs.Bytes(equal));
    EXPECT_GE(costs.Bytes(chosen), 0.98 * static_cast<double>(costs.Bytes(equal)));
    EXPECT_LT(costs.SquaredError(chosen), 0.95 * costs.SquaredError(equal));
    const std::vector<int> reached = TermsForError(costs, costs.SquaredError(equal));
    EXPECT_LE(costs.SquaredError(reached), costs.SquaredError(equal));
    EXPECT_LT(static_cast<double>(costs.Bytes(reached)),
              0.95 * static_cast<double>(costs.Bytes(equal)));
  }
}

TEST(TermSelection, HoldsAtTheExtremes) {
  const TriangleMesh mesh = MakeSphere(1);
  const TermCosts costs = RandomCosts(mesh, 9);
  const std::vector<int> none(mesh.vertices.size(), 0);
  EXPECT_EQ(TermsForBytes(costs, 0), none);
  EXPECT_EQ(TermsForError(costs, 0), AllTerms(costs)) << "out of reach: all that there is";
  EXPECT_EQ(TermsForError(costs, 1e30), none);
  EXPECT_EQ(TermsForBytes(costs, int64_t{1} << 60), TermsForLambda(costs, 0));
  TermCosts dark = costs;
  for (auto& errors : dark.squared_errors) errors.assign(errors.size(), 0.0);
  EXPECT_EQ(TermsForBytes(dark, 1000), none);
  EXPECT_EQ(TermsForTolerance(dark, 0), none);
  TermCosts faint = costs, bright = costs;  // radiance from 1e-6 to 1e6
  for (auto& errors : faint.squared_errors) {
    for (double& e : errors) e *= 1e-12;
  }
  for (auto& errors : bright.squared_errors) {
    for (double& e : errors) e *= 1e12;
  }
  const int64_t budget = costs.Bytes(AllTerms(costs)) / 2;
  EXPECT_EQ(TermsForBytes(faint, budget), TermsForBytes(bright, budget));
}

}  // namespace
}  // namespace lfm::testing
