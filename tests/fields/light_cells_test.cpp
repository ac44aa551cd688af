// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/cube_map.h"
#include "core/error.h"
#include "fields/light_probe.h"
#include "tests/fields/light_directions.h"

namespace lfm {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

TEST(LightCells, AreTheNearestLights) {
  for (const int count : {1, 2, 50, 2000}) {
    std::vector<Vector3d> directions = Spiral(count, -1);
    if (count > 2) directions.push_back(directions[3]);  // a light twice: the first has it all
    const LightCells cells =
        MakeLightCells(FieldColumns::kLights, directions, {.max_angle_deg = 180});
    double covered = 0;
    for (const double s : cells.solid_angle) covered += s;
    EXPECT_NEAR(covered, 4 * kPi, 1e-9);
    std::mt19937 random(count);
    for (int i = 0; i < 300; ++i) {
      const int y = static_cast<int>(random() % kProbeRows);
      const int x = static_cast<int>(random() % LightCells::kColumns);
      const Vector3d d = ProbeDirection((x + 0.5) / LightCells::kColumns, (y + 0.5) / kProbeRows);
      int run = cells.first_run[y];
      while (run + 1 < cells.first_run[y + 1] && cells.runs[run + 1].begin <= x) ++run;
      EXPECT_NEAR(directions[cells.runs[run].light].dot(d),
                  directions[Nearest(directions, d)].dot(d), 1e-12);
      const int texel = static_cast<int>(random() % cells.cube_light.size());
      const Vector3d middle =
          CubeMap{LightCells::kFace}.Direction(texel).cast<double>().normalized();
      EXPECT_NEAR(directions[cells.cube_light[texel]].dot(middle),
                  directions[Nearest(directions, middle)].dot(middle), 1e-12);
    }
    if (count > 2) {
      EXPECT_EQ(cells.solid_angle.back(), 0);
    }
  }
}

TEST(LightCells, OfACubeAreItsTexels) {
  for (const int resolution : {1, 2, 5, 32}) {
    const std::vector<Vector3d> directions = Cube(resolution);
    for (size_t i = 0; i < directions.size(); ++i) {
      ASSERT_EQ(CubeMap{resolution}.TexelOf(directions[i].cast<float>()), static_cast<int>(i));
    }
  }
  // Face +y (axis 1): columns along z, rows along x.
  EXPECT_EQ(CubeMap{4}.TexelOf({-0.9f, 1, 0.9f}), (2 * 4 + 0) * 4 + 3);
}

TEST(LightCells, LeaveOutWhatIsFarFromADome) {
  const std::vector<Vector3d> directions = Spiral(200, 0.1);
  const auto covered = [&](double max_angle_deg) {
    const LightCells cells =
        MakeLightCells(FieldColumns::kLights, directions, {.max_angle_deg = max_angle_deg});
    double sum = 0;
    for (const double s : cells.solid_angle) sum += s;
    return sum;
  };
  EXPECT_NEAR(covered(180), 4 * kPi, 1e-9);
  // From the dome's own extent to a median cell's radius (about 5 degrees) beyond.
  EXPECT_GT(covered(0), 2 * kPi * 0.9);
  EXPECT_LT(covered(0), 2 * kPi * 1.0);
  EXPECT_LT(covered(2), 200 * 2 * kPi * (1 - std::cos(2 * kPi / 180)) * 1.02);
  // A gap between lights belongs to them all the same.
  std::vector<Vector3d> gap;
  for (const Vector3d& d : Spiral(400, -1)) {
    if (d.z() > 0 && (d - Vector3d(0.6, 0, 0.8)).norm() > 0.35) gap.push_back(d);
  }
  const LightCells cells = MakeLightCells(FieldColumns::kLights, gap);
  EXPECT_GE(cells.cube_light[CubeMap{LightCells::kFace}.TexelOf({0.6f, 0, 0.8f})], 0);
  EXPECT_EQ(cells.cube_light[CubeMap{LightCells::kFace}.TexelOf({0, 0, -1})], -1);
}

TEST(LightCells, RefuseWhatHasNone) {
  EXPECT_THROW(MakeLightCells(FieldColumns::kViews, Spiral(9, 0)), Error);
  EXPECT_THROW(MakeLightCells(FieldColumns::kLights, {}), Error);
  EXPECT_THROW(MakeLightCells(FieldColumns::kCubeTexels, Spiral(9, 0)), Error);
  EXPECT_THROW(MakeLightCells(FieldColumns::kLights, Spiral(9, 0), {.max_angle_deg = 181}), Error);
  EXPECT_THROW(MakeLightCells(FieldColumns::kLights, Spiral(9, 0), {.max_angle_deg = -1}), Error);
}

}  // namespace
}  // namespace lfm
