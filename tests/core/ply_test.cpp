// SPDX-License-Identifier: BSD-3-Clause
#include "core/ply.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "test_files.h"

namespace lfm {
namespace {

TriangleMesh Tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1.0 / 3, 0, 0}, {0, 1e-7, 1e6}, {0.1, -0.2, 0.3}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  mesh.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0.6, 0.8, 0}};
  mesh.confidence = {0, 0.25f, 0.5f, 1};
  mesh.colors = {{0, 0, 0}, {1, 1, 1}, {0.2f, 0.4f, 0.6f}, {1, 0, 0}};
  return mesh;
}

void ExpectSameMesh(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
  ASSERT_EQ(a.normals.size(), b.normals.size());
  for (size_t i = 0; i < a.normals.size(); ++i) {
    EXPECT_LT((a.normals[i] - b.normals[i]).norm(), 1e-7);
  }
  EXPECT_EQ(a.confidence, b.confidence);
  ASSERT_EQ(a.colors.size(), b.colors.size());
  for (size_t i = 0; i < a.colors.size(); ++i) {
    EXPECT_LT((a.colors[i] - b.colors[i]).norm(), 1e-6);  // whole levels of 255 in the test data
  }
}

TEST(Ply, MeshRoundTrips) {
  const TestFolder folder;
  const TriangleMesh mesh = Tetrahedron();
  WritePly(mesh, folder / "a.ply");
  ExpectSameMesh(ReadPlyMesh(folder / "a.ply"), mesh);
  TriangleMesh bare = mesh;
  bare.normals.clear();
  bare.confidence.clear();
  bare.colors.clear();
  WritePly(bare, folder / "a.ply");
  ExpectSameMesh(ReadPlyMesh(folder / "a.ply"), bare);
  EXPECT_EQ(folder.FileCount(), 1);
}

TEST(Ply, CloudRoundTripsEvenWhenEmpty) {
  const TestFolder folder;
  PointCloud cloud;
  WritePly(cloud, folder / "a.ply");
  EXPECT_TRUE(ReadPlyCloud(folder / "a.ply").points.empty());
  cloud.points = {{0.5, -2, 3}, {100.25, 0, 1}};
  cloud.normals = {{0, 0, 1}, {1, 0, 0}};
  cloud.confidence = {0.5f, 0.75f};
  cloud.sigma_mm = {0.015625f, 2.0f};
  WritePly(cloud, folder / "a.ply");
  const PointCloud back = ReadPlyCloud(folder / "a.ply");
  EXPECT_EQ(back.sigma_mm, cloud.sigma_mm);
  EXPECT_EQ(back.points, cloud.points);
  EXPECT_EQ(back.normals, cloud.normals);
  EXPECT_EQ(back.confidence, cloud.confidence);
}

TEST(Ply, SigmasThatAreNotPositiveAreRefused) {
  const TestFolder folder;
  PointCloud cloud;
  cloud.points = {{0, 0, 0}};
  for (const float bad : {0.0f, -1.0f, std::numeric_limits<float>::infinity()}) {
    cloud.sigma_mm = {bad};
    WritePly(cloud, folder / "a.ply");
    ExpectError([&] { ReadPlyCloud(folder / "a.ply"); }, "sigma_mm of vertex 0");
  }
  cloud.sigma_mm = {1, 1};
  ExpectError([&] { WritePly(cloud, folder / "a.ply"); }, "2 sigmas for 1", ErrorKind::kSystem);
}

TEST(Ply, WritingDataThatDoesNotFitIsOurFailure) {
  const TestFolder folder;
  TriangleMesh mesh = Tetrahedron();
  mesh.normals.pop_back();
  ExpectError([&] { WritePly(mesh, folder / "a.ply"); }, "3 normals for 4", ErrorKind::kSystem);
  EXPECT_EQ(folder.FileCount(), 0);
}

const char kAscii[] =
    "ply\n"
    "format ascii 1.0\n"
    "comment made by hand\n"
    "element vertex 5\n"
    "property float x\n"
    "property double y\n"
    "property int z\n"
    "property uchar red\n"
    "property uchar green\n"
    "property uchar blue\n"
    "property float quality\n"
    "property list uchar int friends\n"
    "element edge 1\n"
    "property int from\n"
    "property int to\n"
    "element face 2\n"
    "property uchar flags\n"
    "property list uchar uint vertex_index\n"
    "end_header\n"
    "0 0 0 255 0 0 .5 0\n"
    "1 0 0 0 255 0 1e-1 2 7 8\n"
    "1 1 0 0 0 255 0 0\n"
    "0 +1.5 -2 51 51 51 1 1 9\n"
    "0.5 -1 4 0 0 0 0 0\n"
    "0 1\n"
    "7 4 0 1 2 3\n"
    "7 3 0 4 1\n";

TEST(Ply, ReadsAsciiWithPolygonsAndForeignProperties) {
  const TestFolder folder;
  Put(folder / "a.ply", kAscii);
  const TriangleMesh mesh = ReadPlyMesh(folder / "a.ply");
  ASSERT_EQ(mesh.vertices.size(), 5u);
  EXPECT_EQ(mesh.vertices[3], Eigen::Vector3d(0, 1.5, -2));
  const std::vector<Eigen::Vector3i> fan = {{0, 1, 2}, {0, 2, 3}, {0, 4, 1}};
  EXPECT_EQ(mesh.triangles, fan);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_FLOAT_EQ(mesh.confidence[1], 0.1f);
  EXPECT_EQ(mesh.colors[1], Eigen::Vector3f(0, 1, 0));
  EXPECT_FLOAT_EQ(mesh.colors[3][0], 0.2f);
  EXPECT_EQ(ReadPlyCloud(folder / "a.ply").points, mesh.vertices);
}

/// The same triangle in either byte order, one property of every type.
std::string BinaryTriangle(bool big_endian) {
  std::string bytes = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                      "_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\n"
                      "property short z\nproperty char a\nproperty ushort b\nproperty uint c\n"
                      "element face 1\nproperty list int ushort vertex_indices\nend_header\n";
  const auto put = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big_endian) std::reverse(raw, raw + sizeof value);
    bytes.append(raw, sizeof value);
  };
  for (int i = 0; i < 3; ++i) {
    put(1.0 / (i + 3));
    put(0.25f * static_cast<float>(i * i));
    put(static_cast<int16_t>(-300 * i));
    put(static_cast<int8_t>(-1));
    put(static_cast<uint16_t>(1));
    put(uint32_t{1});
  }
  put(int32_t{3});
  for (const uint16_t corner : {0, 1, 2}) put(corner);
  return bytes;
}

TEST(Ply, ReadsBothByteOrders) {
  const TestFolder folder;
  for (const bool big_endian : {false, true}) {
    Put(folder / "a.ply", BinaryTriangle(big_endian));
    const TriangleMesh mesh = ReadPlyMesh(folder / "a.ply");
    ASSERT_EQ(mesh.vertices.size(), 3u);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(mesh.vertices[i], Eigen::Vector3d(1.0 / (i + 3), 0.25 * i * i, -300 * i));
    }
    EXPECT_EQ(mesh.triangles, (std::vector<Eigen::Vector3i>{{0, 1, 2}}));
  }
}

TEST(Ply, CutAtAnyLengthIsAnError) {
  const TestFolder folder;
  for (const std::string& whole : {std::string(kAscii), BinaryTriangle(false)}) {
    for (size_t length = 0; length < whole.size(); ++length) {
      Put(folder / "cut.ply", whole.substr(0, length));
      ASSERT_THROW(ReadPlyMesh(folder / "cut.ply"), Error) << length;
    }
  }
  ExpectError([&] { ReadPlyMesh(folder / "cut.ply"); }, "cut.ply: the PLY file is truncated");
}

std::string WithVertices(const std::string& count, const std::string& lines,
                         const std::string& face_lines = "3 0 1 2\n") {
  return "ply\nformat ascii 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n" +
         lines + face_lines;
}

TEST(Ply, HostileContentIsAnErrorThatNamesTheFile) {
  const TestFolder folder;
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  struct Case {
    std::string content, message;
  };
  const Case cases[] = {
      {"", "empty"},
      {"plyx\n", "not a PLY"},
      {"hello", "not a PLY"},
      {"ply\nend_header\n", "does not tell the format"},
      {"ply\nformat ebcdic 1.0\nend_header\n", "unknown PLY format"},
      {"ply\nformat ascii 1.0\nproperty float x\nend_header\n", "unexpected PLY header line"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n",
       "unknown PLY type"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nend_header\n", "has no properties"},
      {"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n",
       "no coordinate 'y'"},
      {"ply\nformat ascii 1.0\nend_header\n", "no element 'vertex'"},
      {WithVertices("99999999999999", three), "truncated"},
      {WithVertices("-3", three), "impossible count"},
      {WithVertices("3x", three), "impossible count"},
      {WithVertices("99999999999999999999999", three), "impossible count"},
      {WithVertices("3", "0 0 0\n1 0 nan\n0 1 0\n"), "vertex 1 is not finite"},
      {WithVertices("3", "0 0 0\n1 0 -inf\n0 1 0\n"), "vertex 1 is not finite"},
      {WithVertices("3", "0 0 0\n1 0 1e999\n0 1 0\n"), "not a number"},
      {WithVertices("3", "0 0 0\n1 0 zero\n0 1 0\n"), "'zero' is not a number"},
      {WithVertices("3", three, "3 0 1 3\n"), "face 0 names a vertex that does not exist"},
      {WithVertices("3", three, "3 0 1 -1\n"), "face 0 names a vertex that does not exist"},
      {WithVertices("3", three, "3 0 1 1.5\n"), "face 0 names a vertex that does not exist"},
      {WithVertices("3", three, "2 0 1\n"), "fewer than three corners"},
      {WithVertices("3", three, "-1\n"), "negative length"},
      {WithVertices("3", three, "4000000000 1 2 3\n"), "truncated"},
      {WithVertices("3", three, "3 0 1 2\n9\n"), "bytes after the last element"},
  };
  for (const Case& c : cases) {
    Put(folder / "bad.ply", c.content);
    ExpectError([&] { ReadPlyMesh(folder / "bad.ply"); }, c.message);
    ExpectError([&] { ReadPlyMesh(folder / "bad.ply"); }, "bad.ply");
  }
  ExpectError([&] { ReadPlyMesh(folder / "missing.ply"); }, "missing.ply");
}

TEST(Ply, HostileBinaryCountsTakeNoMemory) {
  const TestFolder folder;
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 9000000000000000000\n"
      "property double x\nproperty double y\nproperty double z\nend_header\n";
  Put(folder / "a.ply", header + std::string(240, '\0'));
  ExpectError([&] { ReadPlyCloud(folder / "a.ply"); }, "truncated");
  const std::string lists =
      "ply\nformat binary_little_endian 1.0\nelement face 1\n"
      "property list uint double vertex_indices\nend_header\n\xff\xff\xff\xff";
  Put(folder / "b.ply", lists + std::string(80, '\0'));
  ExpectError([&] { ReadPlyMesh(folder / "b.ply"); }, "truncated");
}

TEST(Ply, NanInAnyPropertyIsAnError) {
  const TestFolder folder;
  for (int what = 0; what < 3; ++what) {
    TriangleMesh mesh = Tetrahedron();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (what == 0) mesh.vertices[2].y() = nan;
    if (what == 1) mesh.normals[2].y() = nan;
    if (what == 2) mesh.confidence[2] = static_cast<float>(nan);
    WritePly(mesh, folder / "a.ply");
    ExpectError([&] { ReadPlyMesh(folder / "a.ply"); }, "vertex 2 is not finite");
  }
}

TEST(Ply, CloudIsNoMesh) {
  const TestFolder folder;
  PointCloud cloud;
  cloud.points = {{0, 0, 0}};
  WritePly(cloud, folder / "a.ply");
  ExpectError([&] { ReadPlyMesh(folder / "a.ply"); }, "a mesh is needed here");
}

}  // namespace
}  // namespace lfm
