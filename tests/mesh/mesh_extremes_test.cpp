// SPDX-License-Identifier: BSD-3-Clause
// Clouds at the edge of what a surface can be made of.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/process_memory.h"
#include "core/progress.h"
#include "mesh/mesh.h"
#include "mesh/self_intersection.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

using test::ErrorOf;

const Eigen::Vector3d kCenter(0, 0, 30);

MeshOptions Coarse() {
  MeshOptions options;
  options.poisson_depth = 6;
  options.triangle_count = 800;
  return options;
}

MeshResult Build(const PointCloud& cloud, const CalibResult& calib = test::MakeCalib(12, 300, 30)) {
  return BuildMesh(cloud, {}, calib, Coarse(), SilentProgress());
}

std::string Failure(const PointCloud& cloud) {
  return ErrorOf([&] { Build(cloud); });
}

PointCloud Ball(int count = 20000) {
  return test::MeasureCloud(test::MakeSphere(30, 5, kCenter), count);
}

void ExpectSound(const MeshResult& result) {
  for (const TriangleMesh* mesh : {&result.surface, &result.mesh}) {
    EXPECT_TRUE(test::IsClosedManifold(*mesh));
    EXPECT_TRUE(FindSelfIntersections(*mesh).empty());
    EXPECT_GT(SignedVolume(*mesh), 0);
    for (const Eigen::Vector3d& v : mesh->vertices) ASSERT_TRUE(v.allFinite());
  }
}

TEST(MeshExtremes, TenPoints) {
  PointCloud ten = Ball();
  ten.points.resize(10);
  ten.normals.resize(10);
  ten.confidence.resize(10);
  EXPECT_NE(Failure(ten).find("only 10 points"), std::string::npos);
  ten.normals.clear();
  ten.confidence.clear();
  EXPECT_NE(Failure(ten).find("points"), std::string::npos);
}

TEST(MeshExtremes, NoPoints) { EXPECT_NE(Failure({}).find("empty"), std::string::npos); }

TEST(MeshExtremes, APlaneOnly) {
  PointCloud plane;
  for (int i = 0; i < 10000; ++i) {
    plane.points.emplace_back(0, i % 100 * 0.5 - 25, i / 100 * 0.5 + 1);
    plane.normals.emplace_back(1, 0, 0);
  }
  EXPECT_NE(Failure(plane).find("plane"), std::string::npos);
  plane.normals.clear();
  EXPECT_NE(Failure(plane).find("plane"), std::string::npos);
}

TEST(MeshExtremes, PointsThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    PointCloud cloud = Ball();
    cloud.points[77].y() = bad;
    EXPECT_NE(Failure(cloud).find("point 77 is not finite"), std::string::npos);
    cloud = Ball();
    cloud.normals[78].x() = bad;
    EXPECT_NE(Failure(cloud).find("point 78 is not finite"), std::string::npos);
  }
}

TEST(MeshExtremes, EveryPointThreeTimes) {
  const PointCloud once = Ball();
  PointCloud thrice = once;
  for (int i = 0; i < 2; ++i) test::Append(thrice, once);
  const MeshResult a = Build(once), b = Build(thrice);
  ExpectSound(b);
  EXPECT_NEAR(SignedVolume(a.surface), SignedVolume(b.surface), 0.005 * SignedVolume(a.surface));
}

// The world lies ten metres away; cameras too.
TEST(MeshExtremes, TenMetresFromTheOrigin) {
  const Eigen::Vector3d far(10000, -10000, 0);
  PointCloud cloud = Ball();
  for (Eigen::Vector3d& p : cloud.points) p += far;
  CalibResult calib = test::MakeCalib(12, 300, 30);
  for (PosedImage& photo : calib.photos) {
    photo.camera_from_world.translation -= photo.camera_from_world.rotation * far;
  }
  const MeshResult here = Build(Ball()), there = Build(cloud, calib);
  ExpectSound(there);
  EXPECT_NEAR(SignedVolume(there.surface), SignedVolume(here.surface),
              1e-3 * SignedVolume(here.surface));
  EXPECT_NEAR(there.pixel_mm, here.pixel_mm, 1e-3 * here.pixel_mm);
}

// Only what faces +x was scanned: the rest is closed somehow, and marked.
TEST(MeshExtremes, HalfOfTheObjectUnseen) {
  const PointCloud all = Ball(40000);
  PointCloud half;
  for (size_t i = 0; i < all.points.size(); ++i) {
    if (all.points[i].x() < 3) continue;
    half.points.push_back(all.points[i]);
    half.normals.push_back(all.normals[i]);
    half.confidence.push_back(all.confidence[i]);
  }
  const MeshResult result = Build(half);
  ExpectSound(result);
  int measured = 0, closed = 0;
  for (size_t v = 0; v < result.surface.vertices.size(); ++v) {
    const Eigen::Vector3d& p = result.surface.vertices[v];
    if (p.x() > 6 && p.z() > 6) {
      EXPECT_GT(result.surface.confidence[v], 0);
      EXPECT_NEAR((p - kCenter).norm(), 30, 0.5);
      ++measured;
    }
    if (p.x() < -3) {
      EXPECT_EQ(result.surface.confidence[v], 0);
      ++closed;
    }
  }
  EXPECT_GT(measured, 500);
  EXPECT_GT(closed, 50);
}

// Normals that say nothing: wrapped, not turned inside out.
TEST(MeshExtremes, NormalsAtRandom) {
  PointCloud cloud = Ball();
  for (size_t i = 0; i < cloud.normals.size(); ++i) {
    cloud.normals[i] = Eigen::Vector3d(std::sin(3.0 * i), std::sin(7.0 * i), std::cos(11.0 * i));
  }
  const MeshResult result = Build(cloud);
  EXPECT_EQ(result.method, "wrap");
  ExpectSound(result);
  const double ball = 4.0 / 3 * std::numbers::pi * 27000;
  EXPECT_GT(SignedVolume(result.surface), 0.85 * ball);
  EXPECT_LT(SignedVolume(result.surface), 1.15 * ball);
}

// With sanitizers, whose own memory would be measured, a tenth of the points.
TEST(MeshExtremes, TwentyMillionPointsWithinFourGib) {
#if defined(__SANITIZE_ADDRESS__)
  constexpr int64_t kPoints = 2000000;
#else
  constexpr int64_t kPoints = 20000000;
#endif
  constexpr double kMostMib = 4096;
  MeshOptions options;
  options.triangle_count = 10000;
  const MeshResult result = BuildMesh(test::MakeBumpyBall(kPoints), {},
                                      test::MakeCalib(24, 400, 40), options, SilentProgress());
  ExpectSound(result);
  EXPECT_LE(result.mesh.triangles.size(), 10000U);
  EXPECT_GT(result.mesh.triangles.size(), 9000U);
  EXPECT_LT(PeakMemoryMib(), kMostMib);
}

}  // namespace
}  // namespace lfm
