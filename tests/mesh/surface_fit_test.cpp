// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(SurfaceFit, InscribedSphereComesToStraddleTheSurface) {
  const TriangleMesh fine = test::MakeSphere(30, 6), coarse = test::MakeSphere(30, 2);
  const TriangleMesh fitted = FitToSurface(coarse, SampleSurface(fine, 10000, 1), {});
  const auto samples = SampleSurface(fine, 5000, 2).points;
  const double before = SummarizeDistances(DistancesToMesh(samples, coarse)).mean;
  const double after = SummarizeDistances(DistancesToMesh(samples, fitted)).mean;
  EXPECT_LT(after, 0.5 * before);
  EXPECT_NEAR(SignedVolume(fitted), SignedVolume(fine), 0.005 * SignedVolume(fine));
}

TEST(SurfaceFit, FixedVerticesStay) {
  const TriangleMesh coarse = test::MakeSphere(30, 2);
  std::vector<char> fixed(coarse.vertices.size(), 0);
  fixed[0] = fixed[9] = 1;
  const auto samples = SampleSurface(test::MakeSphere(30.5, 5), 5000, 1);
  const TriangleMesh fitted = FitToSurface(coarse, samples, fixed);
  for (size_t v = 0; v < fixed.size(); ++v) {
    const double moved = (fitted.vertices[v] - coarse.vertices[v]).norm();
    if (fixed[v]) {
      EXPECT_EQ(moved, 0);
    } else {
      EXPECT_GT(moved, 0.2);
    }
  }
}

TEST(SurfaceFit, MovesThatWouldFlipAreHeldBack) {
  TriangleMesh coarse = test::MakeSphere(30, 3);
  coarse.vertices[20] *= 0.98;
  // Samples on a wildly dented surface.
  SurfaceSamples samples = SampleSurface(coarse, 20000, 1);
  for (size_t i = 0; i < samples.points.size(); ++i) {
    samples.points[i] += 4 * std::sin(samples.points[i].x()) * samples.normals[i];
  }
  const TriangleMesh fitted = FitToSurface(coarse, samples, {});
  for (size_t t = 0; t < coarse.triangles.size(); ++t) {
    const int i = static_cast<int>(t);
    EXPECT_GE(TriangleNormal(coarse, i).dot(TriangleNormal(fitted, i)), 0.7);
  }
}

TEST(SurfaceFit, NoSamplesNoMove) {
  const TriangleMesh coarse = test::MakeSphere(30, 1);
  EXPECT_TRUE(FitToSurface(coarse, {}, {}).vertices == coarse.vertices);
}

}  // namespace
}  // namespace lfm
