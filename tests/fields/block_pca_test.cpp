// SPDX-License-Identifier: BSD-3-Clause
#include "fields/block_pca.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

// A picture of 16 x 16 whose left half and lower right quarter are of one function, with noise of
// 40 directions in the upper right quarter.
FunctionRows Picture() {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  FunctionRows rows = MakeFunctionRows(256, 40);
  for (int i = 0; i < 256; ++i) {
    const bool noisy = i % 16 >= 8 && i / 16 < 8;
    for (int j = 0; j < 40; ++j) rows.Row(i)[j] = noisy ? normal(random) : 1.0f + 0.1f * j;
  }
  return rows;
}

TEST(BlockPca, BlocksOfOneSizeAreCutAtTheEdge) {
  const FunctionRows rows = Picture();
  const RowsOfPicture picture = OccupiedPixels(rows.View(), 16, 16);
  const BlockDivision division =
      FixedBlocks(rows.View(), picture, 6, {.energy_share = 0.9999, .global_terms = 10});
  ASSERT_EQ(division.blocks.size(), 9u);
  EXPECT_EQ(division.blocks[0].size.pixels, 36);
  EXPECT_EQ(division.blocks[0].size.terms, 1);
  EXPECT_EQ(division.blocks[8].size.pixels, 16);
  EXPECT_EQ(division.cost.pixels, 256);
  // n (p + N) of the first block, noise in part of the second.
  EXPECT_EQ(division.clustering.cluster[5 * 16 + 5], 0);
  EXPECT_EQ(division.clustering.cluster[15 * 16 + 15], 8);
}

TEST(BlockPca, TheQuadtreeFollowsThePicture) {
  const FunctionRows rows = Picture();
  const RowsOfPicture picture = OccupiedPixels(rows.View(), 16, 16);
  for (const QuadtreeRule rule : {QuadtreeRule::kWhilePaying, QuadtreeRule::kCheapest}) {
    const BlockDivision division = DivideBlocks(
        rows.View(), picture,
        {.largest = 16, .rule = rule, .blocks = {.energy_share = 0.9999, .global_terms = 2}});
    int flat = 0, noisy = 0;
    for (const Block& block : division.blocks) {
      if (block.x >= 8 && block.y < 8) {
        ++noisy;
        EXPECT_EQ(block.side, 1);  // n = p: down to single pixels
      } else {
        ++flat;
        EXPECT_EQ(block.side, 8);  // n = 1: no further
        EXPECT_EQ(block.size.terms, 1);
      }
    }
    EXPECT_EQ(flat, 3);
    EXPECT_EQ(noisy, 64);
    EXPECT_EQ(division.cost.Total(), 3 * (64 + 2) + 64 * (1 + 2));
  }
}

// Equal pixels in every second square: the first division does not pay, but what follows does.
TEST(BlockPca, TheCheapestQuadtreeLooksBehindADearDivision) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  FunctionRows rows = MakeFunctionRows(64, 30);
  std::vector<std::vector<float>> functions(4, std::vector<float>(30));
  for (auto& function : functions) {
    for (float& value : function) value = normal(random);
  }
  // Quarters of 4 x 4 all hold the same four functions, one in each of their quarters.
  for (int i = 0; i < 64; ++i) {
    const int x = i % 8, y = i / 8;
    std::copy_n(functions[y % 4 / 2 * 2 + x % 4 / 2].data(), 30, rows.Row(i));
  }
  const RowsOfPicture picture = OccupiedPixels(rows.View(), 8, 8);
  QuadtreeOptions options = {.largest = 8,
                             .blocks = {.energy_share = 0.999999, .global_terms = 17}};
  // c = 4 (64 + 17) = 324; quarters 4 x 4 (16 + 17) = 528; sixteenths 16 (4 + 17) = 336.
  EXPECT_EQ(DivideBlocks(rows.View(), picture, options).blocks.size(), 1u);
  options.rule = QuadtreeRule::kCheapest;
  EXPECT_EQ(DivideBlocks(rows.View(), picture, options).blocks.size(), 1u);
  options.blocks.global_terms = 15;  // 316, 496, 16 (4 + 15) = 304
  const BlockDivision cheapest = DivideBlocks(rows.View(), picture, options);
  EXPECT_EQ(cheapest.blocks.size(), 16u);
  EXPECT_EQ(cheapest.cost.Total(), 304);
  options.rule = QuadtreeRule::kWhilePaying;
  EXPECT_EQ(DivideBlocks(rows.View(), picture, options).cost.Total(), 316);
}

TEST(BlockPca, BlackPixelsAreNoPixels) {
  FunctionRows rows = Picture();
  for (int i = 0; i < 256; ++i) {
    if (i % 16 < 8) std::fill_n(rows.Row(i), 40, 0.0f);
  }
  const RowsOfPicture picture = OccupiedPixels(rows.View(), 16, 16);
  const BlockDivision division = FixedBlocks(rows.View(), picture, 8, {.global_terms = 5});
  EXPECT_EQ(division.blocks.size(), 2u);
  EXPECT_EQ(division.cost.pixels, 128);
  EXPECT_EQ(division.clustering.clusters, 3);
  EXPECT_EQ(division.clustering.cluster[0], 2);
  const ClusteredModel model = ModelOfClusters(rows.View(), division.clustering, {});
  EXPECT_EQ(model.bases[2].rows, 0);
}

TEST(BlockPca, HoldsExtremes) {
  const BlockOptions options = {.global_terms = 5};
  const FunctionRows black = MakeFunctionRows(6, 4), none = MakeFunctionRows(0, 4);
  EXPECT_EQ(FixedBlocks(black.View(), OccupiedPixels(black.View(), 3, 2), 2, options).blocks.size(),
            0u);
  EXPECT_EQ(DivideBlocks(none.View(), OccupiedPixels(none.View(), 0, 0), {}).cost.Total(), 0);
  FunctionRows pixel = MakeFunctionRows(1, 1);
  pixel.Row(0)[0] = 1e25f;
  const BlockDivision one = DivideBlocks(pixel.View(), OccupiedPixels(pixel.View(), 1, 1),
                                         {.largest = 8, .blocks = options});
  EXPECT_EQ(one.cost.Total(), 1 + 5);
}

TEST(BlockPca, DoesNotDependOnTheNumberOfThreads) {
  const FunctionRows rows = Picture();
  const RowsOfPicture picture = OccupiedPixels(rows.View(), 16, 16);
  const QuadtreeOptions options = {.largest = 4, .blocks = {.energy_share = 0.95}};
  SetThreadCount(1);
  const BlockDivision one = DivideBlocks(rows.View(), picture, options);
  SetThreadCount(3);
  EXPECT_EQ(DivideBlocks(rows.View(), picture, options).clustering.cluster, one.clustering.cluster);
  SetThreadCount(0);
}

TEST(BlockPca, RejectsNonsense) {
  const FunctionRows rows = Picture();
  const RowsOfPicture picture = OccupiedPixels(rows.View(), 16, 16);
  EXPECT_THROW(OccupiedPixels(rows.View(), 16, 15), Error);
  EXPECT_THROW(FixedBlocks(rows.View(), picture, 0, {}), Error);
  EXPECT_THROW(FixedBlocks(rows.View(), picture, 4, {.energy_share = 2}), Error);
  EXPECT_THROW(DivideBlocks(rows.View(), picture, {.largest = 12}), Error);
  RowsOfPicture beyond = picture;
  beyond.row[7] = 256;
  EXPECT_THROW(FixedBlocks(rows.View(), beyond, 4, {}), Error);
}

}  // namespace
}  // namespace lfm
