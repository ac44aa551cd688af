// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/shown_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRotation_abs = 1e-9;

TEST(ShownModel, TurnsAboutXThenYThenZ) {
  ShownModel model;
  model.translation = {10, 20, 30};
  model.angles_deg = {90, 0, 90};
  model.scale = 2;
  // z goes to -y about x, and that to x about z.
  const Eigen::Vector3d there = PlacementOf(model) * Eigen::Vector3d(0, 0, 5);
  EXPECT_LT((there - Eigen::Vector3d(20, 20, 30)).norm(), 1e-9);
}

TEST(ShownModel, GivesAnyPlacementBack) {
  for (const double x : {-170.0, -30.0, 0.0, 100.0}) {
    for (const double y : {-90.0, -45.0, 0.0, 89.9999, 90.0}) {
      for (const double z : {-120.0, 0.0, 60.0, 180.0}) {
        Placement placement;
        placement.world_from_model.rotation =
            (Eigen::AngleAxisd(z * kDegree, Eigen::Vector3d::UnitZ()) *
             Eigen::AngleAxisd(y * kDegree, Eigen::Vector3d::UnitY()) *
             Eigen::AngleAxisd(x * kDegree, Eigen::Vector3d::UnitX()))
                .toRotationMatrix();
        placement.world_from_model.translation = {1, -2, 3};
        placement.scale = 0.25;
        const ShownModel model = ShownAt("a model", "a.glb", placement);
        const Placement back = PlacementOf(model);
        EXPECT_LT((back.world_from_model.rotation - placement.world_from_model.rotation).norm(),
                  1e-6)
            << x << " " << y << " " << z;
        EXPECT_EQ(back.world_from_model.translation, placement.world_from_model.translation);
        EXPECT_EQ(back.scale, 0.25);
        EXPECT_LE(std::abs(model.angles_deg.y()), 90 + 1e-9);
      }
    }
  }
}

TEST(ShownModel, StaysWithinWhatSceneFilesTake) {
  ShownModel model;
  model.translation = {1e300, -std::numeric_limits<double>::infinity(), std::nan("")};
  model.angles_deg = {std::nan(""), 1e6, 0};
  model.scale = -3;
  const Placement placement = PlacementOf(model);
  EXPECT_EQ(placement.world_from_model.translation, Eigen::Vector3d(1e9, 0, 0));
  EXPECT_NEAR(placement.world_from_model.rotation.determinant(), 1, kRotation_abs);
  EXPECT_EQ(placement.scale, 1e-6);
}

}  // namespace
}  // namespace lfm
