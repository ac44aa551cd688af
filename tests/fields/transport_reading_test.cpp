// SPDX-License-Identifier: BSD-3-Clause
#include "fields/transport_reading.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/atomic_file.h"
#include "core/cube_map.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "core/transport_matrix.h"
#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

float Value(int64_t row, int channel, int64_t column) {
  return static_cast<float>(row * 1000 + channel * 100 + column) - 500;  // some are negative
}

class TransportReading : public ::testing::Test {
 protected:
  void PutMatrix(int64_t points, int64_t views, int channels, int resolution = 2) {
    shape_ = {points, views, resolution, channels, TransportValue::kFloat32};
    const auto fill = [&](int64_t first, int64_t count, std::span<float> values) {
      for (int64_t r = 0; r < count; ++r) {
        for (int c = 0; c < channels; ++c) {
          for (int64_t k = 0; k < shape_.columns(); ++k) {
            values[static_cast<size_t>(r * shape_.row_values() + c * shape_.columns() + k)] =
                Value(first + r, c, k);
          }
        }
      }
    };
    WriteTransportMatrix(shape_, fill, scratch_.folder / "t.ltm", 4096);
  }
  Capture Image(int width, int height) const {
    Capture capture;
    capture.folder = scratch_.folder;
    capture.cameras["view"] = {width, height, std::nullopt, std::nullopt};
    capture.transport = TransportField{"t.ltm", TransportKind::kImage, 2, "view", "", {}};
    return capture;
  }
  Capture Mesh(int eyes) const {
    TriangleMesh mesh;
    mesh.vertices = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
    mesh.triangles = {{0, 1, 2}};
    WritePly(mesh, scratch_.folder / "mesh.ply");
    Capture capture;
    capture.folder = scratch_.folder;
    capture.transport = TransportField{"t.ltm", TransportKind::kMesh, 2, "", "mesh.ply", {}};
    capture.transport->eyes.resize(static_cast<size_t>(eyes), Eigen::Vector3d(1, 2, 3));
    return capture;
  }
  void ExpectRows(const Field& field, const std::vector<int64_t>& rows) const {
    ASSERT_EQ(field.points, static_cast<int64_t>(rows.size()));
    ASSERT_EQ(field.functions.rows, field.points * field.channels);
    ASSERT_EQ(field.functions.columns, shape_.columns());
    for (int64_t p = 0; p < field.points; ++p) {
      for (int c = 0; c < field.channels; ++c) {
        for (int64_t k = 0; k < shape_.columns(); ++k) {
          ASSERT_EQ(field.functions.Row(field.RowOf(p, c))[k],
                    Value(rows[static_cast<size_t>(p)], c, k));
        }
      }
    }
  }

  ScratchFolder scratch_;
  TransportShape shape_;
};

TEST_F(TransportReading, RowsOfPixelsBecomePoints) {
  for (const int channels : {1, 3}) {
    PutMatrix(20 * 10, 1, channels);
    const Field field = ReadTransportField(Image(20, 10), {}, SilentProgress());
    EXPECT_EQ(field.kind, FieldColumns::kCubeTexels);
    EXPECT_EQ(field.channels, channels);
    EXPECT_EQ(field.width, 20);
    EXPECT_EQ(field.height, 10);
    EXPECT_TRUE(field.positions.empty());
    std::vector<int64_t> all(200);
    for (int64_t i = 0; i < 200; ++i) all[static_cast<size_t>(i)] = i;
    ExpectRows(field, all);
    const CubeMap cube{2};
    ASSERT_EQ(field.directions.size(), 24u);
    for (int t = 0; t < 24; ++t) {
      EXPECT_NEAR(field.directions[static_cast<size_t>(t)].norm(), 1, 1e-12);
      EXPECT_EQ(cube.TexelOf(field.directions[static_cast<size_t>(t)].cast<float>()), t);
    }
  }
}

TEST_F(TransportReading, SomeRowsKeepTheirOrder) {
  PutMatrix(200, 1, 3);
  std::vector<int64_t> rows = {199, 0, 1, 2, 5, 5, 4};
  for (int64_t i = 10; i < 150; ++i) rows.push_back(i);  // longer than what is read in one go
  SetThreadCount(4);
  const Field field = ReadTransportField(Image(20, 10), rows, SilentProgress());
  SetThreadCount(0);
  EXPECT_EQ(field.width, 0);
  EXPECT_EQ(field.height, 0);
  ExpectRows(field, rows);
}

TEST_F(TransportReading, ViewsOfAMeshFollowEachOther) {
  PutMatrix(3, 2, 3);
  const Field all = ReadTransportField(Mesh(2), {}, SilentProgress());
  ExpectRows(all, {0, 1, 2, 3, 4, 5});
  ASSERT_EQ(all.positions.size(), 6u);
  EXPECT_EQ(all.positions[4], Eigen::Vector3f(4, 5, 6));
  const Field some = ReadTransportField(Mesh(2), {5, 0}, SilentProgress());
  ExpectRows(some, {5, 0});
  EXPECT_EQ(some.positions[0], Eigen::Vector3f(7, 8, 10));
  EXPECT_EQ(some.positions[1], Eigen::Vector3f(1, 2, 3));
}

TEST_F(TransportReading, WhatDoesNotFitTogetherIsNamed) {
  PutMatrix(200, 1, 1);
  const auto read = [](const Capture& capture, const std::vector<int64_t>& rows) {
    ReadTransportField(capture, rows, SilentProgress());
  };
  ExpectErrorWith({"t.ltm", "200 points", "camera 'view'", "210"},
                  [&] { read(Image(21, 10), {}); });
  ExpectErrorWith({"t.ltm", "200 points", "mesh.ply", "3 in 1"}, [&] { read(Mesh(1), {}); });
  ExpectErrorWith({"t.ltm", "no point 200"}, [&] { read(Image(20, 10), {3, 200}); });
  ExpectErrorWith({"t.ltm", "no point -1"}, [&] { read(Image(20, 10), {-1}); });
  Capture capture = Image(20, 10);
  capture.transport->cube_resolution = 4;
  ExpectErrorWith({"t.ltm", "2 texels", "4"}, [&] { read(capture, {}); });
  capture = Image(20, 10);
  capture.cameras.clear();
  ExpectErrorWith({"'view'", "not listed"}, [&] { read(capture, {}); });
  capture.transport->file = "../t.ltm";
  ExpectErrorWith({"../t.ltm", "leaves"}, [&] { read(capture, {}); });
  capture = Mesh(1);
  capture.transport->mesh = "/mesh.ply";
  ExpectErrorWith({"/mesh.ply", "absolute"}, [&] { read(capture, {}); });
  capture.transport.reset();
  ExpectErrorWith({"no light transport"}, [&] { read(capture, {}); });
  PutMatrix(3, 2, 1);
  ExpectErrorWith({"t.ltm", "2 views", "mesh.ply"}, [&] { read(Mesh(3), {}); });
}

TEST_F(TransportReading, DamageIsNamed) {
  PutMatrix(200, 1, 1);
  std::filesystem::resize_file(scratch_.folder / "t.ltm", 1000);
  ExpectErrorWith({"t.ltm"}, [&] { ReadTransportField(Image(20, 10), {}, SilentProgress()); });
  std::filesystem::remove(scratch_.folder / "t.ltm");
  ExpectErrorWith({"t.ltm"}, [&] { ReadTransportField(Image(20, 10), {}, SilentProgress()); });
}

TEST_F(TransportReading, NumbersThatAreNotFiniteAreNamed) {
  PutMatrix(3, 1, 1);  // one block of 3 x 24 numbers behind a header of 64 bytes
  std::string bytes = ReadFile(scratch_.folder / "t.ltm");
  ASSERT_EQ(bytes.size(), 64u + 288 + 8 + 8);
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&bytes[64 + 4 * (24 + 7)], &bad, 4);
  const uint64_t block = Checksum(&bytes[64], 288);
  std::memcpy(&bytes[64 + 288], &block, 8);
  const uint64_t table = Checksum(&bytes[64 + 288], 8);
  std::memcpy(&bytes[64 + 288 + 8], &table, 8);
  PutText(scratch_.folder / "t.ltm", bytes);
  ExpectErrorWith({"t.ltm", "row 1, column 7", "not finite"},
                  [&] { ReadTransportField(Mesh(1), {}, SilentProgress()); });
  EXPECT_EQ(ReadTransportField(Mesh(1), {0, 2}, SilentProgress()).points, 2);
}

}  // namespace
}  // namespace lfm::testing
