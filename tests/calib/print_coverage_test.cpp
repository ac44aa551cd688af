// SPDX-License-Identifier: BSD-3-Clause
#include "calib/print_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/polygon.h"

namespace lfm {
namespace {

// Places of equal shares of a pixel's light: the oracle.
struct Places {
  std::vector<float> x, y;
};

Places DensePlaces(const PixelProfile& profile) {
  constexpr int kSide = 160;
  std::vector<double> side;
  for (int i = 0; i < kSide * kSide; ++i) {
    side.push_back(profile.Quantile((i + 0.5) / (kSide * kSide)));
  }
  Places places;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      // Every place has a column and a row of its own.
      places.x.push_back(static_cast<float>(side[i * kSide + j]));
      places.y.push_back(static_cast<float>(side[j * kSide + i]));
    }
  }
  return places;
}

TEST(PixelProfile, SharesAreOfABlurredBox) {
  const PixelProfile sharp(0), soft(0.4);
  EXPECT_EQ(sharp.ShareBelow(-0.6), 0);
  EXPECT_NEAR(sharp.ShareBelow(0.25), 0.75, 1e-12);
  EXPECT_EQ(sharp.ShareBelow(std::numeric_limits<double>::infinity()), 1);
  EXPECT_EQ(sharp.ShareBelow(-std::numeric_limits<double>::infinity()), 0);
  EXPECT_NEAR(soft.ShareBelow(0), 0.5, 1e-9);
  EXPECT_NEAR(soft.ShareBelow(0.7) + soft.ShareBelow(-0.7), 1, 1e-9);
  for (const double share : {0.01, 0.3, 0.5, 0.9}) {
    EXPECT_NEAR(soft.ShareBelow(soft.Quantile(share)), share, 1e-5);
    EXPECT_NEAR(sharp.Quantile(share), share - 0.5, 1e-12);
  }
  double variance = 0;
  for (int i = 0; i < 1000; ++i) {
    const double place = soft.RoughQuantile((i + 0.5) / 1000);
    const bool tail = i < 4 || i >= 996;
    EXPECT_NEAR(place, soft.Quantile((i + 0.5) / 1000), tail ? 0.3 : 2e-3);
    variance += place * place / 1000;
  }
  EXPECT_NEAR(variance, 1.0 / 12 + 0.16, 0.002);
}

TEST(ShareBehindLine, IsTheShareOfPlacesBehindIt) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (const double blur : {0.0, 0.15, 0.6}) {
    const PixelProfile profile(blur);
    const Places places = DensePlaces(profile);
    for (int i = 0; i < 60; ++i) {
      Eigen::Vector2d row(uniform(random), uniform(random));
      if (i % 6 == 0) row.y() = 0;
      if (i % 6 == 1) row.x() *= 1e-6;
      const double distance = uniform(random);
      double behind = 0;
      for (size_t k = 0; k < places.x.size(); ++k) {
        behind += row.dot(Eigen::Vector2d(places.x[k], places.y[k])) < distance ? 1 : 0;
      }
      behind /= static_cast<double>(places.x.size());
      EXPECT_NEAR(ShareBehindLine(profile, row, distance), behind, 3e-3)
          << row.transpose() << " " << distance << " blur " << blur;
    }
  }
  const PixelProfile sharp(0);
  EXPECT_EQ(ShareBehindLine(sharp, {0, 0}, 1), 1);
  EXPECT_EQ(ShareBehindLine(sharp, {0, 0}, -1), 0);
  EXPECT_EQ(ShareBehindLine(sharp, {0.3, 0.4}, 1e9), 1);
}

// A print like a checker's corner, as exact areas under a pixel that many places of the blur move.
TEST(PixelOfCross, IsTheAreaOfItsFields) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> shear(-0.5, 0.5), size(0.4, 0.9), turn(0, 6.3);
  std::normal_distribution<double> normal;
  for (const double blur : {0.0, 0.2, 0.5}) {
    const PixelProfile profile(blur);
    double square = 0;
    constexpr int kTrials = 300;
    for (int i = 0; i < kTrials; ++i) {
      PrintCross cross;
      const double angle = i % 5 == 0 ? 0 : turn(random);
      cross.x_axis = {std::cos(angle), std::sin(angle)};
      cross.offset_mm = {shear(random), shear(random)};
      cross.value[0][0] = cross.value[1][1] = 1;
      cross.value[0][1] = 0;
      cross.value[1][0] = i % 2;
      Eigen::Matrix2d slope;
      slope << size(random), shear(random), shear(random), -size(random);
      if (i % 5 == 0) slope = Eigen::DiagonalMatrix<double, 2>(0.7, -0.7);
      Eigen::Matrix2d rows;
      rows << cross.x_axis.transpose(), -cross.x_axis.y(), cross.x_axis.x();
      rows *= slope;
      double expected = 0;
      const int places = blur > 0 ? 2000 : 1;
      for (int k = 0; k < places; ++k) {
        const Eigen::Vector2d o(blur * normal(random), blur * normal(random));
        const Polygon pixel = {o + Eigen::Vector2d(-0.5, -0.5), o + Eigen::Vector2d(0.5, -0.5),
                               o + Eigen::Vector2d(0.5, 0.5), o + Eigen::Vector2d(-0.5, 0.5)};
        for (int field = 0; field < 4; ++field) {
          const double x = field / 2 == 0 ? 1 : -1, y = field % 2 == 0 ? 1 : -1;
          const Polygon part =
              ClipPolygon(ClipPolygon(pixel, x * rows.row(0).transpose(), x * cross.offset_mm.x()),
                          y * rows.row(1).transpose(), y * cross.offset_mm.y());
          expected += cross.value[field / 2][field % 2] * PolygonArea(part) / places;
        }
      }
      const double error = PixelOfCross(cross, {slope}, profile) - expected;
      EXPECT_NEAR(error, 0, blur > 0 ? 0.03 : 4e-3);  // the oracle's own: 0.3 / sqrt(2000)
      square += error * error;
    }
    EXPECT_LT(std::sqrt(square / kTrials), blur > 0 ? 8e-3 : 1e-3) << blur;
  }
}

// Perspective much stronger than any picture's: a tenth a pixel.
TEST(PixelOfCross, SeesStraightLinesInPerspective) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shear(-0.3, 0.3), turn(0, 6.3), near(-0.1, 0.1);
  for (const double blur : {0.0, 0.3}) {
    const PixelProfile profile(blur);
    const Places places = DensePlaces(profile);
    double square = 0, affine = 0;
    constexpr int kTrials = 100;
    for (int i = 0; i < kTrials; ++i) {
      PrintCross cross;
      const double angle = turn(random);
      cross.x_axis = {std::cos(angle), std::sin(angle)};
      cross.offset_mm = {shear(random), shear(random)};
      cross.value[0][0] = cross.value[1][1] = 1;
      cross.value[0][1] = 0;
      cross.value[1][0] = i % 2;
      PlateSlope slope;
      slope.mm_per_px << 0.7, shear(random), shear(random), -0.5;
      slope.nearing = {near(random), near(random)};
      double seen = 0;
      for (size_t k = 0; k < places.x.size(); ++k) {
        const Eigen::Vector2d o(places.x[k], places.y[k]);
        const Eigen::Vector2d p = slope.mm_per_px * o / (1 + slope.nearing.dot(o));
        const int x = p.dot(cross.x_axis) < cross.offset_mm.x() ? 0 : 1;
        const int y =
            cross.x_axis.x() * p.y() - cross.x_axis.y() * p.x() < cross.offset_mm.y() ? 0 : 1;
        seen += cross.value[x][y] / static_cast<double>(places.x.size());
      }
      const double error = PixelOfCross(cross, slope, profile) - seen;
      EXPECT_NEAR(error, 0, blur > 0 ? 0.015 : 5e-3) << blur;
      square += error * error;
      affine += std::pow(PixelOfCross(cross, {slope.mm_per_px}, profile) - seen, 2);
    }
    EXPECT_LT(square, 0.25 * affine) << blur;
  }
}

TEST(PixelOfCross, IsWhatManyPlacesOfThePrintShow) {
  Board board = DefaultBoard();
  for (size_t i = 0; i < board.tags.size(); ++i) {
    board.tags[i].rotation += 0.02 * static_cast<double>(i % 5);
  }
  const BoardPrint print = BoardPrint::WithMovedTags(board);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-108, 108), shear(-0.4, 0.4), size(0.4, 0.9);
  for (const double blur : {0.0, 0.3, 0.5}) {
    const PixelProfile profile(blur);
    const Places places = DensePlaces(profile);
    int edges = 0, answered = 0;
    double square = 0;
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector2d center(place(random), place(random));
      Eigen::Matrix2d slope;
      slope << size(random), shear(random), shear(random), -size(random);
      const double reach = (0.5 + 3.5 * blur) * std::max((slope.col(0) + slope.col(1)).norm(),
                                                         (slope.col(0) - slope.col(1)).norm());
      if (print.UniformRadius(center) > reach) continue;
      ++edges;
      const auto cross = print.CrossNear(center, reach);
      if (!cross) continue;
      ++answered;
      const double seen = print.MeanValue(center, slope, places.x, places.y);
      const double error = PixelOfCross(*cross, {slope}, profile) - seen;
      EXPECT_NEAR(error, 0, 0.03) << center.transpose() << " blur " << blur;
      square += error * error;
    }
    EXPECT_GT(answered, edges * (blur < 0.4 ? 7 : 3) / 10) << blur;
    EXPECT_LT(std::sqrt(square / answered), 3e-3) << blur;
  }
}

TEST(PixelOfCross, AnswersOnAPlateWithoutTags) {
  Board board = DefaultBoard();
  board.tags.clear();
  board.tag_size_mm = 0;
  const BoardPrint print = BoardPrint::WithMovedTags(board);
  const auto cross = print.CrossNear({0.2, 0.1}, 1.5);
  ASSERT_TRUE(cross);
  EXPECT_NEAR(cross->offset_mm.x(), -0.2, 1e-9);
  EXPECT_NEAR(cross->offset_mm.y(), -0.1, 1e-9);
  EXPECT_EQ(cross->value[0][0], cross->value[1][1]);
  EXPECT_NE(cross->value[0][0], cross->value[0][1]);
}

TEST(PixelOfCross, NoAnswerWhereThePrintIsMoreThanACross) {
  Board board = DefaultBoard();
  const BoardTag tag = board.tags[0];
  const BoardPrint print(board);
  EXPECT_TRUE(print.CrossNear(tag.center_mm, 0.5));
  EXPECT_FALSE(print.CrossNear(tag.center_mm, 50));
  EXPECT_FALSE(print.CrossNear({board.width_mm / 2 - 0.1, 0}, 0.5));
  EXPECT_FALSE(print.CrossNear({1e300, std::numeric_limits<double>::quiet_NaN()}, 0.5));
  EXPECT_FALSE(print.CrossNear(tag.center_mm, std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace
}  // namespace lfm
