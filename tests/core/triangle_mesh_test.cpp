// SPDX-License-Identifier: BSD-3-Clause
#include "core/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "mesh_zoo.h"
#include "test_files.h"

namespace lfm {
namespace {

struct Animal {
  const char* name;
  TriangleMesh mesh;
  bool manifold, closed;
  int components;
  int64_t boundary_edges;
};

std::vector<Animal> Zoo() {
  return {
      {"triangle", SingleTriangle(), true, false, 1, 3},
      {"tetrahedron", Tetrahedron(), true, true, 1, 0},
      {"octahedron", Octahedron(), true, true, 1, 0},
      {"torus", Torus(12, 7), true, true, 1, 0},
      {"open tetrahedron", WithoutLast(Tetrahedron()), true, false, 1, 3},
      {"two tetrahedra", Join(Tetrahedron(), Moved(Tetrahedron(), {9, 0, 0})), true, true, 2, 0},
      {"bow tie", BowTie(), false, false, 2, 6},
      {"three sheets", ThreeSheets(), false, false, 1, 6},
      {"Moebius strip", Moebius(), false, false, 1, 10},
      {"flipped triangle", WithFlipped(Tetrahedron(), 1), false, false, 1, 0},
  };
}

TEST(Topology, OfTheZooIsAsConstructed) {
  for (const Animal& animal : Zoo()) {
    const MeshTopology topology = ExamineTopology(animal.mesh);
    EXPECT_EQ(topology.manifold, animal.manifold) << animal.name;
    EXPECT_EQ(topology.closed, animal.closed) << animal.name;
    EXPECT_EQ(topology.boundary_edges, animal.boundary_edges) << animal.name;
    EXPECT_EQ(topology.degenerate_triangles, 0) << animal.name;
    if (std::string(animal.name) != "bow tie") {  // joined at a vertex: by edges there are two
      EXPECT_EQ(topology.components, animal.components) << animal.name;
    }
  }
}

TEST(Topology, CountsDegenerateTriangles) {
  TriangleMesh mesh = SingleTriangle();
  mesh.vertices.push_back({2, 0, 0});
  mesh.triangles.push_back({0, 1, 3});  // collinear
  EXPECT_EQ(ExamineTopology(mesh).degenerate_triangles, 1);
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(ExamineTopology(mesh).degenerate_triangles, 2);
  EXPECT_FALSE(ExamineTopology(mesh).manifold);
  EXPECT_FALSE(ExamineTopology(TriangleMesh{}).closed);
}

TEST(VertexRings, HoldEveryCornerOnceInOrder) {
  for (const Animal& animal : Zoo()) {
    const VertexRings rings = ComputeVertexRings(animal.mesh);
    ASSERT_EQ(rings.offsets.size(), animal.mesh.vertices.size() + 1) << animal.name;
    EXPECT_EQ(rings.offsets.front(), 0);
    EXPECT_EQ(rings.offsets.back(), static_cast<int>(3 * animal.mesh.triangles.size()));
    for (size_t v = 0; v < animal.mesh.vertices.size(); ++v) {
      std::vector<int> expected;
      for (size_t t = 0; t < animal.mesh.triangles.size(); ++t) {
        if ((animal.mesh.triangles[t].array() == static_cast<int>(v)).any()) {
          expected.push_back(static_cast<int>(t));
        }
      }
      const std::vector<int> ring(rings.triangles.begin() + rings.offsets[v],
                                  rings.triangles.begin() + rings.offsets[v + 1]);
      EXPECT_EQ(ring, expected) << animal.name << " vertex " << v;
    }
  }
}

TEST(TriangleNeighbors, ShareTheEdgeAndAreMutual) {
  for (const Animal& animal : Zoo()) {
    if (!animal.manifold) continue;
    const std::vector<Eigen::Vector3i> neighbors = ComputeTriangleNeighbors(animal.mesh);
    int64_t boundary = 0;
    for (size_t t = 0; t < neighbors.size(); ++t) {
      for (int e = 0; e < 3; ++e) {
        const int other = neighbors[t][e];
        if (other < 0) {
          ++boundary;
          continue;
        }
        const int from = animal.mesh.triangles[t][e], to = animal.mesh.triangles[t][(e + 1) % 3];
        bool mutual = false;
        for (int f = 0; f < 3; ++f) {
          mutual |= animal.mesh.triangles[other][f] == to &&
                    animal.mesh.triangles[other][(f + 1) % 3] == from &&
                    neighbors[other][f] == static_cast<int>(t);
        }
        EXPECT_TRUE(mutual) << animal.name;
      }
    }
    EXPECT_EQ(boundary, animal.boundary_edges) << animal.name;
  }
}

TEST(TriangleMesh, AreaVolumeAndNormalsAreExact) {
  const TriangleMesh mesh = Octahedron();  // vertices at distance 1 on the axes
  EXPECT_NEAR(SignedVolume(mesh), 4.0 / 3, 1e-14);
  EXPECT_NEAR(SignedVolume(Moved(mesh, {1e6, -1e6, 1e6})), 4.0 / 3, 1e-8);
  double area = 0;
  for (int t = 0; t < 8; ++t) {
    area += TriangleArea(mesh, t);
    const Eigen::Vector3d normal = TriangleNormal(mesh, t);
    EXPECT_NEAR(normal.cwiseAbs().minCoeff(), 1 / std::sqrt(3.0), 1e-14);
    EXPECT_GT(normal.dot(mesh.vertices[mesh.triangles[t][0]]), 0);
  }
  EXPECT_NEAR(area, 4 * std::sqrt(3.0), 1e-13);
  EXPECT_NEAR(TotalArea(mesh), 4 * std::sqrt(3.0), 1e-13);
  EXPECT_EQ(TotalArea({}), 0);
  const std::vector<Eigen::Vector3d> normals = ComputeVertexNormals(mesh);
  for (size_t v = 0; v < normals.size(); ++v) {
    EXPECT_LT((normals[v] - mesh.vertices[v]).norm(), 1e-14);
  }
}

// A closed surface: the area vectors add up to zero and the Euler characteristic is that of the
// shape.
TEST(TriangleMesh, InvariantsOfClosedSurfacesHold) {
  const std::pair<TriangleMesh, int> closed[] = {
      {Tetrahedron(), 2}, {Octahedron(), 2}, {Torus(12, 7), 0}};
  for (const auto& [mesh, euler] : closed) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      const int i = static_cast<int>(t);
      sum += TriangleArea(mesh, i) * TriangleNormal(mesh, i);
    }
    EXPECT_LT(sum.norm(), 1e-12);
    EXPECT_GT(SignedVolume(mesh), 0);
    const auto faces = static_cast<int>(mesh.triangles.size());
    EXPECT_EQ(static_cast<int>(mesh.vertices.size()) - faces * 3 / 2 + faces, euler);
  }
}

TEST(TriangleMesh, ExtremesAreFinite) {
  TriangleMesh mesh = SingleTriangle();
  mesh.vertices.push_back({5, 5, 5});  // in no triangle
  mesh.vertices.push_back({2, 0, 0});
  mesh.triangles.push_back({0, 1, 4});  // collinear
  EXPECT_EQ(TriangleNormal(mesh, 1), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(TriangleArea(mesh, 1), 0);
  const std::vector<Eigen::Vector3d> normals = ComputeVertexNormals(mesh);
  EXPECT_EQ(normals[3], Eigen::Vector3d(0, 0, 1));
  for (const Eigen::Vector3d& n : normals) EXPECT_NEAR(n.norm(), 1, 1e-12);
  EXPECT_EQ(SignedVolume(TriangleMesh{}), 0);
  EXPECT_TRUE(ComputeVertexNormals(TriangleMesh{}).empty());
}

TEST(ValidateMesh, NamesThePlaceAndTheProblem) {
  EXPECT_NO_THROW(ValidateMesh(Tetrahedron(), "bust"));
  ExpectError([] { ValidateMesh(TriangleMesh{}, "bust"); }, "bust: the mesh has no triangle");
  TriangleMesh mesh = Tetrahedron();
  mesh.vertices[1].y() = std::numeric_limits<double>::infinity();
  ExpectError([&] { ValidateMesh(mesh, "bust"); }, "not finite");
  mesh = Tetrahedron();
  mesh.triangles[2][1] = 4;
  ExpectError([&] { ValidateMesh(mesh, "bust"); }, "not there");
  mesh.triangles[2][1] = -1;
  ExpectError([&] { ValidateMesh(mesh, "bust"); }, "not there");
  mesh = Tetrahedron();
  mesh.normals.resize(1);
  ExpectError([&] { ValidateMesh(mesh, "bust"); }, "normals");
}

}  // namespace
}  // namespace lfm
