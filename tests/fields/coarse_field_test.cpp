// SPDX-License-Identifier: BSD-3-Clause
#include "fields/coarse_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "core/error.h"

namespace lfm {
namespace {

Field Picture(int width, int height, int channels) {
  Field field;
  field.name = "made";
  field.points = int64_t{width} * height;
  field.channels = channels;
  field.width = width;
  field.height = height;
  field.functions = MakeFunctionRows(field.points * channels, 2);
  for (int64_t r = 0; r < field.functions.rows; ++r) {
    field.functions.Row(r)[0] = static_cast<float>(r);
    field.functions.Row(r)[1] = 1;
  }
  return field;
}

std::set<int32_t> Neighbours(const CoarseField& coarse, int64_t cell) {
  return {coarse.neighbours.begin() + coarse.first[cell],
          coarse.neighbours.begin() + coarse.first[cell + 1]};
}

TEST(CoarseField, AveragesSquaresOfPixels) {
  const CoarseField coarse = MakeCoarseField(Picture(5, 3, 2), 2);
  ASSERT_EQ(coarse.cells, 6);  // 3 x 2
  ASSERT_EQ(coarse.rows.rows, 12);
  EXPECT_FLOAT_EQ(coarse.rows.Row(0)[0], (0 + 1 + 5 + 6) / 4.0f);
  EXPECT_FLOAT_EQ(coarse.rows.Row(2)[0], (4 + 9) / 2.0f);
  EXPECT_FLOAT_EQ(coarse.rows.Row(5)[0], 14);
  EXPECT_FLOAT_EQ(coarse.rows.Row(6 + 5)[0], 15 + 14);
  for (int64_t r = 0; r < 12; ++r) EXPECT_FLOAT_EQ(coarse.rows.Row(r)[1], 1);
  EXPECT_EQ(coarse.cell[7], 1);
  EXPECT_EQ(coarse.cell[13], 4);
  EXPECT_EQ(coarse.neighbours[coarse.first[4]], 4);
  EXPECT_EQ(Neighbours(coarse, 4), (std::set<int32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(Neighbours(coarse, 0), (std::set<int32_t>{0, 1, 3, 4}));
}

TEST(CoarseField, GathersVerticesInCubes) {
  Field field;
  field.name = "made";
  field.points = 400;
  field.functions = MakeFunctionRows(400, 1);
  for (int i = 0; i < 400; ++i) {
    field.positions.push_back({static_cast<float>(i % 20), static_cast<float>(i / 20), 0});
    field.functions.Row(i)[0] = 1;
  }
  const CoarseField coarse = MakeCoarseField(field, 4);
  EXPECT_GE(coarse.cells, 400 / 16);
  EXPECT_LE(coarse.cells, 100);
  std::vector<std::set<int32_t>> about(static_cast<size_t>(coarse.cells));
  for (int64_t c = 0; c < coarse.cells; ++c) {
    about[c] = Neighbours(coarse, c);
    EXPECT_FLOAT_EQ(coarse.rows.Row(c)[0], 1);
  }
  for (int i = 0; i + 1 < 400; ++i) {
    if (i % 20 == 19) continue;
    EXPECT_TRUE(about[coarse.cell[i]].count(coarse.cell[i + 1]) > 0);
  }
}

TEST(CoarseField, ExtremesAreCellsOfTheirOwn) {
  Field field = Picture(4, 1, 1);
  EXPECT_EQ(MakeCoarseField(field, 1).cells, 4);
  EXPECT_EQ(MakeCoarseField(field, 64).cells, 1);
  field.width = field.height = 0;
  EXPECT_EQ(MakeCoarseField(field, 8).cells, 4);
  field.positions.assign(4, {1, 2, 3});  // all in one place
  EXPECT_EQ(MakeCoarseField(field, 2).cells, 1);
}

TEST(CoarseField, RefusesWhatDoesNotFit) {
  EXPECT_THROW(MakeCoarseField(Picture(2, 2, 1), 0), Error);
  Field field = Picture(2, 2, 1);
  field.width = 3;
  EXPECT_THROW(MakeCoarseField(field, 1), Error);
  field.width = field.height = 0;
  field.positions.assign(4, {0, 0, std::numeric_limits<float>::infinity()});
  EXPECT_THROW(MakeCoarseField(field, 2), Error);
}

}  // namespace
}  // namespace lfm
