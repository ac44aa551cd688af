// SPDX-License-Identifier: BSD-3-Clause
#include "calib/corner_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calib/corner_template.h"
#include "core/error.h"
#include "rendered_board.h"

namespace lfm {
namespace {

constexpr double kRefinedRms_abs_px = 0.03;
constexpr double kRefinedWorst_abs_px = 0.2;
constexpr double kRefinedBias_abs_px = 0.005;

Pose Disturbed(const Pose& pose) {
  Pose disturbed = pose;
  disturbed.translation += Eigen::Vector3d(0.6, -0.5, 0.8);
  return disturbed;
}

struct Accuracy {
  size_t corners = 0;
  double rms_px = 0, worst_px = 0;
  Eigen::Vector2d bias_px = Eigen::Vector2d::Zero();
};

Accuracy Measure(const std::vector<CornerObservation>& found,
                 const std::vector<CornerPlace>& corners, const Camera& camera, const Pose& pose) {
  Accuracy accuracy;
  accuracy.corners = found.size();
  for (const CornerObservation& observation : found) {
    const auto projected = Project(camera, pose * corners[observation.corner].position);
    const Eigen::Vector2d error = observation.pixel - *projected;
    accuracy.rms_px += error.squaredNorm();
    accuracy.bias_px += error / static_cast<double>(found.size());
    accuracy.worst_px = std::max(accuracy.worst_px, error.norm());
  }
  accuracy.rms_px = std::sqrt(accuracy.rms_px / static_cast<double>(found.size()));
  return accuracy;
}

class CornerRefinement : public testing::Test {
 protected:
  const Board board_ = DefaultBoard();
  const BoardPrint print_{board_};
  const std::vector<CornerPlace> corners_ = PlaceCorners(board_, {});
  const Camera camera_ = SmallCamera();
  const Pose pose_ = PosesAround(4)[1];

  std::vector<CornerObservation> Find(const Image& gray, const Pose& start,
                                      const CornerSearch& search = {}) const {
    return FindCorners(gray, print_, corners_, camera_, start, search);
  }
};

TEST_F(CornerRefinement, FindsTagAndCheckerCornersToAFewHundredths) {
  ASSERT_EQ(corners_.size(), 24u * 4 + 81);
  for (const Pose& pose : PosesAround(4)) {
    const Image gray = LinearGray(RenderBoard(board_, camera_, pose));
    const Accuracy accuracy =
        Measure(Find(gray, Disturbed(pose), {.max_shift_px = 3}), corners_, camera_, pose);
    EXPECT_GE(accuracy.corners, 130u);
    EXPECT_LT(accuracy.rms_px, kRefinedRms_abs_px);
    EXPECT_LT(accuracy.bias_px.norm(), kRefinedBias_abs_px) << accuracy.bias_px.transpose();
    EXPECT_LT(accuracy.worst_px, kRefinedWorst_abs_px);
  }
}

// What is left of the start would be left alike in all corners of a picture.
TEST_F(CornerRefinement, ForgetsWhereItStarted) {
  const Image gray = LinearGray(RenderBoard(board_, camera_, pose_));
  const auto there = Find(gray, pose_);
  Pose beside = pose_;
  beside.translation += Eigen::Vector3d(0.06, -0.04, 0);  // a tenth of a pixel
  const auto again = Find(gray, beside);
  ASSERT_GE(there.size(), 130u);
  ASSERT_EQ(again.size(), there.size());
  Eigen::Vector2d mean = {0, 0};
  double square = 0;
  for (size_t i = 0; i < there.size(); ++i) {
    ASSERT_EQ(again[i].corner, there[i].corner);
    const Eigen::Vector2d moved = again[i].pixel - there[i].pixel;
    mean += moved / static_cast<double>(there.size());
    square += moved.squaredNorm() / static_cast<double>(there.size());
  }
  EXPECT_LT(mean.norm(), 5e-4) << mean.transpose();
  EXPECT_LT(std::sqrt(square), 1.5e-3);
}

// A picture drawn without any renderer: each pixel of a head-on view at 4 px/mm covers a known
// square of the print. Fixes the tags' orientation and the half pixel.
TEST_F(CornerRefinement, DrawnBoardGivesEveryCornerWithinATwentieth) {
  constexpr double kPixelsPerMm = 3;
  const Image drawing = DrawBoard(board_, kPixelsPerMm);
  Camera camera;
  camera.width = drawing.width(), camera.height = drawing.height();
  camera.fx = camera.fy = 1000 * kPixelsPerMm;
  camera.cx = 110 * kPixelsPerMm - 0.5, camera.cy = 110 * kPixelsPerMm - 0.5;
  // Paper at full white would count as saturated.
  Image gray = LinearGray(drawing);
  for (int i = 0; i < gray.width() * gray.height(); ++i) gray.Data<float>()[i] *= 0.8f;
  const Pose pose = LookAt({0, 0, 1000}, {0, 0, 0}, {0, 1, 0});
  Pose disturbed = pose;
  disturbed.translation += Eigen::Vector3d(0.2, 0.1, 0);
  const auto found = FindCorners(gray, print_, corners_, camera, disturbed, {});
  ASSERT_EQ(found.size(), corners_.size());
  for (const CornerObservation& observation : found) {
    const Eigen::Vector3d& corner = corners_[observation.corner].position;
    const Eigen::Vector2d expected((corner.x() + 110) * kPixelsPerMm - 0.5,
                                   (110 - corner.y()) * kPixelsPerMm - 0.5);
    EXPECT_LT((observation.pixel - expected).norm(), 0.05) << corner.transpose();
  }
}

TEST_F(CornerRefinement, BlurIsEstimatedAndDoesNotMoveCorners) {
  const Image sharp = LinearGray(RenderBoard(board_, camera_, pose_));
  const auto observed = Find(sharp, pose_);
  EXPECT_LE(EstimateBlur(sharp, print_, corners_, camera_, pose_, observed, {}), 0.25);
  const Image blurred = BlurGray(sharp, 1.2);
  const double blur = EstimateBlur(blurred, print_, corners_, camera_, pose_, observed, {});
  EXPECT_NEAR(blur, 1.2, 0.31);
  const Accuracy accuracy =
      Measure(Find(blurred, Disturbed(pose_), {.blur_px = blur, .max_shift_px = 3}), corners_,
              camera_, pose_);
  EXPECT_GE(accuracy.corners, 100u);
  EXPECT_LT(accuracy.rms_px, 2 * kRefinedRms_abs_px);
  EXPECT_LT(accuracy.bias_px.norm(), 2 * kRefinedBias_abs_px);
}

// A template that is blurred too much or too little pulls the corners of every tag inwards or
// pushes them outwards, in all pictures alike: focal length and distance then take it up.
TEST_F(CornerRefinement, TagsAreNeitherShrunkNorGrown) {
  constexpr double kPull_abs_px = 0.003;
  const Camera camera = ScaleCamera(camera_, 1.5);
  const Image sharp = LinearGray(RenderBoard(board_, camera, pose_, {.full_well = 0}));
  for (const double blur_px : {0.0, 0.33}) {
    const Image gray = blur_px > 0 ? BlurGray(sharp, blur_px) : sharp;
    const auto rough = FindCorners(gray, print_, corners_, camera, pose_, {});
    const double estimated = EstimateBlur(gray, print_, corners_, camera, pose_, rough, {});
    double outward = 0;
    int tag_corners = 0;
    for (const CornerObservation& found :
         FindCorners(gray, print_, corners_, camera, pose_, {.blur_px = estimated})) {
      const size_t first = static_cast<size_t>(found.corner) / 4 * 4;
      if (first >= 4 * board_.tags.size()) continue;
      const Eigen::Vector3d middle = (corners_[first].position + corners_[first + 2].position) / 2;
      const Eigen::Vector2d truth = *Project(camera, pose_ * corners_[found.corner].position);
      const Eigen::Vector2d out = truth - *Project(camera, pose_ * middle);
      outward += (found.pixel - truth).dot(out.normalized());
      ++tag_corners;
    }
    ASSERT_GE(tag_corners, 60);
    EXPECT_LT(std::abs(outward / tag_corners), kPull_abs_px) << blur_px << ": " << estimated;
  }
}

TEST_F(CornerRefinement, ComesFromFourPixelsAwayWhenBlurred) {
  const Image gray = LinearGray(RenderBoard(board_, camera_, pose_));
  Pose far = pose_;
  far.translation += Eigen::Vector3d(1.6, 1.0, 0);
  const Image blurred = BlurGray(gray, 1.5);
  const auto found =
      Find(blurred, far, {.blur_px = 1.5, .max_shift_px = 4, .max_relative_residual = 0.15});
  const Accuracy accuracy = Measure(found, corners_, camera_, pose_);
  EXPECT_GE(accuracy.corners, 100u);
  EXPECT_LT(accuracy.rms_px, 0.2);
}

// A plate bent by 4 mm, and tags that lie elsewhere: found where they are, not where the file says.
TEST_F(CornerRefinement, FollowsTheShapeOfThePlatform) {
  PlatformShape shape;
  shape.bend_per_mm = {-3e-4, 0, 1e-4};
  Board moved = board_;
  shape.shifts_mm.assign(corners_.size(), {0, 0});
  for (size_t t = 0; t < moved.tags.size(); ++t) {
    const Eigen::Vector2d shift(0.4 * std::sin(2.0 * t), 0.4 * std::cos(3.0 * t));
    moved.tags[t].center_mm += shift;
    for (int c = 0; c < 4; ++c) shape.shifts_mm[4 * t + c] = shift;
  }
  const Image gray =
      LinearGray(RenderBoard(moved, camera_, pose_, {.bend_per_mm = shape.bend_per_mm}));
  const std::vector<CornerPlace> places = PlaceCornersOfMovedTags(board_, shape);
  const auto found =
      FindCorners(gray, BoardPrint(MoveTags(board_, shape)), places, camera_, pose_, {});
  const Accuracy accuracy = Measure(found, places, camera_, pose_);
  EXPECT_GE(accuracy.corners, 120u);
  EXPECT_LT(accuracy.rms_px, kRefinedRms_abs_px);
  EXPECT_LT(accuracy.bias_px.norm(), kRefinedBias_abs_px);
  EXPECT_LT(FindCorners(gray, print_, corners_, camera_, pose_, {}).size(), found.size() - 20);
}

TEST_F(CornerRefinement, HiddenCornersAreLeftOut) {
  const Image open = RenderBoard(board_, camera_, pose_);
  const Image hidden = RenderBoard(board_, camera_, pose_, {.hidden_share = 0.4});
  const auto found = Find(LinearGray(hidden), pose_);
  EXPECT_LT(found.size(), Find(LinearGray(open), pose_).size());
  EXPECT_GE(found.size(), 60u);
  const Accuracy accuracy = Measure(found, corners_, camera_, pose_);
  EXPECT_LT(accuracy.worst_px, 0.5);
  for (const CornerObservation& observation : found) {
    const double ex = (observation.pixel.x() - 240) / 240, ey = (observation.pixel.y() - 180) / 180;
    EXPECT_GT(std::hypot(ex, ey), 0.38);
  }
}

TEST_F(CornerRefinement, WrongPoseBlankAndSaturatedPicturesGiveNothing) {
  const Image picture = LinearGray(RenderBoard(board_, camera_, pose_));
  EXPECT_LE(Find(picture, PosesAround(4)[3]).size(), 8u);
  Image flat(480, 360, 1, PixelType::kFloat32, ColorEncoding::kLinear);
  for (const float value : {0.0f, 0.5f, 1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    std::fill_n(flat.Data<float>(), flat.size(), value);
    EXPECT_TRUE(Find(flat, pose_).empty()) << value;
  }
  Pose behind = pose_;
  behind.translation.z() = -300;
  EXPECT_TRUE(Find(picture, behind).empty());
  EXPECT_THROW(Find(Image(480, 360, 3, PixelType::kUint8, ColorEncoding::kSrgb), pose_), Error);
}

TEST(CornerTemplate, FootprintIsSymmetricAndHasTheBlursVariance) {
  for (const double blur : {0.0, 0.4, 1.5}) {
    const PixelFootprint footprint = MakePixelFootprint(blur);
    Eigen::Vector2d mean = Eigen::Vector2d::Zero(), variance = Eigen::Vector2d::Zero();
    const double n = static_cast<double>(footprint.x.size());
    for (size_t i = 0; i < footprint.x.size(); ++i) {
      const Eigen::Vector2d o(footprint.x[i], footprint.y[i]);
      mean += o / n;
      variance += o.cwiseAbs2() / n;
    }
    EXPECT_LT(mean.norm(), 1e-7);
    const double expected = 1.0 / 12 + blur * blur;
    EXPECT_NEAR(variance.x(), expected, 0.05 * expected);
    EXPECT_NEAR(variance.y(), expected, 0.05 * expected);
  }
}

// Shortcuts over uniform print must not change what a pixel sees.
TEST(CornerTemplate, UniformRadiusNeverCrossesAnEdge) {
  const BoardPrint print(DefaultBoard());
  int useful = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector2d p(std::fmod(i * 17.31, 219) - 109.5, std::fmod(i * 5.77, 219) - 109.5);
    const double radius = print.UniformRadius(p);
    useful += radius > 0.5;
    for (int k = 0; k < 16; ++k) {
      const double angle = 0.39 * k + i;
      const Eigen::Vector2d q =
          p + radius * 0.999 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      ASSERT_EQ(print.Value(q), print.Value(p)) << p.transpose() << " radius " << radius;
    }
  }
  EXPECT_GT(useful, 1500);
}

}  // namespace
}  // namespace lfm
