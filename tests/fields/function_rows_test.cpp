// SPDX-License-Identifier: BSD-3-Clause
#include "fields/function_rows.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"

namespace lfm {
namespace {

FunctionRows Counting(int64_t rows, int columns) {
  FunctionRows result = MakeFunctionRows(rows, columns);
  for (int64_t r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) result.Row(r)[c] = static_cast<float>(r * 1000 + c);
  }
  return result;
}

TEST(FunctionRows, RowsArePaddedWithZeros) {
  const FunctionRows rows = Counting(3, 253);
  EXPECT_EQ(rows.stride, 256);
  for (int64_t r = 0; r < 3; ++r) {
    for (int c = 253; c < 256; ++c) EXPECT_EQ(rows.Row(r)[c], 0);
  }
}

TEST(FunctionRows, SizesOutOfRangeAreRefused) {
  EXPECT_THROW(MakeFunctionRows(-1, 4), Error);
  EXPECT_THROW(MakeFunctionRows(1, 0), Error);
  EXPECT_THROW(MakeFunctionRows(int64_t{1} << 34, 253), Error);
  EXPECT_EQ(MakeFunctionRows(0, 4).values.size(), 0u);
}

TEST(FunctionRows, GatheredRowsKeepTheirOrder) {
  const FunctionRows all = Counting(5, 7);
  const FunctionRows some = GatherRows(all.View(), {4, 0, 4});
  ASSERT_EQ(some.rows, 3);
  EXPECT_EQ(some.Row(0)[6], 4006);
  EXPECT_EQ(some.Row(1)[6], 6);
  EXPECT_EQ(some.Row(2)[0], 4000);
  EXPECT_THROW(GatherRows(all.View(), {5}), Error);
  EXPECT_THROW(GatherRows(all.View(), {-1}), Error);
}

TEST(FunctionRows, TransposeSwapsRowsAndColumns) {
  const FunctionRows matrix = Counting(67, 45);
  const FunctionRows transposed = TransposeRows(matrix.View());
  ASSERT_EQ(transposed.rows, 45);
  ASSERT_EQ(transposed.columns, 67);
  for (int64_t r = 0; r < 67; ++r) {
    for (int c = 0; c < 45; ++c) EXPECT_EQ(transposed.Row(c)[r], matrix.Row(r)[c]);
  }
}

TEST(FunctionRows, NumbersThatAreNotFiniteAreNamed) {
  FunctionRows matrix = Counting(4, 5);
  EXPECT_NO_THROW(RequireFinite(matrix.View(), "field"));
  matrix.Row(2)[3] = std::numeric_limits<float>::infinity();
  try {
    RequireFinite(matrix.View(), "field");
    FAIL() << "an infinite number was taken";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "field: row 2, column 3 is not finite");
  }
}

}  // namespace
}  // namespace lfm
