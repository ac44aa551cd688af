// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/error.h"
#include "core/progress.h"
#include "mesh/patch_samples.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(MeshSweep, LargerTrianglesMoreErrorMoreCompression) {
  const TriangleMesh ball = test::MakeSphere(30, 4, {0, 0, 30});
  const std::vector<SweepRow> rows =
      SweepDecimation(ball, test::MakeCalib(24, 300, 30), SilentProgress());
  ASSERT_GE(rows.size(), 4u);
  for (size_t i = 1; i < rows.size(); ++i) {
    EXPECT_LT(rows[i].triangles, rows[i - 1].triangles);
    EXPECT_GE(rows[i].samples_per_triangle, rows[i - 1].samples_per_triangle);
    EXPECT_GT(rows[i].error_p95_mm, rows[i - 1].error_p95_mm);
    EXPECT_GE(rows[i].compression, rows[i - 1].compression);
  }
  const std::string csv = SweepToCsv(rows);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), static_cast<int>(rows.size()) + 1);
  const std::string svg = SweepToSvg(rows);
  EXPECT_EQ(svg.rfind("<svg", 0), 0u);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

// By hand: M = 300, N = 1024, K = 3: 3 * 300 * 1024 / (900 + 3 * (900 + 1536)).
TEST(MeshSweep, CompressionIsTheClosedForm) {
  EXPECT_NEAR(SweepCompression(300), 921600.0 / 8208, 1e-9);
  EXPECT_EQ(SweepCompression(0), 0);
}

TEST(MeshSweep, NothingToSweepIsAnError) {
  EXPECT_THROW(SweepDecimation(test::MakeSphere(1, 0, {0, 0, 30}), test::MakeCalib(6, 300, 30),
                               SilentProgress()),
               Error);
  EXPECT_THROW(SweepToSvg({}), Error);
}

// Sizes of resample/light_field.h: nested, so that neighbours share samples on their edge.
TEST(PatchSamples, AreTheFirstNestedSizeWithTwoSamplesForThreePixels) {
  EXPECT_EQ(PatchSamples(0), 10);
  EXPECT_EQ(PatchSamples(15), 10);
  EXPECT_EQ(PatchSamples(15.1), 28);
  EXPECT_EQ(PatchSamples(42), 28);
  EXPECT_EQ(PatchSamples(42.1), 91);
  EXPECT_EQ(PatchSamples(136.6), 325);
  EXPECT_EQ(PatchSamples(1e9), 1225);
}

TEST(PatchSamples, FollowWhatPhotographsShow) {
  const TriangleMesh ball = test::MakeSphere(30, 3, {0, 0, 30});
  const RayScene scene(ball);
  // 8.8 mm^2 a triangle, a pixel is 0.16 mm: some 340 pixels.
  EXPECT_NEAR(PredictSamplesPerTriangle(ball, scene, test::MakeCalib(24, 300, 30)), 325, 80);
  // Ten times as far: a hundredth of the pixels.
  EXPECT_EQ(PredictSamplesPerTriangle(ball, scene, test::MakeCalib(24, 3000, 30)), 10);
  EXPECT_EQ(PredictSamplesPerTriangle({}, scene, test::MakeCalib(24, 3000, 30)), 0);
}

}  // namespace
}  // namespace lfm
