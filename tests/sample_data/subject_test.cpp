// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/subject.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "sample_data/bust_shape.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

class BustTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { bust_ = new Subject(MakeBust(1.0, 1)); }
  static void TearDownTestSuite() { delete bust_; }
  static Subject* bust_;
};
Subject* BustTest::bust_ = nullptr;

TEST_F(BustTest, IsClosedAndStandsInsideThePlatform) {
  const MeshTopology topology = ExamineTopology(bust_->mesh);
  EXPECT_TRUE(topology.closed && topology.manifold);
  EXPECT_EQ(topology.components, 1);
  EXPECT_GT(SignedVolume(bust_->mesh), 1e5);
  Eigen::AlignedBox3d box;
  for (const V3& p : bust_->mesh.vertices) box.extend(p);
  EXPECT_NEAR(box.min().z(), 0, 1e-3);
  EXPECT_NEAR(box.max().z(), 120, 1e-9);
  // Inside the ring of tags, whose inner edge is 81 mm from the centre.
  EXPECT_LT(box.min().head<2>().cwiseAbs().maxCoeff(), 60);
  EXPECT_LT(box.max().head<2>().cwiseAbs().maxCoeff(), 60);
}

TEST_F(BustTest, HasAFlatBaseAndConcavities) {
  double base_area = 0;
  for (size_t t = 0; t < bust_->mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& c = bust_->mesh.triangles[t];
    if (bust_->mesh.vertices[c[0]].z() < 0.01 && bust_->mesh.vertices[c[1]].z() < 0.01 &&
        bust_->mesh.vertices[c[2]].z() < 0.01) {
      base_area += TriangleArea(bust_->mesh, static_cast<int>(t));
    }
  }
  EXPECT_GT(base_area, 1000);
  // A closed convex body would have no vertex in front of the plane of any triangle.
  int concave = 0;
  for (size_t v = 0; v < bust_->mesh.vertices.size(); v += 7) {
    for (size_t w = 0; w < bust_->mesh.vertices.size(); w += 997) {
      const V3 d = bust_->mesh.vertices[w] - bust_->mesh.vertices[v];
      if (bust_->mesh.normals[v].dot(d) > 3) {
        ++concave;
        break;
      }
    }
  }
  EXPECT_GT(concave, static_cast<int>(bust_->mesh.vertices.size() / 7 / 5));
}

TEST_F(BustTest, PaintKeepsItsRanges) {
  float darkest = 1, brightest = 0;
  for (const Paint& paint : bust_->paint) {
    ASSERT_GE(paint.alpha, 0.2f);
    ASSERT_LE(paint.alpha, 0.35f);
    ASSERT_GE(paint.diffuse.minCoeff(), 0);
    // Base and coat together reflect less than arrives.
    ASSERT_LT(
        (paint.diffuse.cwiseProduct(Eigen::Vector3f::Ones() - paint.coat) + paint.coat).maxCoeff(),
        0.95f);
    darkest = std::min(darkest, paint.diffuse.mean());
    brightest = std::max(brightest, paint.diffuse.mean());
  }
  EXPECT_LT(darkest, 0.1f);
  EXPECT_GT(brightest, 0.3f);
}

TriangleMesh Tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 4}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

ImportedMesh Imported(TriangleMesh mesh) {
  ImportedMesh imported;
  imported.mesh = std::move(mesh);
  return imported;
}

// Texture coordinates that are a linear function of the place stay it.
TEST(Subject, SplittingInterpolatesTextureCoordinatesAndKeepsMaterials) {
  ImportedMesh imported = Imported(Tetrahedron());
  for (const V3& p : imported.mesh.vertices) {
    imported.uv.emplace_back(static_cast<float>(p.x() / 2), static_cast<float>(p.z() / 4));
  }
  imported.material.assign(4, 1);
  const ImportedMesh split = SplitLongEdges(imported, 0.4);
  ASSERT_EQ(split.uv.size(), split.mesh.vertices.size());
  for (size_t v = 0; v < split.uv.size(); ++v) {
    const V3& p = split.mesh.vertices[v];
    EXPECT_NEAR(split.uv[v].x(), p.x() / 2, 1e-6);
    EXPECT_NEAR(split.uv[v].y(), p.z() / 4, 1e-6);
  }
  EXPECT_EQ(split.material, std::vector<int>(split.mesh.vertices.size(), 1));
}

TEST(Subject, SplitsLongEdgesAndStaysClosed) {
  const TriangleMesh mesh = SplitLongEdges(Imported(Tetrahedron()), 0.4).mesh;
  const MeshTopology topology = ExamineTopology(mesh);
  EXPECT_TRUE(topology.closed && topology.manifold);
  EXPECT_NEAR(SignedVolume(mesh), SignedVolume(Tetrahedron()), 1e-12);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int e = 0; e < 3; ++e) {
      ASSERT_LE((mesh.vertices[t[e]] - mesh.vertices[t[(e + 1) % 3]]).norm(), 0.4 + 1e-12);
    }
  }
}

TEST(Subject, StandsAnyMeshOnThePlatform) {
  const Subject subject = MakeSubject(Imported(Tetrahedron()), 100, 5, 1);
  Eigen::AlignedBox3d box;
  for (const V3& p : subject.mesh.vertices) box.extend(p);
  EXPECT_NEAR(box.min().z(), 0, 1e-9);
  EXPECT_NEAR(box.max().z(), 100, 1e-9);
  EXPECT_NEAR(box.center().x(), 0, 1e-9);
  EXPECT_EQ(subject.paint.size(), subject.mesh.vertices.size());
}

TEST(Subject, TakesAMeshWithEverythingThatAMeshMayHave) {
  TriangleMesh mesh = Tetrahedron();
  mesh.confidence.assign(mesh.vertices.size(), 0.5f);
  mesh.colors.assign(mesh.vertices.size(), Eigen::Vector3f(0.2f, 0.4f, 0.6f));
  const TriangleMesh split = SplitLongEdges(Imported(mesh), 0.4).mesh;
  EXPECT_EQ(split.confidence, std::vector<float>(split.vertices.size(), 0.5f));
  EXPECT_EQ(split.colors.size(), split.vertices.size());
  const Subject subject = MakeSubject(Imported(mesh), 100, 5, 1);
  EXPECT_TRUE(subject.mesh.confidence.empty());
  EXPECT_EQ(subject.mesh.colors.size(), subject.mesh.vertices.size());
}

TEST(Subject, RejectsFlatAndHostileMeshes) {
  TriangleMesh flat = Tetrahedron();
  flat.vertices[3].z() = 0;
  EXPECT_THROW(MakeSubject(Imported(flat), 120, 1, 1), Error);
  EXPECT_THROW(MakeSubject(ImportedMesh(), 120, 1, 1), Error);
  TriangleMesh broken = Tetrahedron();
  broken.vertices[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MakeSubject(Imported(broken), 120, 1, 1), Error);
  EXPECT_THROW(MakeSubject(Imported(Tetrahedron()), 120, 0.02, 1), Error);
}

}  // namespace
}  // namespace lfm
