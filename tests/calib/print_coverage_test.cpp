// SPDX-License-Identifier: BSD-3-Clause
#include "calib/print_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

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
  for (const double place : soft.places()) variance += place * place / 24;
  EXPECT_NEAR(variance, 1.0 / 12 + 0.16, 0.01);
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
      EXPECT_NEAR(ShareBehindLine(profile, row, distance), behind, 1e-3)
          << row.transpose() << " " << distance << " blur " << blur;
    }
  }
  const PixelProfile sharp(0);
  EXPECT_EQ(ShareBehindLine(sharp, {0, 0}, 1), 1);
  EXPECT_EQ(ShareBehindLine(sharp, {0, 0}, -1), 0);
  EXPECT_EQ(ShareBehindLine(sharp, {0.3, 0.4}, 1e9), 1);
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
      const double error = PixelOfCross(*cross, slope, profile) - seen;
      EXPECT_NEAR(error, 0, 5e-3) << center.transpose() << " blur " << blur;
      square += error * error;
    }
    EXPECT_GT(answered, edges * (blur < 0.4 ? 8 : 5) / 10) << blur;
    EXPECT_LT(std::sqrt(square / answered), 1e-3) << blur;
  }
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
