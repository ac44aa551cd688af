// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

// A patch that keeps every sample; its mean view costs nothing.
PatchCosts Whole(int64_t bytes) { return {{bytes}, {0}, {0}, {}}; }

// These terms, every sample of them.
MapSelection Terms(const TriangleMesh& mesh, const std::vector<int>& terms) {
  MapSelection maps{terms, {}, {}};
  for (const Eigen::Vector3i& t : mesh.triangles) {
    maps.levels.emplace_back(1 + std::max({terms[t[0]], terms[t[1]], terms[t[2]]}), uint8_t{0});
  }
  for (const int own : terms) maps.view_levels.emplace_back(own, uint8_t{0});
  return maps;
}

// The choices of three vertices.
struct OneTriangle {
  TriangleMesh mesh;
  OneTriangle() {
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
  }
  MapCosts Costs(std::vector<std::vector<double>> errors, int64_t patch = 10,
                 int64_t view = 5) const {
    return {mesh, std::move(errors), {100, 100, 100}, {Whole(patch)}, {view}, {}};
  }
};

// Falling errors of 2562 vertices, some convex in the number of terms and some not.
MapCosts RandomCosts(const TriangleMesh& mesh, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  MapCosts costs{mesh, {}, {}, {}, {192}, {}};
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    std::vector<double> errors = {std::exp(6 * share(random))};
    const int most = static_cast<int>(random() % 6);
    for (int k = 0; k < most; ++k) errors.push_back(errors.back() * share(random));
    costs.squared_errors.push_back(errors);
    costs.entries.push_back(1000 + static_cast<int64_t>(random() % 1000));
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    costs.patches.push_back(Whole(30 + static_cast<int64_t>(random() % 300)));
  }
  return costs;
}

TEST(MapSelection, CountsWhatPatchesAndTilesTake) {
  const OneTriangle one;
  const MapCosts costs = one.Costs({{9, 4, 1}, {9, 4}, {9}});
  EXPECT_EQ(AllMaps(costs).terms, (std::vector<int>{2, 1, 0}));
  EXPECT_EQ(costs.Bytes(Terms(one.mesh, {2, 1, 0})), 2 * 10 + 3 * 5)
      << "a patch holds three corners";
  EXPECT_EQ(costs.Bytes(Terms(one.mesh, {0, 0, 0})), 0);
  EXPECT_DOUBLE_EQ(costs.SquaredError(Terms(one.mesh, {2, 1, 0})), 1 + 4 + 9);
}

TEST(MapSelection, ToleranceGivesEachVertexTheFewestTerms) {
  const OneTriangle one;
  const MapCosts costs = one.Costs({{9, 4, 1}, {0.5, 0.1, 0.01}, {9, 8, 7}});
  EXPECT_EQ(MapsForTolerance(costs, 0.2).terms, (std::vector<int>{1, 0, 2}));  // 4 = 0.2^2 * 100
  EXPECT_EQ(MapsForTolerance(costs, 1).terms, (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(MapsForTolerance(costs, 1e-9), AllMaps(costs));
}

// A vertex whose neighbour has a term already pays for its view map alone.
TEST(MapSelection, NeighboursShareWhatAPatchCosts) {
  const OneTriangle one;
  const MapCosts alone = one.Costs({{9, 2}, {0}, {0}});
  EXPECT_EQ(MapsForLambda(alone, 1).terms, (std::vector<int>{0, 0, 0})) << "7 for 15 bytes";
  const MapCosts beside = one.Costs({{9, 2}, {100, 0}, {0}});
  EXPECT_EQ(MapsForLambda(beside, 1).terms, (std::vector<int>{1, 1, 0})) << "7 for 5 bytes";
}

// Three vertices of 100 entries; a term takes 10 / 3 + 5 bytes on average.
TEST(MapSelection, AGainIsWeighedByTheBytesThatATermTakes) {
  const OneTriangle one;
  const MapCosts alike = one.Costs({{9, 5}, {9, 5}, {9, 5}});
  EXPECT_EQ(MapsForGain(alike, 0.19).terms, (std::vector<int>{1, 1, 1})) << "4 = 0.2^2 * 100";
  EXPECT_EQ(MapsForGain(alike, 0.3).terms, (std::vector<int>{0, 0, 0}));
  const MapCosts alone = one.Costs({{9, 5}, {0}, {0}});
  EXPECT_EQ(MapsForGain(alone, 0.19).terms, (std::vector<int>{0, 0, 0}))
      << "it pays the whole patch";
  EXPECT_EQ(MapsForGain(alone, 0.14).terms, (std::vector<int>{1, 0, 0}))
      << "15 bytes for those of 8.3";
  EXPECT_EQ(MapsForGain(alike, 0), AllMaps(alike));
}

TEST(MapSelection, LeapsOverATermThatBringsNothing) {
  const OneTriangle one;
  const MapCosts costs = one.Costs({{100, 100, 1}, {0}, {0}});
  EXPECT_EQ(MapsForLambda(costs, 1).terms, (std::vector<int>{2, 0, 0}));
}

TEST(MapSelection, IsAsGoodAsTryingEveryChoice) {
  const TriangleMesh mesh = MakeSphere(0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> error(0, 1000);
  double ratio = 0;
  constexpr int kTrials = 20;
  for (int trial = 0; trial < kTrials; ++trial) {
    MapCosts costs{mesh, {}, std::vector<int64_t>(mesh.vertices.size(), 10), {}, {40}, {}};
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      const double first = error(random);
      costs.squared_errors.push_back({first, first * error(random) / 1000});
    }
    costs.patches.assign(mesh.triangles.size(), Whole(20));
    const auto cost = [&](const MapSelection& maps) {
      return costs.SquaredError(maps) + 3 * static_cast<double>(costs.Bytes(maps));
    };
    double best = INFINITY;
    const auto vertices = static_cast<int>(mesh.vertices.size());
    for (int bits = 0; bits < 1 << vertices; ++bits) {
      std::vector<int> terms(vertices);
      for (int v = 0; v < vertices; ++v) terms[v] = bits >> v & 1;
      best = std::min(best, cost(Terms(mesh, terms)));
    }
    const double found = cost(MapsForLambda(costs, 3));
    EXPECT_GE(found, best - 1e-9);
    EXPECT_LE(found, 1.1 * best);
    ratio += found / best / kTrials;
  }
  EXPECT_LE(ratio, 1.01);
}

// Of two coarser levels the one is worth its loss, the other not; a second corner makes detail
// dearer to lose.
TEST(MapSelection, PatchesKeepWhatIsWorthItsBytes) {
  const OneTriangle one;
  MapCosts costs = one.Costs({{9, 0}, {9, 0}, {9}});
  costs.patches = {{{40, 12, 6}, {30, 20, 10}, {0, 1, 50}, {}}};
  costs.patches[0].term_errors = {0, 1, 5, 0, 2, 30, 0, 0, 0};
  const MapSelection cheap = MapsForLambda(costs, 0.3);
  EXPECT_EQ(cheap.terms, (std::vector<int>{1, 1, 0}));
  EXPECT_EQ(cheap.levels, (std::vector<std::vector<uint8_t>>{{1, 1}}));
  EXPECT_DOUBLE_EQ(costs.SquaredError(cheap), 9 + 1 + 1 + 2);
  EXPECT_EQ(costs.Bytes(cheap), 20 + 12 + 2 * 5);
  EXPECT_EQ(MapsForLambda(costs, 0.05).levels, (std::vector<std::vector<uint8_t>>{{0, 0}}));
  EXPECT_EQ(MapsForLambda(costs, 0), AllMaps(costs));
  EXPECT_DOUBLE_EQ(costs.patches[0].TermCost(0, 1, 1), 6 + 5) << "one corner alone: the coarsest";
  EXPECT_DOUBLE_EQ(costs.patches[0].TermCost(0, 3, 1), 12 + 3);
  EXPECT_EQ(costs.patches[0].TermCost(0, 0, 1), 0);
  const MapSelection least = MapsForBytes(costs, 1);
  EXPECT_EQ(least.levels, (std::vector<std::vector<uint8_t>>{{2}}));
}

// With levels, too, coordinate descent is near the best of every choice of terms and levels.
TEST(MapSelection, LevelsAreAsGoodAsTryingEveryChoice) {
  const TriangleMesh mesh = MakeSphere(0);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> error(0, 1000);
  for (int trial = 0; trial < 10; ++trial) {
    MapCosts costs{mesh, {}, std::vector<int64_t>(mesh.vertices.size(), 10), {}, {40}, {}};
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      const double first = error(random);
      costs.squared_errors.push_back({first, first * error(random) / 1000});
    }
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      PatchCosts patch{{20, 5}, {20, 5}, {0, error(random) / 10}, {}};
      for (int c = 0; c < 3; ++c) {
        patch.term_errors.push_back(0);
        patch.term_errors.push_back(static_cast<float>(error(random) / 10));
      }
      costs.patches.push_back(patch);
    }
    const auto cost = [&](const MapSelection& maps) {
      return costs.SquaredError(maps) + 3 * static_cast<double>(costs.Bytes(maps));
    };
    // Given the terms, each triangle's levels are independent of the others'.
    double best = INFINITY;
    const auto vertices = static_cast<int>(mesh.vertices.size());
    for (int bits = 0; bits < 1 << vertices; ++bits) {
      std::vector<int> terms(vertices);
      for (int v = 0; v < vertices; ++v) terms[v] = bits >> v & 1;
      MapSelection maps = Terms(mesh, terms);
      for (auto& levels : maps.levels) {
        for (uint8_t& level : levels) {
          const double fine = cost(maps);
          level = 1;
          if (cost(maps) > fine) level = 0;
        }
      }
      best = std::min(best, cost(maps));
    }
    const double found = cost(MapsForLambda(costs, 3));
    EXPECT_GE(found, best * (1 - 1e-9));
    EXPECT_LE(found, 1.1 * best);
  }
}

// Tables hold an entry a vertex for every term that any vertex has.
TEST(MapSelection, ATermOfFewVerticesIsNotWorthItsTables) {
  const OneTriangle one;
  MapCosts costs = one.Costs({{100, 50, 30}, {100, 50, 49}, {100, 50}});
  EXPECT_EQ(MapsForLambda(costs, 1).terms, (std::vector<int>{2, 1, 1}));
  costs.rank_bytes = 20;
  EXPECT_EQ(MapsForLambda(costs, 1).terms, (std::vector<int>{1, 1, 1})) << "20 for 15 and 20 bytes";
  EXPECT_EQ(costs.Bytes(Terms(one.mesh, {2, 1, 1})), 2 * 20 + 2 * 10 + 4 * 5);
  costs.rank_bytes = 200;
  EXPECT_EQ(MapsForLambda(costs, 1).terms, (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(MapsForLambda(costs, 0), AllMaps(costs));
}

TEST(MapSelection, GridsGoByTheirOwnBytes) {
  const OneTriangle one;
  MapCosts costs = one.Costs({{90, 40}, {90, 40}, {90, 85}});
  costs.view_bytes = {20, 5};
  costs.view_errors = {{0, 3}, {0, 30}, {0, 1}};
  // At a price of 1: 15 bytes saved for 3, not for 30; the third vertex' term saves 5 - 1 for 5.
  const MapSelection maps = MapsForLambda(costs, 1);
  EXPECT_EQ(maps.terms, (std::vector<int>{1, 1, 0}));
  EXPECT_EQ(maps.view_levels, (std::vector<std::vector<uint8_t>>{{1}, {0}, {}}));
  EXPECT_EQ(costs.SquaredError(maps), 40 + 3 + 40 + 90);
  EXPECT_EQ(costs.Bytes(maps), 10 + 5 + 20);
  EXPECT_EQ(MapsForLambda(costs, 0.5).terms, (std::vector<int>{1, 1, 1}));
  EXPECT_EQ(AllMaps(costs).view_levels, (std::vector<std::vector<uint8_t>>{{0}, {0}, {0}}));
}

TEST(MapSelection, ASmallGridIsNoReasonForATerm) {
  const OneTriangle one;
  MapCosts costs = one.Costs({{90, 10}, {90, 10}, {90, 10}});
  const MapSelection before = MapsForGain(costs, 0.85);
  EXPECT_EQ(before.terms, (std::vector<int>{1, 1, 1}));
  costs.view_bytes = {5, 1};
  costs.view_errors = {{0, 0}, {0, 0}, {0, 0}};
  EXPECT_EQ(MapsForGain(costs, 0.85).terms, before.terms);
  EXPECT_EQ(MapsForGain(costs, 0.85).view_levels,
            (std::vector<std::vector<uint8_t>>{{1}, {1}, {1}}));
  EXPECT_EQ(MapsForGain(costs, 1.3).terms, (std::vector<int>{0, 0, 0}));
}

TEST(MapSelection, MoreTermsToChooseFromTakeNoMore) {
  const TriangleMesh mesh = MakeSphere(4);
  MapCosts costs = RandomCosts(mesh, 13);
  costs.rank_bytes = 20 * static_cast<int64_t>(mesh.vertices.size());
  for (const double share : {0.6, 0.3, 0.1}) {
    const double all = costs.SquaredError(AllMaps(costs));
    const double none = costs.SquaredError(MapsForBytes(costs, 0));
    const double allowed = all + share * (none - all);
    int64_t fewest = INT64_MAX;
    MapCosts capped = costs;
    for (const int most : {1, 2, 3, 5}) {
      for (size_t v = 0; v < mesh.vertices.size(); ++v) {
        const std::vector<double>& errors = costs.squared_errors[v];
        const size_t kept = std::min(errors.size(), static_cast<size_t>(most) + 1);
        capped.squared_errors[v].assign(errors.begin(), errors.begin() + static_cast<int>(kept));
      }
      const MapSelection maps = MapsForError(capped, allowed);
      if (costs.SquaredError(maps) > allowed) continue;  // too few terms for it
      EXPECT_LE(static_cast<double>(costs.Bytes(maps)), 1.02 * static_cast<double>(fewest))
          << most << " terms, " << share;
      fewest = std::min(fewest, costs.Bytes(maps));
    }
    EXPECT_LT(fewest, INT64_MAX);
  }
}

TEST(MapSelection, MeetsABudgetAsLaidOut) {
  const TriangleMesh mesh = MakeSphere(3);
  const MapCosts costs = RandomCosts(mesh, 3);
  const auto with_gaps = [&](const MapSelection& maps) { return costs.Bytes(maps) * 5 / 4; };
  const int64_t budget = costs.Bytes(AllMaps(costs)) / 2;
  const MapSelection maps = MapsForBytes(costs, budget, with_gaps);
  EXPECT_LE(with_gaps(maps), budget);
  EXPECT_GE(with_gaps(maps), 0.98 * static_cast<double>(budget));
}

TEST(MapSelection, MeetsABudgetAndBeatsEqualTermsAtIt) {
  const TriangleMesh mesh = MakeSphere(4);
  const MapCosts costs = RandomCosts(mesh, 7);
  for (const int fixed : {1, 2, 3}) {
    std::vector<int> few = AllMaps(costs).terms;
    for (int& k : few) k = std::min(k, fixed);
    const MapSelection equal = Terms(mesh, few);
    const MapSelection chosen = MapsForBytes(costs, costs.Bytes(equal));
    EXPECT_LE(costs.Bytes(chosen), costs.Bytes(equal));
    EXPECT_GE(costs.Bytes(chosen), 0.98 * static_cast<double>(costs.Bytes(equal)));
    EXPECT_LT(costs.SquaredError(chosen), 0.95 * costs.SquaredError(equal));
    const MapSelection reached = MapsForError(costs, costs.SquaredError(equal));
    EXPECT_LE(costs.SquaredError(reached), costs.SquaredError(equal));
    EXPECT_LT(static_cast<double>(costs.Bytes(reached)),
              0.95 * static_cast<double>(costs.Bytes(equal)));
  }
}

TEST(MapSelection, HoldsAtTheExtremes) {
  const TriangleMesh mesh = MakeSphere(1);
  const MapCosts costs = RandomCosts(mesh, 9);
  const MapSelection none = Terms(mesh, std::vector<int>(mesh.vertices.size(), 0));
  EXPECT_EQ(MapsForBytes(costs, 0), none);
  EXPECT_EQ(MapsForError(costs, 0), AllMaps(costs)) << "out of reach: all that there is";
  EXPECT_EQ(MapsForError(costs, 1e30), none);
  EXPECT_EQ(MapsForBytes(costs, int64_t{1} << 60), MapsForLambda(costs, 0));
  MapCosts dark = costs;
  for (auto& errors : dark.squared_errors) errors.assign(errors.size(), 0.0);
  EXPECT_EQ(MapsForBytes(dark, 1000), none);
  EXPECT_EQ(MapsForTolerance(dark, 0), none);
  MapCosts faint = costs, bright = costs;  // radiance from 1e-6 to 1e6
  for (auto& errors : faint.squared_errors) {
    for (double& e : errors) e *= 1e-12;
  }
  for (auto& errors : bright.squared_errors) {
    for (double& e : errors) e *= 1e12;
  }
  const int64_t budget = costs.Bytes(AllMaps(costs)) / 2;
  EXPECT_EQ(MapsForBytes(faint, budget), MapsForBytes(bright, budget));
}

}  // namespace
}  // namespace lfm::testing
