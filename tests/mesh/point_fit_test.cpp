// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/point_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/surface_distance.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

constexpr double kRadiusMm = 20, kHeightMm = 25;

// A ball over the platform with ridges 5 mm apart, `amplitude` high.
TriangleMesh Ridged(double amplitude, int splits) {
  TriangleMesh mesh = test::MakeSphere(kRadiusMm, splits);
  for (Eigen::Vector3d& v : mesh.vertices) {
    v *= 1 + amplitude / kRadiusMm * std::sin(2 * M_PI * v.x() / 5);
    v.z() += kHeightMm;
  }
  mesh.normals = ComputeVertexNormals(mesh);
  return mesh;
}

double MeanError(const TriangleMesh& mesh, const TriangleMesh& truth) {
  return SummarizeDistances(DistancesToMesh(SampleSurface(truth, 10000, 2).points, mesh)).mean;
}

TEST(PointFit, BringsBackRidgesThatWereSmoothedAway) {
  const TriangleMesh truth = Ridged(0.3, 6), smoothed = Ridged(0.15, 6);
  const PointCloud points = test::MeasureCloud(truth, 60000, {.along_normal_mm = 0.02});
  const double before = MeanError(smoothed, truth);
  const double after = MeanError(FitToPoints(smoothed, points, 0.5), truth);
  EXPECT_GT(before, 0.08);
  EXPECT_LT(after, 0.25 * before);
}

TEST(PointFit, ASurfaceThatFitsStays) {
  const TriangleMesh truth = Ridged(0.3, 6);
  const PointCloud points = test::MeasureCloud(truth, 60000, {.along_normal_mm = 0});
  EXPECT_LT(MeanError(FitToPoints(truth, points, 0.5), truth), 0.002);
}

TEST(PointFit, WhatNoPointIsNearStaysAndNothingLeavesThePlatform) {
  TriangleMesh mesh = Ridged(0, 4);
  for (Eigen::Vector3d& v : mesh.vertices) v.z() = std::max(0.0, v.z() - 15);  // cut at z = 0
  TriangleMesh grown = mesh;
  for (Eigen::Vector3d& v : grown.vertices) v += 0.3 * (v - Eigen::Vector3d(0, 0, 5)).normalized();
  const PointCloud all = test::MeasureCloud(grown, 60000, {.hidden_below_normal_z = -2});
  PointCloud points;
  for (size_t i = 0; i < all.points.size(); ++i) {
    if (all.points[i].x() < 0) continue;
    points.points.push_back(all.points[i]);
    points.normals.push_back(all.normals[i]);
    points.confidence.push_back(all.confidence[i]);
  }
  const TriangleMesh fitted = FitToPoints(mesh, points, 0.6);
  int moved = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double distance = (fitted.vertices[v] - mesh.vertices[v]).norm();
    if (mesh.vertices[v].x() < -2) {
      EXPECT_EQ(distance, 0) << v;
    }
    if (mesh.vertices[v].z() <= 0) {
      EXPECT_EQ(fitted.vertices[v].z(), mesh.vertices[v].z()) << v;  // walls' ends move sideways
    }
    moved += distance > 0.1;
  }
  EXPECT_GT(moved, 100);
}

TEST(PointFit, PointsOfTheOtherSideOfAThinSheetDoNotPull) {
  TriangleMesh square = test::MakeSquare(20, 5, 40);
  PointCloud points;
  for (int i = 0; i < 10000; ++i) {
    points.points.emplace_back(-9 + 18.0 * (i % 100) / 99, -9 + 18.0 * (i / 100) / 99, 4.7);
    points.normals.emplace_back(0, 0, -1);
    points.confidence.push_back(1);
  }
  EXPECT_EQ(FitToPoints(square, points, 0.5).vertices, square.vertices);
  for (Eigen::Vector3d& n : points.normals) n.z() = 1;
  const TriangleMesh pulled = FitToPoints(square, points, 0.5);
  EXPECT_LT(MeanError(pulled, test::MakeSquare(18, 4.7, 1)), 0.05);
}

TEST(PointFit, ScatteredPointsTurnNoTriangle) {
  const TriangleMesh mesh = Ridged(0.1, 5);
  PointCloud points = test::MeasureCloud(mesh, 20000, {.along_normal_mm = 0.8});
  const TriangleMesh fitted = FitToPoints(mesh, points, 0.5);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int i = static_cast<int>(t);
    EXPECT_GT(TriangleNormal(mesh, i).dot(TriangleNormal(fitted, i)), -0.1);
  }
  EXPECT_EQ(FitToPoints(mesh, PointCloud(), 0.5).vertices, mesh.vertices);
}

}  // namespace
}  // namespace lfm
