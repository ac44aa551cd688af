// SPDX-License-Identifier: BSD-3-Clause
#include "encode/mesh_coder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

LatticeMesh OnLattice(const TriangleMesh& mesh, double step) {
  LatticeMesh lattice{{}, mesh.triangles};
  for (const Eigen::Vector3d& p : mesh.vertices) {
    const double bump = 1 + 0.1 * std::sin(0.2 * p.x());
    lattice.vertices.emplace_back((bump / step * p).array().round().matrix().cast<int>());
  }
  return lattice;
}

// A square of n x n vertices, a part of a plane.
LatticeMesh Sheet(int n) {
  LatticeMesh mesh;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) mesh.vertices.emplace_back(10 * x, 10 * y, (x * y) % 7);
  }
  for (int y = 0; y + 1 < n; ++y) {
    for (int x = 0; x + 1 < n; ++x) {
      const int a = y * n + x;
      mesh.triangles.emplace_back(a, a + 1, a + n);
      mesh.triangles.emplace_back(a + 1, a + n + 1, a + n);
    }
  }
  return mesh;
}

LatticeMesh Joined(const LatticeMesh& a, const LatticeMesh& b) {
  LatticeMesh both = a;
  const auto first = static_cast<int>(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Eigen::Vector3i& t : b.triangles) both.triangles.emplace_back(t.array() + first);
  return both;
}

// Every vertex and triangle of the coded mesh is the one that its order names.
void ExpectComesBack(const LatticeMesh& mesh) {
  const auto coded = EncodeMesh(mesh);
  ASSERT_TRUE(coded.has_value());
  const auto decoded = DecodeMesh(coded->bytes, static_cast<int>(mesh.vertices.size()),
                                  static_cast<int>(mesh.triangles.size()));
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->vertices, coded->mesh.vertices);
  EXPECT_EQ(decoded->triangles, coded->mesh.triangles);
  std::vector<int> vertices = coded->order.vertices, triangles = coded->order.triangles;
  for (size_t v = 0; v < vertices.size(); ++v) {
    EXPECT_EQ(decoded->vertices[v], mesh.vertices[vertices[v]]);
  }
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(vertices[decoded->triangles[t][c]],
                mesh.triangles[triangles[t]][(c + coded->order.turns[t]) % 3]);
    }
  }
  std::sort(vertices.begin(), vertices.end());
  std::sort(triangles.begin(), triangles.end());
  for (size_t v = 0; v < vertices.size(); ++v) ASSERT_EQ(vertices[v], static_cast<int>(v));
  for (size_t t = 0; t < triangles.size(); ++t) ASSERT_EQ(triangles[t], static_cast<int>(t));
}

TEST(MeshCoder, ClosedOpenAndSeveralMeshesComeBack) {
  const LatticeMesh sphere = OnLattice(MakeSphere(3), 0.05);
  ExpectComesBack(sphere);
  ExpectComesBack(OnLattice(MakeSphere(0), 0.05));
  ExpectComesBack(Sheet(2));
  ExpectComesBack(Sheet(12));
  ExpectComesBack(Joined(sphere, Sheet(5)));
  LatticeMesh holed = sphere;
  holed.triangles.erase(holed.triangles.begin() + 40, holed.triangles.begin() + 44);
  ExpectComesBack(holed);
  LatticeMesh mirrored = sphere;
  for (Eigen::Vector3i& t : mirrored.triangles) std::swap(t[1], t[2]);
  ExpectComesBack(mirrored);
}

TEST(MeshCoder, PointsThatCoincideStayApart) {
  LatticeMesh mesh = OnLattice(MakeSphere(2), 0.05);
  mesh.vertices[7] = mesh.vertices[9];
  for (const int v : mesh.triangles[20]) mesh.vertices[v] = {5, 5, 5};  // no area
  ExpectComesBack(mesh);
  for (Eigen::Vector3i& p : mesh.vertices) p.setConstant(-3);
  ExpectComesBack(mesh);
}

TEST(MeshCoder, LargeCoordinatesComeBackAndTooLargeOnesDoNot) {
  LatticeMesh mesh = Sheet(3);
  mesh.vertices[0] = {(1 << 26) - 1, -(1 << 26) + 1, 0};
  ExpectComesBack(mesh);
  mesh.vertices[0].x() = 1 << 26;
  EXPECT_FALSE(EncodeMesh(mesh).has_value());
}

TEST(MeshCoder, RefusesWhatItWouldChange) {
  LatticeMesh isolated = Sheet(4);
  isolated.vertices.emplace_back(1, 2, 3);
  EXPECT_FALSE(EncodeMesh(isolated).has_value());
  LatticeMesh repeated = Sheet(4);
  repeated.triangles.emplace_back(3, 3, 4);
  EXPECT_FALSE(EncodeMesh(repeated).has_value());
  LatticeMesh fins = Sheet(4);  // three triangles on an edge
  fins.vertices.emplace_back(5, 5, 50);
  fins.triangles.emplace_back(5, 6, 16);
  EXPECT_FALSE(EncodeMesh(fins).has_value());
  LatticeMesh touching = Joined(Sheet(3), Sheet(3));  // two fans at one vertex
  for (Eigen::Vector3i& t : touching.triangles) {
    for (int& v : t) v = v == 9 ? 8 : v;
  }
  touching.vertices[9] = touching.vertices[8];
  EXPECT_FALSE(EncodeMesh(touching).has_value());
  EXPECT_FALSE(EncodeMesh({}).has_value());
}

TEST(MeshCoder, SixThousandTrianglesTakeTwoBytesEach) {
  const auto coded = EncodeMesh(OnLattice(MakeSphere(5), 0.06));
  ASSERT_TRUE(coded.has_value());
  EXPECT_LT(coded->bytes.size(), 2 * coded->mesh.triangles.size());
  EXPECT_EQ(EncodeMesh(OnLattice(MakeSphere(5), 0.06))->bytes, coded->bytes);
}

// Nothing but the mesh or none, whatever the bytes.
TEST(MeshCoder, SurvivesDamage) {
  const LatticeMesh mesh = Joined(OnLattice(MakeSphere(2), 0.1), Sheet(6));
  const auto vertices = static_cast<int>(mesh.vertices.size());
  const auto triangles = static_cast<int>(mesh.triangles.size());
  const std::string bytes = EncodeMesh(mesh)->bytes;
  EXPECT_FALSE(DecodeMesh(bytes, vertices + 1, triangles).has_value());
  EXPECT_FALSE(DecodeMesh(bytes, vertices, triangles - 1).has_value());
  for (size_t length = 0; length < bytes.size(); ++length) {
    const std::string prefix = bytes.substr(0, length);  // a block of its own
    DecodeMesh(prefix, vertices, triangles);
  }
  std::mt19937 random(17);
  int refused = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::string damaged = bytes;
    const int flips = 1 + static_cast<int>(random() % 4);
    for (int flip = 0; flip < flips; ++flip) {
      const size_t at =
          random() % (trial % 2 == 0 ? std::min<size_t>(bytes.size(), 64) : bytes.size());
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    }
    const auto decoded = DecodeMesh(damaged, vertices, triangles);
    if (!decoded) {
      ++refused;
      continue;
    }
    for (const Eigen::Vector3i& t : decoded->triangles) {
      ASSERT_GE(t.minCoeff(), 0);
      ASSERT_LT(t.maxCoeff(), vertices);
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace lfm::testing
