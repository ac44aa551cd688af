// SPDX-License-Identifier: BSD-3-Clause
#include "calib/circle_detection.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "calib/board_design.h"
#include "calib/circle_match.h"
#include "calib/pose_estimation.h"
#include "core/error.h"
#include "rendered_board.h"

namespace lfm {
namespace {

using V2 = Eigen::Vector2d;

Board CircleBoard(int circles = 8) {
  BoardDesign design;
  design.layout = BoardLayout::kCircles;
  design.circles = circles;
  return DesignBoard(design);
}

Camera PinholeCamera() {
  Camera camera = SmallCamera();
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
  return camera;
}

Eigen::Matrix3d PixelFromBoard(const Camera& camera, const Pose& pose) {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity(), plane = pose.rotation;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  plane.col(2) = pose.translation;
  return k * plane;
}

TEST(ViewCircle, IsTheConicOfProjectedPoints) {
  const Camera camera = PinholeCamera();
  for (const Pose& pose : PosesAround(5)) {
    const Eigen::Matrix3d h = PixelFromBoard(camera, pose);
    const BoardCircle circle{{60, -40}, 30, CircleColor::kRed};
    const EllipseView view = ViewCircle(h, circle);
    for (double angle = 0; angle < 6; angle += 0.3) {
      const Eigen::Vector3d p(60 + 15 * std::cos(angle), -40 + 15 * std::sin(angle), 0);
      const V2 d = *Project(camera, pose * p) - view.center;
      EXPECT_NEAR(d.dot(view.shape.inverse() * d), 1, 1e-9);
    }
    const V2 center = *Project(camera, pose * Eigen::Vector3d(60, -40, 0));
    EXPECT_LT((view.center - view.center_bias - center).norm(), 1e-9);
    EXPECT_GT(view.center_bias.norm(), 0.05) << "30 mm seen aslant: the bias matters";
  }
}

// Finds every circle of the rendered board; returns the RMS of the centres' errors, px, the lens
// not modelled having been left out of the picture.
double CheckFound(const Board& board, const Camera& camera, const Pose& pose,
                  RenderSettings settings) {
  const Image picture = RenderBoard(board, camera, pose, settings);
  const std::vector<DetectedCircle> seen = DetectCircles(picture);
  const Eigen::Matrix3d h = PixelFromBoard(camera, pose);
  double squared = 0;
  int expected = 0;
  for (const BoardCircle& circle : board.circles) {
    const EllipseView view = ViewCircle(h, circle);
    // With the paper round it, it must be in the picture.
    const V2 reach = 1.6 * view.shape.diagonal().cwiseSqrt();
    if (!camera.Contains(view.center - reach) || !camera.Contains(view.center + reach)) continue;
    ++expected;
    const auto nearest = std::min_element(
        seen.begin(), seen.end(), [&](const DetectedCircle& a, const DetectedCircle& b) {
          return (a.center - view.center).norm() < (b.center - view.center).norm();
        });
    if (nearest == seen.end() || (nearest->center - view.center).norm() > 2) {
      ADD_FAILURE() << "no circle at " << view.center.transpose();
      return 1e9;
    }
    EXPECT_EQ(nearest->color, circle.color) << static_cast<int>(circle.color);
    squared += (nearest->center - view.center).squaredNorm();
  }
  EXPECT_GE(expected, 8);
  return std::sqrt(squared / std::max(1, expected));
}

TEST(DetectCircles, FindsAllUnderPerspective) {
  const Board board = CircleBoard(12);
  const Camera camera = PinholeCamera();
  constexpr double kCenter_abs = 0.12;  // px
  int i = 0;
  for (const Pose& pose : PosesAround(6)) {
    RenderSettings settings;
    settings.seed = static_cast<uint32_t>(++i);
    EXPECT_LT(CheckFound(board, camera, pose, settings), kCenter_abs) << i;
  }
}

TEST(DetectCircles, FindsAllUnderBlurWhiteBalanceAndDimLight) {
  const Board board = CircleBoard(12);
  const Camera camera = PinholeCamera();
  const Pose pose = PosesAround(9)[2];
  constexpr double kCenter_abs = 0.15;
  for (const double blur : {1.0, 2.4}) {
    EXPECT_LT(CheckFound(board, camera, pose, {.blur_px = blur}), kCenter_abs) << blur;
  }
  for (const Eigen::Vector3d& gains :
       {Eigen::Vector3d(1.2, 1, 0.6), Eigen::Vector3d(0.6, 1, 1.2), Eigen::Vector3d(1, 0.6, 1),
        Eigen::Vector3d(0.25, 0.25, 0.25)}) {
    EXPECT_LT(CheckFound(board, camera, pose, {.gains = gains}), kCenter_abs) << gains.transpose();
  }
  EXPECT_LT(CheckFound(board, camera, pose, {.gains = {1.15, 1, 0.7}, .blur_px = 1.5}),
            kCenter_abs);
}

TEST(DetectCircles, FindsNothingWhereThereIsNone) {
  const Pose pose = PosesAround(4)[1];
  EXPECT_TRUE(DetectCircles(RenderBoard(DefaultBoard(), SmallCamera(), pose)).empty());
  EXPECT_TRUE(DetectCircles(Image(64, 64, 3, PixelType::kUint8, ColorEncoding::kSrgb)).empty());
  EXPECT_TRUE(DetectCircles(Image(64, 64, 1, PixelType::kUint8, ColorEncoding::kSrgb)).empty());
  EXPECT_TRUE(DetectCircles(Image(4, 1, 3, PixelType::kUint8, ColorEncoding::kSrgb)).empty());
  Image noise(200, 150, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  std::mt19937 random(3);
  for (size_t i = 0; i < noise.size(); ++i) noise.Data<uint8_t>()[i] = random() & 255;
  EXPECT_TRUE(DetectCircles(noise).empty());
  Image bad(64, 64, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (size_t i = 0; i < bad.size(); ++i) {
    bad.Data<float>()[i] = i % 3 == 0 ? NAN : std::numeric_limits<float>::infinity();
  }
  EXPECT_TRUE(DetectCircles(bad).empty());
}

TEST(DetectCircles, PassesOverColouredThingsThatAreNoDiscs) {
  // Red and blue stripes, a square, and a disc on a dark ground, on white.
  Image picture(300, 200, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const auto paint = [&](auto inside, std::array<uint8_t, 3> color) {
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 300; ++x) {
        if (!inside(x, y)) continue;
        for (int c = 0; c < 3; ++c) picture.At<uint8_t>(x, y, c) = color[c];
      }
    }
  };
  paint([](int, int) { return true; }, {235, 235, 235});
  paint([](int x, int y) { return x > 20 && x < 120 && y > 20 && y < 30; }, {226, 35, 26});
  paint([](int x, int y) { return x > 20 && x < 70 && y > 50 && y < 100 && x - 20 > y - 50; },
        {40, 60, 170});
  paint([](int x, int y) { return x > 180 && y > 20 && y < 100; }, {10, 10, 10});
  paint([](int x, int y) { return std::hypot(x - 230, y - 60) < 15; }, {0, 150, 60});
  EXPECT_TRUE(DetectCircles(picture).empty());
  paint([](int x, int y) { return std::hypot(x - 80, y - 150) < 15; }, {0, 150, 60});
  const std::vector<DetectedCircle> found = DetectCircles(picture);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].color, CircleColor::kGreen);
  EXPECT_LT((found[0].center - V2(80, 150)).norm(), 0.05);
  EXPECT_NEAR(std::sqrt(found[0].shape(0, 0)), 15, 0.3);
}

TEST(DetectCircles, LargePicturesKeepTheirPixelCoordinates) {
  Image picture(3601, 2402, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const V2 center(1234.4, 777.7);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const bool ink = (V2(x, y) - center).norm() < 60;
      const std::array<uint8_t, 3> color =
          ink ? std::array<uint8_t, 3>{0, 174, 200} : std::array<uint8_t, 3>{220, 220, 220};
      for (int c = 0; c < 3; ++c) picture.At<uint8_t>(x, y, c) = color[c];
    }
  }
  const std::vector<DetectedCircle> found = DetectCircles(picture);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT((found[0].center - center).norm(), 0.1) << "no half pixel of either grid";
}

// Ellipses that a camera would see, in any order, with clutter of the same colours.
std::vector<DetectedCircle> PerfectCircles(const Board& board, const Eigen::Matrix3d& h) {
  std::vector<DetectedCircle> seen;
  for (const BoardCircle& circle : board.circles) {
    const EllipseView view = ViewCircle(h, circle);
    seen.push_back({view.center, view.shape, circle.color});
  }
  return seen;
}

TEST(MatchCircles, CorrectsTheBiasOfEllipseCentres) {
  const Board board = CircleBoard();
  const Camera camera = PinholeCamera();
  for (const Pose& pose : PosesAround(6)) {
    const auto match = MatchCircles(board, PerfectCircles(board, PixelFromBoard(camera, pose)));
    ASSERT_TRUE(std::holds_alternative<BoardMatch>(match));
    const BoardMatch& found = std::get<BoardMatch>(match);
    EXPECT_EQ(found.circles, 8);
    EXPECT_EQ(found.tags, 0);
    for (size_t i = 0; i < found.points_mm.size(); ++i) {
      const Eigen::Vector3d p(found.points_mm[i].x(), found.points_mm[i].y(), 0);
      EXPECT_EQ(found.world_points[i], p);
      EXPECT_LT((found.pixels[i] - *Project(camera, pose * p)).norm(), 1e-6);
    }
  }
}

TEST(MatchCircles, SurvivesHiddenCirclesAndClutter) {
  const Board board = CircleBoard(12);
  const Camera camera = PinholeCamera();
  const Pose pose = PosesAround(7)[3];
  std::vector<DetectedCircle> seen = PerfectCircles(board, PixelFromBoard(camera, pose));
  seen.erase(seen.begin() + 2, seen.begin() + 7);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(0, 480), y(0, 360), radius(4, 20);
  for (int i = 0; i < 25; ++i) {
    const double r = radius(random);
    seen.push_back({{x(random), y(random)},
                    Eigen::Matrix2d::Identity() * r * r,
                    static_cast<CircleColor>(i % kCircleColors)});
  }
  std::shuffle(seen.begin(), seen.end(), random);
  const auto match = MatchCircles(board, seen);
  ASSERT_TRUE(std::holds_alternative<BoardMatch>(match));
  const BoardMatch& found = std::get<BoardMatch>(match);
  EXPECT_EQ(found.circles, 7);
  for (size_t i = 0; i < found.points_mm.size(); ++i) {
    EXPECT_LT((found.pixels[i] - *Project(camera, pose * found.world_points[i])).norm(), 1e-5);
  }
}

TEST(MatchCircles, SaysWhyNot) {
  const Board board = CircleBoard();
  const Camera camera = PinholeCamera();
  const Eigen::Matrix3d h = PixelFromBoard(camera, PosesAround(7)[3]);
  std::vector<DetectedCircle> seen = PerfectCircles(board, h);
  seen.resize(3);
  EXPECT_TRUE(std::holds_alternative<BoardMismatch>(MatchCircles(board, seen)));
  EXPECT_TRUE(std::holds_alternative<BoardMismatch>(MatchCircles(board, {})));
  // A mirrored picture is no view from above.
  std::vector<DetectedCircle> mirrored = PerfectCircles(board, h);
  for (DetectedCircle& circle : mirrored) {
    circle.center.x() = 480 - circle.center.x();
    circle.shape(0, 1) = -circle.shape(0, 1);
    circle.shape(1, 0) = -circle.shape(1, 0);
  }
  EXPECT_TRUE(std::holds_alternative<BoardMismatch>(MatchCircles(board, mirrored)));
}

TEST(CirclesAreAmbiguous, KnowsTurnsAndLines) {
  const auto square = [](std::array<CircleColor, 4> colors) {
    std::vector<BoardCircle> circles;
    const V2 corners[] = {{-50, 50}, {50, 50}, {50, -50}, {-50, -50}};
    for (int i = 0; i < 4; ++i) circles.push_back({corners[i], 10, colors[i]});
    return circles;
  };
  const CircleColor r = CircleColor::kRed, g = CircleColor::kGreen, b = CircleColor::kBlue,
                    y = CircleColor::kYellow;
  EXPECT_FALSE(CirclesAreAmbiguous(square({r, g, b, y})));
  EXPECT_FALSE(CirclesAreAmbiguous(square({r, r, r, y})));
  EXPECT_TRUE(CirclesAreAmbiguous(square({r, r, r, r})));
  EXPECT_TRUE(CirclesAreAmbiguous(square({r, g, r, g})));
  std::vector<BoardCircle> line;
  for (int i = 0; i < 5; ++i) line.push_back({{20.0 * i, 3}, 10, static_cast<CircleColor>(i)});
  EXPECT_TRUE(CirclesAreAmbiguous(line));
  EXPECT_TRUE(CirclesAreAmbiguous({}));
}

TEST(ChooseMatch, FollowsTheSearchThatIsAskedFor) {
  const Board board = CircleBoard();
  const Image picture = RenderBoard(board, SmallCamera(), PosesAround(5)[1]);
  const auto circles_of = [&](std::variant<BoardMatch, BoardMismatch> tags, BoardSearch search) {
    const auto match = ChooseMatch(std::move(tags), board, picture, search);
    const auto* found = std::get_if<BoardMatch>(&match);
    return found == nullptr ? -1 : found->circles;
  };
  const BoardMismatch none{"no tag"};
  BoardMatch few, many;
  few.tags = 2;
  many.tags = 3;
  EXPECT_GE(circles_of(none, BoardSearch::kAuto), 6);
  EXPECT_EQ(circles_of(none, BoardSearch::kTags), -1);
  EXPECT_GE(circles_of(few, BoardSearch::kAuto), 6);
  EXPECT_EQ(circles_of(many, BoardSearch::kAuto), 0);
  EXPECT_GE(circles_of(many, BoardSearch::kCircles), 6);
  // Tags that lie elsewhere are believed.
  BoardMatch elsewhere = few;
  elsewhere.pixels = elsewhere.world_pixels = {{10, 10}, {20, 10}, {20, 20}, {10, 20}};
  elsewhere.world_points = {{60, 60, 0}, {70, 60, 0}, {70, 50, 0}, {60, 50, 0}};
  EXPECT_EQ(circles_of(elsewhere, BoardSearch::kCircles), 0);
  const Image black(480, 360, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const auto failed = ChooseMatch(none, board, black, BoardSearch::kAuto);
  ASSERT_TRUE(std::holds_alternative<BoardMismatch>(failed));
  EXPECT_NE(std::get<BoardMismatch>(failed).reason.find("coloured circles"), std::string::npos);
}

}  // namespace
}  // namespace lfm
