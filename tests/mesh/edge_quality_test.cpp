// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/edge_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/decimation.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

struct Shapes {
  TriangleMesh before, after, surface;
};

Shapes ImproveTorus() {
  Shapes shapes;
  shapes.surface = test::MakeTorus(30, 10, 10, 240, 100);
  Decimation decimation(shapes.surface);
  decimation.ReduceTo(1500);
  shapes.before = decimation.Mesh();
  shapes.after = ImproveTriangles(shapes.before, RayScene(shapes.surface),
                                  SampleSurface(shapes.surface, 30000, 1));
  return shapes;
}

TEST(EdgeQuality, AnglesGrowErrorShrinksTopologyStays) {
  const Shapes shapes = ImproveTorus();
  EXPECT_TRUE(test::IsClosedManifold(shapes.after));
  EXPECT_EQ(shapes.after.triangles.size(), shapes.before.triangles.size());
  EXPECT_EQ(shapes.after.vertices.size(), shapes.before.vertices.size());
  const auto before = test::SmallestAngles(shapes.before),
             after = test::SmallestAngles(shapes.after);
  EXPECT_GT(after[after.size() / 20], before[before.size() / 20] + 3);
  EXPECT_GT(after[after.size() / 2], 38);
  EXPECT_GT(after.front(), 10);
  const auto samples = SampleSurface(shapes.surface, 10000, 2).points;
  const double error_before = SummarizeDistances(DistancesToMesh(samples, shapes.before)).mean;
  const double error_after = SummarizeDistances(DistancesToMesh(samples, shapes.after)).mean;
  EXPECT_LT(error_after, 1.05 * error_before);
}

// Six triangles about a vertex is the mean on a torus; few have many more or fewer.
TEST(EdgeQuality, ValencesStayNearSix) {
  const TriangleMesh mesh = ImproveTorus().after;
  std::vector<int> valence(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++valence[t[k]];
  }
  EXPECT_GE(*std::min_element(valence.begin(), valence.end()), 3);
  EXPECT_LE(*std::max_element(valence.begin(), valence.end()), 9);
  const auto near_six =
      std::count_if(valence.begin(), valence.end(), [](int n) { return n >= 5 && n <= 7; });
  EXPECT_GT(static_cast<double>(near_six), 0.93 * static_cast<double>(valence.size()));
}

TEST(EdgeQuality, FlipsMakeALongQuadDelaunay) {
  TriangleMesh mesh;  // a rhombus with the long diagonal
  mesh.vertices = {{-3, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  const TriangleMesh flipped = FlipTowardsDelaunay(mesh);
  for (const auto& t : flipped.triangles) {
    EXPECT_EQ((t.array() == 2).count() + (t.array() == 3).count(), 2);
    EXPECT_GT(TriangleNormal(flipped, 0).z(), 0.99);
  }
}

TEST(EdgeQuality, CreasesAreNotFlippedAway) {
  const TriangleMesh box = test::MakeBox({0, 0, 0}, {10, 10, 10}, 4);
  const TriangleMesh flipped = FlipTowardsDelaunay(box);
  EXPECT_NEAR(SignedVolume(flipped), 1000, 1e-9);
  const TriangleMesh improved = ImproveTriangles(box, RayScene(box), SampleSurface(box, 5000, 1));
  EXPECT_NEAR(SignedVolume(improved), 1000, 1);
}

}  // namespace
}  // namespace lfm
