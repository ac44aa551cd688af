// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cpca.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "planted_rows.h"

namespace lfm {
namespace {

Field PlantedPicture(int channels) {
  Field field;
  field.name = "planted";
  field.points = 64;
  field.channels = channels;
  field.width = field.height = 8;
  field.functions = PlantedRows(4, 16 * channels, 2, 30, 1);
  field.functions.rows = 64 * channels;
  return field;
}

TEST(Cpca, EveryDivisionHoldsItsShareOfTheEnergy) {
  for (const int channels : {1, 3}) {
    const Field field = PlantedPicture(channels);
    for (const CpcaDivision division : {CpcaDivision::kAdaptive, CpcaDivision::kFixed,
                                        CpcaDivision::kBlocks, CpcaDivision::kQuadtree}) {
      const CpcaResult result = EncodeClusteredPca(
          field, {.division = division, .energy_percent = 99.999, .clusters = 4, .block = 4});
      CheckModel(result.model);
      EXPECT_LT(RelativeError(result.model, field.functions.View(), -1), 1e-3);
      EXPECT_EQ(result.cost.pixels, 64 * channels);
      EXPECT_EQ(result.global_terms, 8);
      EXPECT_NEAR(result.cost.Total(), CostOf(result.sizes, 8).Total(), 1e-9);
    }
  }
}

TEST(Cpca, HasNoMoreTermsThanAllowed) {
  const CpcaResult result = EncodeClusteredPca(
      PlantedPicture(1), {.division = CpcaDivision::kFixed, .max_terms = 1, .clusters = 2});
  for (const PatchSize& size : result.sizes) EXPECT_EQ(size.terms, 1);
}

TEST(Cpca, BlackRowsStoreNothing) {
  for (const CpcaDivision division : {CpcaDivision::kAdaptive, CpcaDivision::kFixed}) {
    for (const int min_rows : {1, 7}) {
      const Field lit = PlantedPicture(1);
      Field field = lit;
      field.points = 320;
      field.width = 40;
      field.functions = MakeFunctionRows(320, lit.functions.columns);
      for (int64_t r = 0; r < 64; ++r) {
        std::copy_n(lit.functions.Row(r), lit.functions.columns, field.functions.Row(5 * r));
      }
      const CpcaOptions options = {.division = division, .clusters = 4, .min_rows = min_rows};
      const ClusteredModel alone = EncodeClusteredPca(lit, options).model;
      const ClusteredModel with_black = EncodeClusteredPca(field, options).model;
      CheckModel(with_black);
      EXPECT_EQ(with_black.weights, alone.weights);
      EXPECT_EQ(with_black.Terms(1), 0);
    }
  }
}

TEST(Cpca, TooManyBlocksAreRefusedBeforeTheyAreMade) {
  Field field;
  field.name = "large";
  field.width = field.height = 300;
  field.points = 90000;
  field.functions = MakeFunctionRows(90000, 1);
  try {
    EncodeClusteredPca(field, {.division = CpcaDivision::kBlocks, .block = 1});
    FAIL() << "90000 clusters were made";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--cpca-block"), std::string::npos);
  }
}

TEST(Cpca, HoldsExtremesAndRejectsNonsense) {
  Field none;
  none.functions = MakeFunctionRows(0, 4);
  EXPECT_EQ(EncodeClusteredPca(none, {}).model.rows, 0);
  Field vertices = PlantedPicture(1);
  vertices.width = vertices.height = 0;
  EXPECT_THROW(EncodeClusteredPca(vertices, {.division = CpcaDivision::kBlocks}), Error);
  EXPECT_NO_THROW(EncodeClusteredPca(vertices, {}));
  EXPECT_THROW(EncodeClusteredPca(vertices, {.energy_percent = 101}), Error);
  EXPECT_THROW(EncodeClusteredPca(vertices, {.clusters = 0}), Error);
  vertices.points = 63;
  EXPECT_THROW(EncodeClusteredPca(vertices, {}), Error);
  Field bad = PlantedPicture(1);
  bad.functions.Row(3)[4] = -INFINITY;
  EXPECT_THROW(EncodeClusteredPca(bad, {}), Error);
  Field black = PlantedPicture(1);
  std::fill(black.functions.values.begin(), black.functions.values.end(), 0.0f);
  EXPECT_EQ(EncodeClusteredPca(black, {}).cost.Total(), 0);
  EXPECT_EQ(EncodeClusteredPca(black, {.division = CpcaDivision::kQuadtree}).cost.Total(), 0);
}

}  // namespace
}  // namespace lfm
