// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/plate.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

const Pose kTable{Eigen::Matrix3d::Identity(), {0, 0, -kPlateThicknessMm}};

TEST(PrintedBoard, IsTheNominalOneWithoutTrouble) {
  const Board nominal = DefaultBoard(), printed = PrintedBoard(nominal, {}, 5);
  EXPECT_EQ(printed.tag_size_mm, nominal.tag_size_mm);
  EXPECT_EQ(printed.checker_square_mm, nominal.checker_square_mm);
  for (size_t i = 0; i < nominal.tags.size(); ++i) {
    EXPECT_EQ(printed.tags[i].center_mm, nominal.tags[i].center_mm);
  }
}

TEST(PrintedBoard, HasTheStatedScaleAndSpread) {
  PlatformTrouble trouble;
  trouble.print_scale_percent = 0.5;
  trouble.tag_error_mm = 0.1;
  const Board nominal = DefaultBoard();
  double sum = 0, squares = 0;
  int count = 0;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    const Board printed = PrintedBoard(nominal, trouble, seed);
    EXPECT_NEAR(printed.tag_size_mm, 24 * 1.005, 1e-12);
    EXPECT_NEAR(printed.checker_square_mm, 15 * 1.005, 1e-12);
    EXPECT_EQ(printed.width_mm, 220);
    for (size_t i = 0; i < nominal.tags.size(); ++i) {
      const Eigen::Vector2d error = printed.tags[i].center_mm - 1.005 * nominal.tags[i].center_mm;
      sum += error.sum();
      squares += error.squaredNorm();
      count += 2;
    }
  }
  EXPECT_NEAR(sum / count, 0, 5 * 0.1 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.1, 0.01);
}

TEST(PrintedBoard, TagsThatWouldTouchAreAnError) {
  PlatformTrouble trouble;
  trouble.tag_error_mm = 1;
  EXPECT_THROW(
      {
        for (uint64_t seed = 0; seed < 50; ++seed) PrintedBoard(DefaultBoard(), trouble, seed);
      },
      Error);
}

// Height of the first patch of a material below a point high above.
double TopHeight(const std::vector<Patch>& patches, PatchMaterial material, double x, double y) {
  double top = -1e9;
  for (const Patch& p : patches) {
    if (p.material != material || p.Normal().z() < 0.5) continue;
    const double t = (p.origin - V3(x, y, 0)).dot(p.Normal()) / p.Normal().z();
    const V3 d = V3(x, y, t) - p.origin;
    const double a = d.dot(p.u), b = d.dot(p.v);
    if (a < -1e-9 || b < -1e-9 || a > p.width + 1e-9 || b > p.height + 1e-9) continue;
    top = std::max(top, t);
  }
  return top;
}

TEST(BentPlate, IsFlatWithoutSag) {
  const Board board = DefaultBoard();
  const std::vector<Patch> flat = MakePlateAndTable(board, kTable);
  const std::vector<Patch> bent = MakeBentPlateAndTable(board, 0, kTable);
  ASSERT_EQ(flat.size(), bent.size());
  for (size_t i = 0; i < flat.size(); ++i) EXPECT_EQ(flat[i].origin, bent[i].origin);
}

TEST(BentPlate, FollowsTheSagWithoutGaps) {
  const Board board = DefaultBoard();
  for (double sag : {1.0, -1.0}) {
    const std::vector<Patch> patches = MakeBentPlateAndTable(board, sag, kTable);
    EXPECT_EQ(PlateHeight(board, sag, 0), 0);
    EXPECT_NEAR(PlateHeight(board, sag, 110), -sag, 1e-12);
    EXPECT_NEAR(PlateHeight(board, sag, -55), -sag / 4, 1e-12);
    for (double x = -109.9; x < 110; x += 1.7) {
      for (double y : {-109.5, 0.0, 77.0}) {
        EXPECT_NEAR(TopHeight(patches, PatchMaterial::kPrint, x, y), PlateHeight(board, sag, x),
                    1.0 / 1900);
      }
    }
    // Patches are rectangles with unit, orthogonal sides; nothing of the plate dips into the table.
    const double table = TopHeight(patches, PatchMaterial::kTable, 300, 0);
    EXPECT_NEAR(table, -kPlateThicknessMm - std::max(0.0, sag), 1e-12);
    for (const Patch& p : patches) {
      EXPECT_NEAR(p.u.norm(), 1, 1e-12);
      EXPECT_NEAR(p.v.norm(), 1, 1e-12);
      EXPECT_NEAR(p.u.dot(p.v), 0, 1e-12);
      if (p.material == PatchMaterial::kTable) continue;
      EXPECT_GE(p.origin.z(), table - 1e-3);
      if (p.material != PatchMaterial::kEdge) continue;
      // Walls face outwards.
      const V3 middle = p.origin + 0.5 * p.width * p.u + 0.5 * p.height * p.v;
      EXPECT_GT(p.Normal().dot(middle), 50);
    }
  }
}

TEST(PlatformTruth, HoldsTheCornersOnTheBentPlate) {
  PlatformTrouble trouble;
  trouble.tag_error_mm = 0.1;
  const Board printed = PrintedBoard(DefaultBoard(), trouble, 9);
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("lfm_platform_" + std::to_string(getpid()) + ".json");
  WritePlatformTruth(printed, 1.5, file);
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream);
  std::filesystem::remove(file);
  ASSERT_EQ(json.at("tags").size(), printed.tags.size());
  for (size_t i = 0; i < printed.tags.size(); ++i) {
    EXPECT_EQ(json["tags"][i].at("id"), printed.tags[i].id);
    const auto corners = printed.TagCorners(printed.tags[i]);
    for (int c = 0; c < 4; ++c) {
      const nlohmann::json& p = json["tags"][i].at("corners_mm")[c];
      EXPECT_EQ(double(p[0]), corners[c].x());
      EXPECT_EQ(double(p[1]), corners[c].y());
      EXPECT_NEAR(double(p[2]), -1.5 * std::pow(corners[c].x() / 110, 2), 1e-12);
    }
  }
  EXPECT_EQ(json.at("checker_corners_mm").size(), 81u);
}

}  // namespace
}  // namespace lfm
