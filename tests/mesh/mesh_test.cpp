// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "mesh/error_bound.h"
#include "mesh/self_intersection.h"
#include "tests/core/mesh_zoo.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

using test::ErrorOf;

const Eigen::Vector3d kCenter(0, 0, 30);

PointCloud Capture(int count = 30000) {
  PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 5, kCenter), count);
  test::AddPlatform(cloud, 8000, 90, 32, 0.1, 2);
  test::AddOutliers(cloud, 100, 90, 90, 3);
  return cloud;
}

MeshOptions Coarse() {
  MeshOptions options;
  options.poisson_depth = 6;
  return options;
}

MeshResult Build(const MeshOptions& options, const PointCloud& cloud = Capture()) {
  return BuildMesh(cloud, {}, test::MakeCalib(24, 300, 30), options, SilentProgress());
}

TEST(BuildMesh, CoarsestMeshWithinHalfAPixel) {
  const MeshResult result = Build(Coarse());
  for (const TriangleMesh* mesh : {&result.surface, &result.mesh}) {
    EXPECT_TRUE(test::IsClosedManifold(*mesh));
    EXPECT_TRUE(FindSelfIntersections(*mesh).empty());
    EXPECT_EQ(ExamineTopology(*mesh).components, 1);
    EXPECT_EQ(mesh->confidence.size(), mesh->vertices.size());
    EXPECT_EQ(mesh->normals.size(), mesh->vertices.size());
    double worst_above = 0;
    bool some_measured = false, some_closed = false;
    for (size_t v = 0; v < mesh->vertices.size(); ++v) {
      some_measured |= mesh->confidence[v] > 0.3;
      some_closed |= mesh->confidence[v] == 0;
      if (mesh->vertices[v].z() < 6) continue;
      worst_above = std::max(worst_above, std::abs((mesh->vertices[v] - kCenter).norm() - 30));
      EXPECT_GT(mesh->confidence[v], 0);
    }
    EXPECT_LT(worst_above, 0.4);
    EXPECT_TRUE(some_measured);
    EXPECT_TRUE(some_closed);
  }
  // From 300 mm, the sphere's near half lies 270 to 300 mm away.
  EXPECT_NEAR(result.pixel_mm, 280.0 / 1700, 8.0 / 1700);
  EXPECT_LE(result.deviation_p95_mm, 0.5 * result.pixel_mm);
  EXPECT_GT(result.deviation_p95_mm, 0.4 * result.pixel_mm);
  EXPECT_LT(result.mesh.triangles.size(), result.surface.triangles.size() / 3);
  EXPECT_GT(test::SmallestAngles(result.mesh).front(), 5);
}

TEST(BuildMesh, OtherTargets) {
  MeshOptions options = Coarse();
  options.triangle_count = 700;
  EXPECT_NEAR(static_cast<double>(Build(options).mesh.triangles.size()), 700, 20);

  // At one of the sizes that resampling has.
  options = Coarse();
  options.samples_per_triangle = 91;
  const MeshResult samples = Build(options);
  EXPECT_NEAR(samples.samples_per_triangle, 91, 0.05 * 91);

  options = Coarse();
  options.max_error_mm = 0.4;
  const MeshResult bounded = Build(options);
  EXPECT_LE(bounded.deviation_max_mm, 0.4);
  EXPECT_TRUE(IsWithin(bounded.mesh, bounded.surface, RayScene(bounded.surface), 0.4));
  EXPECT_TRUE(IsWithin(bounded.surface, bounded.mesh, RayScene(bounded.mesh), 0.4));
  EXPECT_LT(bounded.mesh.triangles.size(), bounded.surface.triangles.size() / 3);
}

TEST(MeshOptions, OneTargetAtMost) {
  const auto message = [](const MeshOptions& options) {
    return ErrorOf([checked = options]() mutable { ValidateOptions(AnyOptions(checked)); });
  };
  MeshOptions options;
  options.triangle_count = 500;
  EXPECT_EQ(message(options), "");
  options.max_error_mm = 1;
  EXPECT_EQ(message(options).find("--triangle-count and --max-error-mm are targets"), 0u);
  options.samples_per_triangle = 200;
  EXPECT_EQ(message(options).find(
                "--samples-per-triangle, --triangle-count and --max-error-mm are targets"),
            0u);
  EXPECT_EQ(ErrorOf([&] { Build(options); }), message(options));
}

// From so near that, if test photographs had a say, the object's top would lie beyond the cameras.
TEST(BuildMesh, TestPhotographsHaveNoSay) {
  const PointCloud cloud = Capture(10000);
  const auto build = [&](double test_distance_mm) {
    CalibResult calib = test::MakeCalib(8, 300, 30);
    for (PosedImage photo : test::MakeCalib(40, test_distance_mm, 30).photos) {
      photo.split = PhotoSplit::kTest;
      calib.photos.push_back(photo);
    }
    MeshOptions options = Coarse();
    options.poisson_depth = 5;
    return BuildMesh(cloud, {}, calib, options, SilentProgress());
  };
  const MeshResult far = build(310), near = build(32);
  EXPECT_TRUE(far.surface.vertices == near.surface.vertices);
  EXPECT_TRUE(far.surface.triangles == near.surface.triangles);
  EXPECT_TRUE(far.mesh.vertices == near.mesh.vertices);
  EXPECT_TRUE(far.mesh.triangles == near.mesh.triangles);
  EXPECT_EQ(far.pixel_mm, near.pixel_mm);
}

TEST(BuildMesh, SameBytesForEveryNumberOfThreads) {
  const PointCloud cloud = Capture(20000);
  SetThreadCount(1);
  const MeshResult one = Build(Coarse(), cloud);
  SetThreadCount(3);
  const MeshResult three = Build(Coarse(), cloud);
  SetThreadCount(0);
  EXPECT_TRUE(one.surface.vertices == three.surface.vertices);
  EXPECT_TRUE(one.surface.triangles == three.surface.triangles);
  EXPECT_TRUE(one.surface.confidence == three.surface.confidence);
  EXPECT_TRUE(one.mesh.vertices == three.mesh.vertices);
  EXPECT_TRUE(one.mesh.triangles == three.mesh.triangles);
  EXPECT_TRUE(one.mesh.confidence == three.mesh.confidence);
  EXPECT_EQ(one.pixel_mm, three.pixel_mm);
  EXPECT_EQ(one.deviation_mean_mm, three.deviation_mean_mm);
}

TEST(BuildMesh, BadInput) {
  EXPECT_NE(ErrorOf([] { Build({}, {}); }).find("empty"), std::string::npos);
  PointCloud platform;
  test::AddPlatform(platform, 5000, 90, 0, 0.1, 1);
  EXPECT_NE(ErrorOf([&] { Build({}, platform); }).find("platform"), std::string::npos);
  MeshOptions options;
  options.poisson_depth = 99;
  EXPECT_NE(ErrorOf([&] { Build(options); }).find("poisson-depth"), std::string::npos);
  EXPECT_NE(ErrorOf([&] { BuildMesh(Capture(5000), {}, {}, Coarse(), SilentProgress()); }), "");
}

TEST(BuildMesh, CloudWithoutNormals) {
  PointCloud bare = Capture();
  bare.normals.clear();
  bare.confidence.clear();
  const MeshResult result = Build(Coarse(), bare);
  EXPECT_EQ(result.method, "poisson");
  for (const Eigen::Vector3d& v : result.surface.vertices) {
    if (v.z() > 6) {
      EXPECT_NEAR((v - kCenter).norm(), 30, 0.5);
    }
  }
}

CalibResult GivenCalib() { return test::MakeCalib(24, 300, 30); }

TEST(GivenMesh, CoarseOneStaysAsItIs) {
  const TriangleMesh given = test::MakeSphere(30, 3, kCenter);  // 8.8 mm^2 a triangle
  const MeshResult result = PrepareGivenMesh(given, GivenCalib(), {}, SilentProgress());
  EXPECT_TRUE(result.mesh.vertices == given.vertices);
  EXPECT_TRUE(result.mesh.triangles == given.triangles);
  EXPECT_TRUE(result.surface.vertices == given.vertices);
  EXPECT_EQ(result.deviation_p95_mm, 0);
  EXPECT_NEAR(result.pixel_mm, 280.0 / 1700, 8.0 / 1700);
  EXPECT_EQ(result.mesh.normals.size(), given.vertices.size());
  for (const float c : result.mesh.confidence) EXPECT_EQ(c, 1);
}

TEST(GivenMesh, FineOneIsDecimated) {
  const TriangleMesh given = test::MakeSphere(30, 5, kCenter);  // 0.55 mm^2, 20 pixels a triangle
  const MeshResult result = PrepareGivenMesh(given, GivenCalib(), {}, SilentProgress());
  EXPECT_LT(result.mesh.triangles.size(), given.triangles.size() / 2);
  EXPECT_EQ(result.surface.triangles.size(), given.triangles.size());
  EXPECT_LE(result.deviation_p95_mm, 0.5 * result.pixel_mm);
  MeshOptions options;
  options.triangle_count = 500;
  EXPECT_NEAR(
      static_cast<double>(
          PrepareGivenMesh(given, GivenCalib(), options, SilentProgress()).mesh.triangles.size()),
      500, 10);
  options = {};
  options.samples_per_triangle = 10;
  EXPECT_EQ(PrepareGivenMesh(given, GivenCalib(), options, SilentProgress()).mesh.triangles.size(),
            given.triangles.size());
}

// A head that sits halfway in a body: parting the two would shrink it away.
const Eigen::Vector3d kHeadCenter = kCenter + Eigen::Vector3d(30, 0, 0);

MeshResult Decimate(const TriangleMesh& given) {
  MeshOptions options;
  options.triangle_count = 900;
  return PrepareGivenMesh(given, GivenCalib(), options, SilentProgress());
}

double Farthest(const TriangleMesh& mesh) {
  double farthest = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) farthest = std::max(farthest, v.x() - kCenter.x());
  return farthest;
}

TEST(GivenMesh, PartsThatCrossBecomeOneSurface) {
  const MeshResult result =
      Decimate(Join(test::MakeSphere(30, 5, kCenter), test::MakeSphere(9, 4, kHeadCenter)));
  EXPECT_TRUE(test::IsClosedManifold(result.surface));
  EXPECT_EQ(ExamineTopology(result.mesh).components, 1);
  EXPECT_EQ(result.surface_self_intersections, 0);
  EXPECT_EQ(result.mesh_self_intersections, 0);
  EXPECT_LE(result.mesh.triangles.size(), 900u);
  EXPECT_LT(result.deviation_max_mm, 1);
  EXPECT_NEAR(Farthest(result.mesh), 39, 0.7);
}

TEST(GivenMesh, PartsThatCrossAndHaveNoUnionKeepTheirShape) {
  TriangleMesh head = test::MakeSphere(9, 4, kHeadCenter);
  head.triangles.pop_back();
  const MeshResult result = Decimate(Join(test::MakeSphere(30, 5, kCenter), head));
  EXPECT_GT(result.surface_self_intersections, 0);
  EXPECT_EQ(ExamineTopology(result.mesh).components, 2);
  EXPECT_LT(result.deviation_max_mm, 1);
  EXPECT_NEAR(Farthest(result.mesh), 39, 0.7);
}

TEST(GivenMesh, PartsAHairApartKeepTheirShape) {
  const TriangleMesh given = Join(test::MakeBox({-20, -20, 0}, {0, 20, 40}, 24),
                                  test::MakeBox({1e-9, -20, 0}, {20, 20, 40}, 24));
  MeshOptions options;
  options.triangle_count = 300;
  const MeshResult result = PrepareGivenMesh(given, GivenCalib(), options, SilentProgress());
  EXPECT_LT(result.deviation_max_mm, 0.5);
}

TEST(GivenMesh, WhatNoPhotographSeesNamesTheFile) {
  for (const double away : {1e5, 1e30}) {
    TriangleMesh far = test::MakeSphere(30, 3, kCenter);
    for (Eigen::Vector3d& v : far.vertices) v.x() += away;
    const std::string what = ErrorOf(
        [&] { PrepareGivenMesh(far, GivenCalib(), {}, SilentProgress(), {}, "toy/mesh.ply"); });
    EXPECT_EQ(what.rfind("toy/mesh.ply: ", 0), 0u) << what;
  }
}

TEST(GivenMesh, OpenIsAllowedInsideOutIsTurned) {
  TriangleMesh open = test::MakeSphere(30, 3, kCenter);
  open.triangles.resize(open.triangles.size() - 40);
  EXPECT_EQ(PrepareGivenMesh(open, GivenCalib(), {}, SilentProgress()).mesh.triangles.size(),
            open.triangles.size());
  TriangleMesh inside_out = test::MakeSphere(30, 3, kCenter);
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_GT(SignedVolume(PrepareGivenMesh(inside_out, GivenCalib(), {}, SilentProgress()).surface),
            0);
}

TEST(GivenMesh, NonManifoldIsAnError) {
  const auto message = [](const TriangleMesh& mesh) {
    return ErrorOf([&] { PrepareGivenMesh(mesh, GivenCalib(), {}, SilentProgress()); });
  };
  TriangleMesh fin = test::MakeSphere(30, 2, kCenter);
  fin.vertices.emplace_back(0, 0, 100);
  fin.triangles.emplace_back(fin.triangles[0][0], fin.triangles[0][1],
                             static_cast<int>(fin.vertices.size()) - 1);
  EXPECT_NE(message(fin), "");
  TriangleMesh twisted = test::MakeSphere(30, 2, kCenter);
  std::swap(twisted.triangles[4][0], twisted.triangles[4][1]);
  EXPECT_NE(message(twisted).find("opposite"), std::string::npos);
  EXPECT_NE(message({}), "");
  TriangleMesh out_of_range = test::MakeSphere(30, 2, kCenter);
  out_of_range.triangles[3][1] = 1 << 20;
  EXPECT_NE(message(out_of_range), "");
  TriangleMesh infinite = test::MakeSphere(30, 2, kCenter);
  infinite.vertices[3].z() = INFINITY;
  EXPECT_NE(message(infinite), "");
}

}  // namespace
}  // namespace lfm
