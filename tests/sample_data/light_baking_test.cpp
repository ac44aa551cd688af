// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/light_baking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sample_data/coat_shading.h"
#include "sample_data/isosurface.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

constexpr double kPi = std::numbers::pi;

// A ball of radius 20 that hovers over the middle of the plate.
Subject Ball(double height) {
  Subject ball;
  const V3 center(0, 0, height);
  ball.mesh = PolygoniseIsosurface([&](const V3& p) { return (p - center).norm() - 20; },
                                   {center - V3(23, 23, 23), center + V3(23, 23, 23), 2}, 1);
  Paint paint;
  paint.diffuse = V3f(0.5f, 0.5f, 0.5f);
  paint.coat = V3f(0.2f, 0.2f, 0.2f);
  ball.paint.assign(ball.mesh.vertices.size(), paint);
  return ball;
}

Lighting UniformRoom(float radiance) {
  Lighting lighting;
  lighting.sky = lighting.wall = lighting.ground = V3f(0, 0, radiance);
  return lighting;
}

TEST(Harmonics, AreOrthonormal) {
  constexpr int kSteps = 120;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kHarmonics, kHarmonics);
  for (int i = 0; i < kSteps; ++i) {
    const double theta = (i + 0.5) / kSteps * kPi;
    for (int j = 0; j < 2 * kSteps; ++j) {
      const double phi = (j + 0.5) / kSteps * kPi;
      const auto y = EvaluateHarmonics(
          V3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta))
              .cast<float>());
      const double weight = std::sin(theta) * (kPi / kSteps) * (kPi / kSteps);
      for (int a = 0; a < kHarmonics; ++a) {
        for (int b = 0; b < kHarmonics; ++b) gram(a, b) += weight * y[a] * y[b];
      }
    }
  }
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(kHarmonics, kHarmonics)).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(LightBaking, UniformRoomGivesPiOnTheEmptyPlate) {
  const Board board = DefaultBoard();
  const SetReflectance reflectance(board);
  const StudioScene scene(nullptr,
                          MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}));
  BakeOptions options;
  options.gather_rays = 2048;
  options.plate_spacing_mm = 55;
  Lighting room = UniformRoom(0.5f);
  // The room's sky and walls differ by azimuth only where walls shine; a plain room has none.
  room.wall.setZero();
  room.sky = room.ground = V3f(0.5f, 0.5f, 0.5f);
  const BakedLight light =
      BakeLight(scene, Subject(), room, reflectance, options, SilentProgress());
  // Radiance 0.5 cos(theta): the irradiance is 0.5 * 2 pi / 3.
  for (const V3f& e : light.patches[0].irradiance) EXPECT_NEAR(e.x(), kPi / 3, 0.02);
}

TEST(LightBaking, LampAndItsShadowFollowTheFormFactor) {
  const Subject ball = Ball(60);
  const Board board = DefaultBoard();
  const StudioScene scene(&ball.mesh,
                          MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}));
  Lighting lighting;
  lighting.lights = {AimLight(V3(0, 0, 0), 0, 90 - 1e-6, 600, 200, 100, V3f(3, 2, 1))};
  // Open sky 90 mm to the side: integrate the lamp finely.
  const V3 point(90, 0, 0);
  double form = 0;
  constexpr int kSteps = 200;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const V3 d = lighting.lights[0].Point((i + 0.5) / kSteps, (j + 0.5) / kSteps) - point;
      const double cosine = d.z() / d.norm();
      form += cosine * cosine / d.squaredNorm() * lighting.lights[0].Area() / (kSteps * kSteps);
    }
  }
  const LampLight open = GatherLamps(scene, lighting, point.cast<float>(), V3f(0, 0, 1), 9);
  EXPECT_NEAR(open.irradiance.x(), 3 * form, 3e-3 * 3 * form);
  EXPECT_NEAR(open.irradiance.z(), form, 3e-3 * form);
  const LampLight hidden = GatherLamps(scene, lighting, V3f(0, 0, 0), V3f(0, 0, 1), 9);
  EXPECT_EQ(hidden.irradiance.x(), 0);
  // In the half shadow some cells are seen and some are not.
  const LampLight half = GatherLamps(scene, lighting, V3f(21, 0, 0), V3f(0, 0, 1), 9);
  EXPECT_GT(half.irradiance.x(), 0.1 * open.irradiance.x());
  EXPECT_LT(half.irradiance.x(), 0.9 * open.irradiance.x());
  EXPECT_EQ(GatherLamps(scene, lighting, V3f(90, 0, 0), V3f(0, 0, -1), 9).irradiance.x(), 0);
}

TEST(LightBaking, ThePlateLightsTheBallFromBelow) {
  const Subject ball = Ball(25);
  const Board board = DefaultBoard();
  const SetReflectance reflectance(board);
  const StudioScene scene(&ball.mesh,
                          MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}));
  Lighting lighting;
  lighting.lights = {AimLight(V3(0, 0, 0), 0, 80, 600, 100, 100, V3f(10, 10, 10))};
  BakeOptions options;
  options.gather_rays = 128;
  options.plate_spacing_mm = 4;
  const BakedLight light = BakeLight(scene, ball, lighting, reflectance, options, SilentProgress());
  double below = 0, count = 0;
  for (size_t v = 0; v < ball.mesh.vertices.size(); ++v) {
    ASSERT_TRUE(light.diffuse_radiance[v].allFinite());
    ASSERT_GE(light.diffuse_radiance[v].minCoeff(), 0);
    if (ball.mesh.normals[v].z() > -0.5 || ball.mesh.normals[v].z() < -0.8) continue;
    below += light.diffuse_radiance[v].x();
    ++count;
  }
  // No lamp and no sky shine there: all of it is the one bounce. The plate sends back at most its
  // paper's share of the lamp's irradiance, 10 * 1e4 / 600^2.
  const double most = 0.6 * 10 * 1e4 / 3.6e5 * 0.5 * 0.8 / kPi;
  EXPECT_GT(below / count, 0.05 * most);
  EXPECT_LT(below / count, most);
}

// Baking with two seeds at once is baking with each alone.
TEST(LightBaking, SeedsDoNotKnowOfEachOther) {
  const Subject ball = Ball(25);
  const Board board = DefaultBoard();
  const SetReflectance reflectance(board);
  const StudioScene scene(&ball.mesh,
                          MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}));
  BakeOptions options;
  options.gather_rays = 32;
  options.plate_spacing_mm = 8;
  const Lighting lighting = MakeStudioLighting();
  const uint64_t seeds[] = {7, 8};
  const std::vector<BakedLight> both =
      BakeLights(scene, ball, lighting, reflectance, options, seeds, SilentProgress());
  ASSERT_EQ(both.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    options.seed = seeds[i];
    const BakedLight alone =
        BakeLight(scene, ball, lighting, reflectance, options, SilentProgress());
    EXPECT_EQ(both[i].diffuse_radiance, alone.diffuse_radiance);
    EXPECT_EQ(both[i].harmonics, alone.harmonics);
    EXPECT_EQ(both[i].cell_visibility, alone.cell_visibility);
    for (size_t p = 0; p < alone.patches.size(); ++p) {
      EXPECT_EQ(both[i].patches[p].irradiance, alone.patches[p].irradiance);
    }
    EXPECT_EQ(both[i].rays.bounce, alone.rays.bounce);
    EXPECT_EQ(both[i].rays.shadow, i == 0 ? alone.rays.shadow : 0);
  }
  EXPECT_NE(both[0].diffuse_radiance, both[1].diffuse_radiance);
}

TEST(LightBaking, PatchIrradianceIsBilinear) {
  PatchIrradiance grid{2, 2, {V3f(0, 0, 0), V3f(1, 0, 0), V3f(2, 0, 0), V3f(3, 0, 0)}};
  Patch patch;
  patch.width = 10;
  patch.height = 20;
  EXPECT_NEAR(grid.Sample(patch, 5, 10).x(), 1.5, 1e-6);
  EXPECT_NEAR(grid.Sample(patch, 10, 0).x(), 1, 1e-6);
  EXPECT_NEAR(grid.Sample(patch, 99, 99).x(), 3, 1e-6);
}

TEST(CoatShading, LampCellsAgreeWithTheBrdf) {
  Lighting lighting;
  lighting.lights = {AimLight(V3(0, 0, 0), 30, 60, 500, 200, 200, V3f(1, 1, 1))};
  const LampCells cells = MakeLampCells(lighting);
  ASSERT_EQ(cells.count, kLightCells);
  float visibility[kLightCells], scale[kLightCells], bias[kLightCells];
  std::fill(visibility, visibility + kLightCells, 0.5f);
  const V3 v = V3(-0.3, 0.1, 0.8).normalized();
  ReflectLampCells(cells, V3f(0, 0, 0), V3f(0, 0, 1), v.cast<float>(), 0.25f, visibility, scale,
                   bias);
  for (int i = 0; i < kLightCells; ++i) {
    const V3 d(cells.x[i], cells.y[i], cells.z[i]);
    const V3 l = d.normalized(), h = (l + v).normalized();
    const double lamp = -l.dot(V3(cells.nx[i], cells.ny[i], cells.nz[i]));
    for (double f0 : {0.0, 0.3}) {
      const double expected = SchlickFresnel(f0, v.dot(h)) * GgxReflection(v, l, 0.25) * l.z() *
                              lamp * cells.area[i] / d.squaredNorm() * 0.5;
      EXPECT_NEAR(f0 * scale[i] + bias[i], expected, 1e-4 * expected + 1e-9);
    }
  }
}

}  // namespace
}  // namespace lfm
