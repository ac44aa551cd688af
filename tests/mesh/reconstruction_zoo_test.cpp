// SPDX-License-Identifier: BSD-3-Clause
// What must hold for every shape: closed, manifold, no self-intersections, the right volume and
// number of handles, and confidence exactly where something was measured.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/progress.h"
#include "mesh/cleaning.h"
#include "mesh/decimation_target.h"
#include "mesh/nearest_points.h"
#include "mesh/reconstruction.h"
#include "mesh/self_intersection.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

struct ZooShape {
  std::string name;
  TriangleMesh mesh;
  int handles = 0;
};

TriangleMesh Scaled(TriangleMesh mesh, const Eigen::Vector3d& scale) {
  for (Eigen::Vector3d& v : mesh.vertices) v = v.cwiseProduct(scale);
  return mesh;
}

// A ball with bumps: creases and saddles.
TriangleMesh Bumpy() {
  TriangleMesh mesh = test::MakeSphere(1, 5);
  for (Eigen::Vector3d& v : mesh.vertices) {
    const double r = 25 + 3 * std::sin(5 * v.x()) * std::sin(4 * v.y() + 1) * std::cos(3 * v.z());
    v = r * v + Eigen::Vector3d(0, 0, 25);  // the lowest bump touches the platform
  }
  return mesh;
}

std::vector<ZooShape> Zoo() {
  return {{"ball", test::MakeSphere(30, 5, {0, 0, 30}), 0},
          {"egg", Scaled(test::MakeSphere(30, 5, {0, 0, 30}), {0.6, 1, 1.4}), 0},
          {"box", test::MakeBox({-20, -15, 0}, {20, 15, 50}, 8), 0},
          {"plate", test::MakeBox({-30, -20, 0}, {30, 20, 8}, 8), 0},
          {"ring", test::MakeTorus(30, 10, 10, 120, 60), 1},
          {"bumpy", Bumpy(), 0}};
}

class ReconstructionZoo : public testing::TestWithParam<ZooShape> {};

TEST_P(ReconstructionZoo, InvariantsHold) {
  const ZooShape& shape = GetParam();
  const CleanCloud clean = CleanPoints(test::MeasureCloud(shape.mesh, 50000), {});
  const ReconstructedSurface surface =
      ReconstructSurface(clean.cloud, clean.spacing_mm, {SurfaceMethod::kAuto, 6},
                         FreeSpace({}, {}, 1), SilentProgress());
  EXPECT_EQ(surface.method, SurfaceMethod::kPoisson) << surface.reasons.back();
  const DecimatedMesh decimated = DecimateToCount(surface.mesh, 1200);
  for (const TriangleMesh* mesh : {&surface.mesh, &decimated.mesh}) {
    EXPECT_TRUE(test::IsClosedManifold(*mesh));
    EXPECT_EQ(ExamineTopology(*mesh).components, 1);
    EXPECT_EQ(ExamineTopology(*mesh).degenerate_triangles, 0);
    EXPECT_TRUE(FindSelfIntersections(*mesh).empty());
    // Euler and Poincare: V - F / 2 = 2 - 2 g.
    const auto euler = static_cast<int64_t>(mesh->vertices.size()) -
                       static_cast<int64_t>(mesh->triangles.size()) / 2;
    EXPECT_EQ(euler, 2 - 2 * shape.handles);
    const double volume = SignedVolume(shape.mesh);
    EXPECT_NEAR(SignedVolume(*mesh), volume, 0.02 * volume);
  }
  // Confidence: certainly where points lie about, certainly not where none is.
  const NearestPoints index(clean.cloud.points);
  const double reach = 2.5 * surface.cell_mm;
  for (size_t v = 0; v < surface.mesh.vertices.size(); ++v) {
    const Eigen::Vector3d& p = surface.mesh.vertices[v];
    const double distance = index.Find(p, 1).front().distance;
    if (p.z() == 0 || distance > 1.2 * std::max(reach, 3 * clean.spacing_mm)) {
      EXPECT_EQ(surface.mesh.confidence[v], 0) << p.transpose();
    } else if (distance < 0.4 * reach && p.z() > 1.5) {
      EXPECT_GT(surface.mesh.confidence[v], 0) << p.transpose();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, ReconstructionZoo, testing::ValuesIn(Zoo()),
                         [](const auto& shape) { return shape.param.name; });

}  // namespace
}  // namespace lfm
