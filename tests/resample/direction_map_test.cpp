// SPDX-License-Identifier: BSD-3-Clause
#include "resample/direction_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "test_scenes.h"

namespace lfm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class DirectionMaps : public testing::TestWithParam<DirectionMap> {};
INSTANTIATE_TEST_SUITE_P(All, DirectionMaps,
                         testing::Values(DirectionMap::kHemiOctahedral, DirectionMap::kOrthographic,
                                         DirectionMap::kHemiOctahedralSkirt));

double LowestZ(DirectionMap map) { return map == DirectionMap::kHemiOctahedralSkirt ? -kSkirt : 0; }

Eigen::Vector3d RandomUpward(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Vector3d d(normal(random), normal(random), std::abs(normal(random)));
  return d.normalized();
}

TEST_P(DirectionMaps, RoundTripsEveryDirectionAboveTheHorizon) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d d = RandomUpward(random);
    const Eigen::Vector2d square = SquareFromDirection(GetParam(), d);
    EXPECT_GE(square.minCoeff(), 0);
    EXPECT_LE(square.maxCoeff(), 1);
    EXPECT_LT((DirectionFromSquare(GetParam(), square) - d).norm(), 1e-7);
  }
}

TEST_P(DirectionMaps, MovesDirectionsBelowTheLowestOntoThem) {
  std::mt19937 random(2);
  const double lowest = LowestZ(GetParam());
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector3d d = RandomUpward(random);
    const double height = lowest - (1 + lowest) * d.z();
    const double azimuth = std::atan2(d.y(), d.x());
    const auto at = [&](double z) {
      const double radius = std::sqrt(1 - z * z);
      return Eigen::Vector3d(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    };
    EXPECT_LT(
        (SquareFromDirection(GetParam(), at(height)) - SquareFromDirection(GetParam(), at(lowest)))
            .norm(),
        1e-12);
  }
  EXPECT_EQ(SquareFromDirection(GetParam(), {0, 0, -1}), Eigen::Vector2d(0.5, 0.5));
}

TEST_P(DirectionMaps, IsContinuousAcrossAxesAndHorizon) {
  const double step = 1e-6;
  for (int i = 0; i < 360; ++i) {
    const double azimuth = i * std::numbers::pi / 180;
    for (const double z : {-0.3, 0.0, 0.4, 0.9}) {
      const auto direction = [&](double a, double height) {
        const double r = std::sqrt(1 - height * height);
        return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), height);
      };
      const Eigen::Vector2d here = SquareFromDirection(GetParam(), direction(azimuth, z));
      const Eigen::Vector2d beside = SquareFromDirection(GetParam(), direction(azimuth + step, z));
      const Eigen::Vector2d above = SquareFromDirection(GetParam(), direction(azimuth, z + step));
      EXPECT_LT((here - beside).norm(), 10 * step);
      EXPECT_LT((here - above).norm(), 10 * step);
    }
  }
}

TEST_P(DirectionMaps, GivesNumbersForAnything) {
  for (const Eigen::Vector3d& d :
       {Eigen::Vector3d(kNan, 0, 1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(HUGE_VAL, 0, 0),
        Eigen::Vector3d(1e-200, 0, -1), Eigen::Vector3d(1e-320, 1e-320, 0)}) {
    const Eigen::Vector2d square = SquareFromDirection(GetParam(), d);
    EXPECT_TRUE(square.allFinite()) << d.transpose();
    EXPECT_GE(square.minCoeff(), 0);
    EXPECT_LE(square.maxCoeff(), 1);
  }
  for (const Eigen::Vector2d& s :
       {Eigen::Vector2d(kNan, 0), Eigen::Vector2d(-3, 7), Eigen::Vector2d(HUGE_VAL, 0.5),
        Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)}) {
    const Eigen::Vector3d d = DirectionFromSquare(GetParam(), s);
    EXPECT_NEAR(d.norm(), 1, 1e-12) << s.transpose();
    EXPECT_GE(d.z(), LowestZ(GetParam()) - 1e-12);
  }
}

TEST_P(DirectionMaps, GridEntriesAreCornerAligned) {
  const int grid = 9;
  EXPECT_LT((GridDirection(GetParam(), grid, grid * grid / 2) - Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
  // Entry (1, 2) of a 9 x 9 grid lies at (1/8, 2/8).
  const Eigen::Vector3d d = GridDirection(GetParam(), grid, 2 * grid + 1);
  EXPECT_LT((d - DirectionFromSquare(GetParam(), {0.125, 0.25})).norm(), 1e-15);
}

TEST(DirectionMap, OrthographicIsEquation7) {
  const Eigen::Vector3d d(0.6, -0.2, std::sqrt(1 - 0.36 - 0.04));
  EXPECT_LT(
      (SquareFromDirection(DirectionMap::kOrthographic, d) - Eigen::Vector2d(0.8, 0.4)).norm(),
      1e-15);
}

TEST(DirectionMap, HemiOctahedralPutsTheHorizonOnTheBorder) {
  EXPECT_EQ(SquareFromDirection(DirectionMap::kHemiOctahedral, {1, 0, 0}), Eigen::Vector2d(1, 1));
  EXPECT_EQ(SquareFromDirection(DirectionMap::kHemiOctahedral, {0, 1, 0}), Eigen::Vector2d(1, 0));
  EXPECT_EQ(SquareFromDirection(DirectionMap::kHemiOctahedral, {-1, 0, 0}), Eigen::Vector2d(0, 0));
}

TEST(DirectionMap, SkirtHoldsDirectionsBelowTheHorizon) {
  constexpr auto kMap = DirectionMap::kHemiOctahedralSkirt;
  for (int i = 0; i < 360; ++i) {
    const double azimuth = i * std::numbers::pi / 180;
    for (const double z : {-kSkirt + 1e-9, -0.2, -1e-9, 0.0, 1e-9, 0.1}) {
      const double radius = std::sqrt(1 - z * z);
      const Eigen::Vector3d d(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
      EXPECT_LT((DirectionFromSquare(kMap, SquareFromDirection(kMap, d)) - d).norm(), 1e-7);
    }
  }
  const double radius = std::sqrt(1 - kSkirt * kSkirt);
  EXPECT_LT((SquareFromDirection(kMap, {radius, 0, -kSkirt}) - Eigen::Vector2d(1, 1)).norm(),
            1e-12);
  // In the middle texels lie as close as without a skirt.
  const Eigen::Vector3d tilted = Eigen::Vector3d(0.01, 0, 1).normalized();
  const double without =
      (SquareFromDirection(DirectionMap::kHemiOctahedral, tilted) - Eigen::Vector2d(0.5, 0.5))
          .norm();
  EXPECT_NEAR((SquareFromDirection(kMap, tilted) - Eigen::Vector2d(0.5, 0.5)).norm(), without,
              0.01 * without);
}

void ExpectRightHanded(const Eigen::Matrix3d& frame) {
  EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(frame.determinant(), 1, 1e-12);
}

TEST(VertexFrames, AreOrthonormalRightHandedWithTheNormalAsZ) {
  const TriangleMesh mesh = test::Torus(30, 10, 16, 8);
  const auto frames = ComputeVertexFrames(mesh);
  ASSERT_EQ(frames.size(), mesh.vertices.size());
  for (size_t v = 0; v < frames.size(); ++v) {
    ExpectRightHanded(frames[v]);
    EXPECT_LT((frames[v].col(2) - mesh.normals[v]).norm(), 1e-12);
  }
}

TEST(VertexFrames, PointXAlongTheFirstNeighbour) {
  const TriangleMesh mesh = test::Sphere({5, 6, 7}, 10, 1);
  const auto frames = ComputeVertexFrames(mesh);
  const VertexRings rings = ComputeVertexRings(mesh);
  for (int v = 0; v < static_cast<int>(frames.size()); ++v) {
    const Eigen::Vector3i& first = mesh.triangles[rings.triangles[rings.offsets[v]]];
    const int corner = first[0] == v ? 0 : first[1] == v ? 1 : 2;
    const Eigen::Vector3d edge = mesh.vertices[first[(corner + 1) % 3]] - mesh.vertices[v];
    EXPECT_NEAR(frames[v].col(1).dot(edge), 0, 1e-9);
    EXPECT_GT(frames[v].col(0).dot(edge), 0);
  }
}

TEST(VertexFrames, SurviveAFirstEdgeParallelToTheNormal) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.normals = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};  // of vertex 0: along its first edge
  for (const Eigen::Matrix3d& frame : ComputeVertexFrames(mesh)) ExpectRightHanded(frame);
}

TEST(VertexFrames, SurviveMissingNormalsLoneVerticesAndNeedles) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}};
  mesh.normals = {{0, 0, 0}, {kNan, 0, 0}, {0, 0, 2}, {0, 0, 0}};
  for (const Eigen::Matrix3d& frame : ComputeVertexFrames(mesh)) ExpectRightHanded(frame);
}

}  // namespace
}  // namespace lfm
