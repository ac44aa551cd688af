// SPDX-License-Identifier: BSD-3-Clause
#include "core/transport_matrix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/hash.h"
#include "core/parallel.h"
#include "test_files.h"

namespace lfm {
namespace {

// Distinct values of both signs over several powers of two, exact in float16.
float Entry(int64_t row, int64_t i) {
  const int64_t n = (row * 131 + i * 7) % 2047 - 1023;
  return std::ldexp(static_cast<float>(n), static_cast<int>((row + i) % 9) - 12);
}

void FillEntries(const TransportShape& shape, int64_t first, int64_t count,
                 std::span<float> values) {
  for (int64_t r = 0; r < count; ++r) {
    for (int64_t i = 0; i < shape.row_values(); ++i) {
      values[static_cast<size_t>(r * shape.row_values() + i)] = Entry(first + r, i);
    }
  }
}

void Write(const TransportShape& shape, const std::filesystem::path& file, int64_t block_bytes) {
  WriteTransportMatrix(
      shape,
      [&](int64_t first, int64_t count, std::span<float> values) {
        ASSERT_EQ(static_cast<int64_t>(values.size()), count * shape.row_values());
        for (float v : values) ASSERT_EQ(v, 0);
        FillEntries(shape, first, count, values);
      },
      file, block_bytes);
}

TransportShape SmallShape(TransportValue value, int channels) {
  TransportShape shape;
  shape.points = 7;
  shape.views = 3;
  shape.cube_resolution = 2;
  shape.channels = channels;
  shape.value = value;
  return shape;
}

TEST(TransportMatrix, WhatWasWrittenIsReadInAnyRangeOfRows) {
  const TestFolder folder;
  for (TransportValue value : {TransportValue::kFloat16, TransportValue::kFloat32}) {
    for (int channels : {1, 3}) {
      const TransportShape shape = SmallShape(value, channels);
      // From one row a block, over an odd number of rows, to all rows in one.
      for (int64_t block_bytes : {1, 1000, 1 << 20}) {
        Write(shape, folder / "t.ltm", block_bytes);
        const TransportMatrix matrix(folder / "t.ltm");
        EXPECT_EQ(matrix.shape(), shape);
        EXPECT_EQ(matrix.shape().rows(), 21);
        EXPECT_EQ(matrix.shape().columns(), 24);
        for (int64_t first : {0, 3, 20, 21}) {
          for (int64_t count : {0, 1, 4, 21}) {
            if (first + count > 21) {
              ExpectError([&] { matrix.ReadRows(first, count); }, "has no");
              continue;
            }
            std::vector<float> expected(static_cast<size_t>(count * shape.row_values()));
            FillEntries(shape, first, count, expected);
            EXPECT_EQ(matrix.ReadRows(first, count), expected);
          }
        }
        ExpectError([&] { matrix.ReadRows(-1, 1); }, "has no");
        ExpectError([&] { matrix.ReadRows(0, -1); }, "has no");
        ExpectError([&] { matrix.ReadRows(std::numeric_limits<int64_t>::max(), 1); }, "has no");
      }
    }
  }
  EXPECT_EQ(folder.FileCount(), 1);
}

TEST(TransportMatrix, HasTheDocumentedBytes) {
  const TestFolder folder;
  TransportShape shape;
  shape.points = 2;
  shape.cube_resolution = 1;
  shape.channels = 1;
  shape.value = TransportValue::kFloat16;
  WriteTransportMatrix(
      shape,
      [](int64_t first, int64_t, std::span<float> values) {
        for (size_t i = 0; i < values.size(); ++i) values[i] = first == 0 ? 1.0f : -2.0f;
      },
      folder / "t.ltm", 1);
  const std::string bytes = Get(folder / "t.ltm");
  // Two blocks of six halves, padded from 12 to 16 bytes each.
  ASSERT_EQ(bytes.size(), 64u + 2 * 16 + 3 * 8);
  EXPECT_EQ(bytes.substr(0, 8), "LFMTRM\r\n");
  const auto number = [&](size_t offset, size_t size) {
    uint64_t n = 0;
    std::memcpy(&n, bytes.data() + offset, size);
    return n;
  };
  EXPECT_EQ(number(8, 4), 1u);   // version
  EXPECT_EQ(number(12, 4), 0u);  // float16
  EXPECT_EQ(number(16, 4), 1u);  // channels
  EXPECT_EQ(number(20, 4), 1u);  // cube resolution
  EXPECT_EQ(number(24, 8), 2u);  // points
  EXPECT_EQ(number(32, 8), 1u);  // views
  EXPECT_EQ(number(40, 8), 1u);  // rows a block
  EXPECT_EQ(number(48, 8), bytes.size());
  EXPECT_EQ(number(56, 8), Checksum(bytes.data(), 56));
  EXPECT_EQ(number(64, 2), 0x3c00u);       // 1
  EXPECT_EQ(number(64 + 16, 2), 0xc000u);  // -2
  EXPECT_EQ(number(64 + 12, 4), 0u);       // padding
  EXPECT_EQ(number(96, 8), Checksum(bytes.data() + 64, 16));
  EXPECT_EQ(number(112, 8), Checksum(bytes.data() + 96, 16));
}

TEST(TransportMatrix, HalvesAreRoundedToNearest) {
  const TestFolder folder;
  TransportShape shape;
  shape.points = 1;
  shape.cube_resolution = 1;
  const std::vector<float> values = {1.0f / 3, 65504, 1e-9f, 6.1e-5f, -0.1f, 2049.4f};
  WriteTransportMatrix(
      shape,
      [&](int64_t, int64_t, std::span<float> out) {
        std::copy(values.begin(), values.end(), out.begin());
      },
      folder / "t.ltm");
  const std::vector<float> read = TransportMatrix(folder / "t.ltm").ReadRows(0, 1);
  for (size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(read[i], values[i], std::abs(values[i]) * 0x1p-11 + 0x1p-25) << i;
  }
}

TEST(TransportMatrix, BadValuesAndShapesAreErrorsAndLeaveNoFile) {
  const TestFolder folder;
  const TransportShape shape = SmallShape(TransportValue::kFloat16, 1);
  const auto write = [&](const TransportShape& s, float bad) {
    WriteTransportMatrix(
        s, [&](int64_t first, int64_t, std::span<float> v) { v[0] = first >= 4 ? bad : 1; },
        folder / "t.ltm", 1);
  };
  ExpectError([&] { write(shape, 70000); }, "row 4 of the transport matrix");
  ExpectError([&] { write(shape, 70000); }, "write float32");
  ExpectError([&] { write(shape, std::nanf("")); }, "not finite");
  ExpectError([&] { write(shape, -INFINITY); }, "not finite");
  EXPECT_EQ(folder.FileCount(), 0);
  TransportShape wide = SmallShape(TransportValue::kFloat32, 1);
  write(wide, 70000);
  EXPECT_EQ(TransportMatrix(folder / "t.ltm").ReadRows(4, 1)[0], 70000);
  const auto refused = [&](auto change, const char* message) {
    TransportShape bad = shape;
    change(bad);
    ExpectError([&] { write(bad, 1); }, message);
  };
  refused([](TransportShape& s) { s.points = 0; }, "0 points");
  refused([](TransportShape& s) { s.views = -1; }, "views");
  refused([](TransportShape& s) { s.points = s.views = int64_t{1} << 40; }, "at most 2^36");
  refused([](TransportShape& s) { s.channels = 2; }, "2 channels");
  refused([](TransportShape& s) { s.cube_resolution = 1025; }, "1025 texels");
}

TEST(TransportMatrix, EveryTruncationAndEveryChangedByteIsNoticed) {
  const TestFolder folder;
  const TransportShape shape = SmallShape(TransportValue::kFloat16, 1);
  Write(shape, folder / "t.ltm", 300);
  const std::string whole = Get(folder / "t.ltm");
  const auto read_all = [&] { TransportMatrix(folder / "bad.ltm").ReadRows(0, 21); };
  for (size_t length = 0; length < whole.size(); length += length < 80 ? 1 : 13) {
    Put(folder / "bad.ltm", whole.substr(0, length));
    EXPECT_THROW(read_all(), Error) << length;
  }
  Put(folder / "bad.ltm", whole + "x");
  ExpectError(read_all, "should have");
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x41);
    Put(folder / "bad.ltm", changed);
    EXPECT_THROW(read_all(), Error) << i;
  }
  ExpectError([&] { TransportMatrix(folder / "absent.ltm"); }, "absent.ltm");
  ExpectError([&] { TransportMatrix(folder.path()); }, "is not a file");
}

// Headers whose checksum is right but whose promises are not: refused before memory is taken.
TEST(TransportMatrix, ForgedHeadersAreRefused) {
  const TestFolder folder;
  Write(SmallShape(TransportValue::kFloat16, 1), folder / "t.ltm", 300);
  const std::string whole = Get(folder / "t.ltm");
  const auto forge = [&](size_t offset, size_t size, uint64_t number, const char* message) {
    std::string forged = whole;
    std::memcpy(forged.data() + offset, &number, size);
    const uint64_t checksum = Checksum(forged.data(), 56);
    std::memcpy(forged.data() + 56, &checksum, 8);
    Put(folder / "bad.ltm", forged);
    ExpectError([&] { TransportMatrix(folder / "bad.ltm"); }, message);
  };
  forge(0, 1, 'X', "is not a transport matrix");
  forge(8, 4, 2, "version 2");
  forge(12, 4, 7, "neither float16 nor float32");
  forge(16, 4, 0xffffffff, "channels");
  forge(20, 4, 0, "cube map");
  forge(20, 4, 0xffffffff, "cube map");
  for (size_t offset : {24, 32}) {  // points, views
    forge(offset, 8, 0, "points");
    forge(offset, 8, ~uint64_t{0}, "points");
    forge(offset, 8, uint64_t{1} << 33, "contradict");
  }
  forge(40, 8, 0, "rows a block");
  forge(40, 8, ~uint64_t{0}, "rows a block");
  forge(40, 8, 2, "contradict");
  forge(48, 8, ~uint64_t{0}, "contradict");
}

TEST(TransportMatrix, DamageIsNamedWhereItIsReadAndNotElsewhere) {
  const TestFolder folder;
  const TransportShape shape = SmallShape(TransportValue::kFloat16, 1);
  Write(shape, folder / "t.ltm", 96);  // two rows a block
  std::string bytes = Get(folder / "t.ltm");
  bytes[64 + 5 * 96 + 3] = static_cast<char>(bytes[64 + 5 * 96 + 3] ^ 1);
  Put(folder / "t.ltm", bytes);
  const TransportMatrix matrix(folder / "t.ltm");
  EXPECT_EQ(matrix.ReadRows(0, 10).size(), 240u);
  EXPECT_EQ(matrix.ReadRows(12, 9).size(), 216u);
  ExpectError([&] { matrix.ReadRows(11, 1); }, "rows 10 and after are damaged");
  ExpectError([&] { matrix.ReadRows(9, 2); }, "t.ltm");
}

TEST(TransportMatrix, ManyThreadsReadTheSame) {
  const TestFolder folder;
  const TransportShape shape = SmallShape(TransportValue::kFloat32, 3);
  Write(shape, folder / "t.ltm", 700);
  const TransportMatrix matrix(folder / "t.ltm");
  ParallelFor(0, 200, [&](int64_t i) {
    std::vector<float> expected(static_cast<size_t>(shape.row_values()));
    FillEntries(shape, i % 21, 1, expected);
    EXPECT_EQ(matrix.ReadRows(i % 21, 1), expected);
  });
}

}  // namespace
}  // namespace lfm
