// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/voxel_grid.h"

#include <gtest/gtest.h>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(VoxelGrid, EveryPointInItsCube) {
  const std::vector<Eigen::Vector3d> points = {
      {0, 0, 0}, {0.9, 0, 0}, {1.1, 0, 0}, {5, 5, 5}, {0.1, 0.1, 0.1}};
  const VoxelGrid grid = MakeVoxelGrid(points, 1);
  ASSERT_EQ(grid.cells.size(), 3u);
  EXPECT_EQ(grid.Count(0), 3);
  for (size_t v = 0; v < grid.cells.size(); ++v) {
    EXPECT_EQ(grid.Find(grid.cells[v]), static_cast<int>(v));
    for (int64_t k = grid.offsets[v]; k < grid.offsets[v + 1]; ++k) {
      EXPECT_EQ(grid.CellOf(points[grid.points[k]]), grid.cells[v]);
    }
  }
  EXPECT_EQ(grid.Find({2, 2, 2}), -1);
  EXPECT_EQ(grid.Find({-1, 0, 0}), -1);
}

TEST(VoxelGrid, NeighborhoodsAndPieces) {
  const VoxelGrid grid =
      MakeVoxelGrid({{0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}, {9.5, 0.5, 0.5}}, 1);
  EXPECT_EQ(CountNeighborhoods(grid), (std::vector<int64_t>{2, 3, 2, 1}));
  EXPECT_EQ(LabelPieces(grid), (std::vector<int>{0, 0, 0, 1}));
}

TEST(VoxelGrid, NoPoints) {
  const VoxelGrid grid = MakeVoxelGrid({}, 1);
  EXPECT_TRUE(grid.cells.empty());
  EXPECT_EQ(grid.Find({0, 0, 0}), -1);
  EXPECT_TRUE(LabelPieces(grid).empty());
}

TEST(VoxelGrid, TooWideIsAnError) {
  EXPECT_NE(test::ErrorOf([] { MakeVoxelGrid({{0, 0, 0}, {1e9, 0, 0}}, 1); }), "");
}

}  // namespace
}  // namespace lfm
