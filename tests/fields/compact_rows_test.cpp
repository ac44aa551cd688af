// SPDX-License-Identifier: BSD-3-Clause
#include "fields/compact_rows.h"

#include <gtest/gtest.h>

#include "fields/matrix_products.h"
#include "planted_rows.h"

namespace lfm {
namespace {

TEST(CompactRows, KeepDistancesAndDimensionalities) {
  const FunctionRows rows = PlantedRows(3, 40, 4, 90, 1);
  const CompactRows compact = CompactedRows(rows.View(), RowEnergies(rows.View()), 1e-6);
  EXPECT_EQ(compact.coordinates.columns, 12);
  const Eigen::MatrixXd truth = GramOfRows(rows.View());
  EXPECT_LT((GramOfRows(compact.coordinates.View()) - truth).norm(), 1e-5 * truth.norm());
  EXPECT_NEAR(compact.Energy(), EnergyOf(rows.View()), 1e-9 * compact.Energy());
  for (const double share : {0.5, 0.9, 0.99, 0.999}) {
    EXPECT_EQ(TermsNeeded(compact, share), TermsNeeded(rows.View(), share));
  }
}

TEST(CompactRows, CountAgainstTheFullEnergyAfterLosses) {
  const FunctionRows rows = PlantedRows(1, 60, 30, 64, 2);
  const CompactRows lossy = CompactedRows(rows.View(), RowEnergies(rows.View()), 0.05);
  EXPECT_LT(lossy.coordinates.columns, 30);
  EXPECT_GT(EnergyOf(lossy.coordinates.View()), 0.95 * lossy.Energy());
  EXPECT_EQ(TermsNeeded(lossy, 0.9), TermsNeeded(rows.View(), 0.9));
  // What was lost cannot be found again: all coordinates.
  EXPECT_EQ(TermsNeeded(lossy, 0.9999), lossy.coordinates.columns);
}

TEST(CompactRows, PartsAreTheRowsThemselves) {
  const FunctionRows rows = PlantedRows(2, 20, 3, 40, 3);
  const CompactRows compact = CompactedRows(rows.View(), RowEnergies(rows.View()), 1e-6);
  std::vector<int64_t> odd;
  for (int64_t row = 1; row < 40; row += 2) odd.push_back(row);
  const CompactRows part = PartOf(compact, odd);
  EXPECT_EQ(TermsNeeded(part, 0.9999), 3);
  EXPECT_NEAR(part.Energy(), EnergyOf(GatherRows(rows.View(), odd).View()), 1e-6 * part.Energy());
}

TEST(CompactRows, OfBlackRowsNeedNothing) {
  const FunctionRows black = MakeFunctionRows(3, 7);
  const CompactRows compact = CompactedRows(black.View(), RowEnergies(black.View()), 1e-3);
  EXPECT_EQ(compact.coordinates.rows, 3);
  EXPECT_EQ(TermsNeeded(compact, 0.999), 0);
}

}  // namespace
}  // namespace lfm
