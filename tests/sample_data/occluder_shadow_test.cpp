// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/occluder_shadow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sample_data/random.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

// One lamp straight above a small tile 50 mm above the plate.
class OccluderShadowTest : public testing::Test {
 protected:
  OccluderShadowTest() : board_(DefaultBoard()), reflectance_(board_) {
    lighting_.lights = {AimLight(V3(0, 0, 50), 0, 90, 600, 40, 40, V3f(10, 20, 30))};
    subject_.mesh.vertices = {{-5, -5, 50}, {5, -5, 50}, {5, 5, 50}, {-5, 5, 50}};
    subject_.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    subject_.mesh.normals.assign(4, V3::UnitZ());
    Paint paint;
    paint.diffuse = V3f(0.5f, 0.4f, 0.3f);
    paint.coat = V3f(0.2f, 0.2f, 0.2f);
    subject_.paint.assign(4, paint);
    scene_ = std::make_unique<StudioScene>(
        &subject_.mesh, MakePlateAndTable(board_, {Eigen::Matrix3d::Identity(), {0, 0, -5}}));
    BakeOptions options;
    options.gather_rays = 16;
    options.plate_spacing_mm = 4;
    light_ = BakeLight(*scene_, subject_, lighting_, reflectance_, options, SilentProgress());
  }
  BakedLight Shadow(const Capsule& capsule) const {
    Occluder occluder;
    occluder.capsules = {capsule};
    return ShadowLight(light_, *scene_, subject_, lighting_, occluder);
  }
  V3f OnPlate(const BakedLight& light, double x, double y) const {
    const Patch& top = scene_->patches()[0];
    const V3 d = V3(x, y, 0) - top.origin;
    return light.patches[0].Sample(top, d.dot(top.u), d.dot(top.v));
  }

  Board board_;
  SetReflectance reflectance_;
  Lighting lighting_;
  Subject subject_;
  std::unique_ptr<StudioScene> scene_;
  BakedLight light_;
};

TEST_F(OccluderShadowTest, ABallOverTheTileTakesAllOfTheLampsLight) {
  const BakedLight dark = Shadow({V3(0, 0, 300), V3(0, 0, 300), 60});
  for (size_t v = 0; v < 4; ++v) {
    const V3f point = subject_.mesh.vertices[v].cast<float>();
    const V3f lamp = GatherLamps(*scene_, lighting_, point, V3f(0, 0, 1), 9).irradiance;
    const V3f lost = BaseAlbedo(subject_.paint[v]).cwiseProduct(lamp) / std::numbers::pi_v<float>;
    ASSERT_GT(lost.minCoeff(), 0);
    EXPECT_LT((light_.diffuse_radiance[v] - dark.diffuse_radiance[v] - lost).norm(),
              1e-4f * lost.norm());
    for (int c = 0; c < light_.cells; ++c) {
      EXPECT_EQ(light_.cell_visibility[v * light_.cells + c], 255);
      EXPECT_EQ(dark.cell_visibility[v * light_.cells + c], 0);
    }
  }
  // The plate beside the tile's own shadow is in the ball's umbra (radius 2 * 60 - 20 below it);
  // farther out than its penumbra nothing changes.
  const V3f before = OnPlate(light_, 40, 0), after = OnPlate(dark, 40, 0);
  EXPECT_LT(after.norm(), 0.35f * before.norm());
  EXPECT_GT(before.norm(), 0);
}

TEST_F(OccluderShadowTest, WhatStandsAsideOrBehindTheLampTakesNothing) {
  for (const Capsule& capsule :
       {Capsule{V3(400, 0, 300), V3(500, 0, 300), 20}, Capsule{V3(0, 0, 700), V3(0, 0, 700), 40},
        Capsule{V3(0, 0, -100), V3(0, 9, -100), 40}}) {
    const BakedLight same = Shadow(capsule);
    EXPECT_EQ(same.diffuse_radiance, light_.diffuse_radiance);
    EXPECT_EQ(same.cell_visibility, light_.cell_visibility);
    EXPECT_EQ(same.patches[0].irradiance, light_.patches[0].irradiance);
  }
}

// A stick across half of the lamp, as seen from the tile's middle, takes its share.
TEST_F(OccluderShadowTest, PartOfALampIsTakenInProportion) {
  // At half way to the lamp, 30 mm wide against a lamp that spans 20 mm there: half is hidden.
  const BakedLight half = Shadow({V3(15, -200, 350), V3(15, 200, 350), 15});
  double seen = 0;
  for (size_t v = 0; v < 4; ++v) {
    for (int c = 0; c < light_.cells; ++c) {
      seen += half.cell_visibility[v * light_.cells + c] / (255.0 * 4 * light_.cells);
    }
  }
  EXPECT_NEAR(seen, 0.5, 0.1);
}

TEST(OccluderMesh, IsClosedAndWithinThePercentageOfTheCapsule) {
  RandomStream random(3, 1, 4);
  const Occluder hand =
      MakeOccluder(OccluderKind::kHand, Camera{640, 480, 700, 700, 320, 240},
                   LookAt(V3(0, -400, 200), V3(0, 0, 40), V3::UnitZ()), V3(0, 0, 40), random);
  for (const Capsule& capsule : hand.capsules) {
    Occluder one;
    one.capsules = {capsule};
    const TriangleMesh mesh = OccluderMesh(one);
    const V3 axis = capsule.b - capsule.a;
    const double r = capsule.radius, length = axis.norm();
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const V3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
      const double along = std::clamp((middle - capsule.a).dot(axis) / (length * length), 0., 1.);
      const double distance = (middle - capsule.a - along * axis).norm();
      EXPECT_LE(distance, r * (1 + 1e-9));
      EXPECT_GE(distance, r * (1 - 0.005));
    }
    // Outward, and all of it: the volume of a cylinder and a ball.
    const double volume = std::numbers::pi * r * r * (length + 4 * r / 3);
    EXPECT_NEAR(SignedVolume(mesh) / volume, 1, 0.01);
  }
}

}  // namespace
}  // namespace lfm
