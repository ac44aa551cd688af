// SPDX-License-Identifier: BSD-3-Clause
#include "calib/platform_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "rendered_board.h"
#include "simulated_views.h"

namespace lfm {
namespace {

constexpr double kNoisePx = 0.04, kPriorMm = 0.3;
constexpr int kTerms = 4;

struct Staged {
  Board board = DefaultBoard();
  std::vector<Eigen::Vector3d> truth;  ///< where the corners are
};

// Every tag moved by 0.2 mm (standard deviation), the checker in place.
Staged MovedTags() {
  Staged staged;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.2);
  Board moved = staged.board;
  for (BoardTag& tag : moved.tags) tag.center_mm += Eigen::Vector2d(normal(random), normal(random));
  staged.truth = BoardCorners(moved);
  return staged;
}

JointBundle BundleOfStaged(const Staged& staged) {
  return {{{SmallCamera(), FreeIntrinsics::kAll, kTerms}},
          SimulatedViews(SmallCamera(), PosesAround(16), staged.board, staged.truth, kNoisePx, 5)};
}

PlatformChoice Choose(const Staged& staged) {
  return ChoosePlatform(staged.board, BundleOfStaged(staged), kPriorMm, kNoisePx, 0.5);
}

JointResult Adjust(const Staged& staged, const PlatformModel& model) {
  JointBundle bundle = BundleOfStaged(staged);
  bundle.platform = MakePlatformUnknowns(staged.board, model);
  bundle.platform->prior_mm = kPriorMm;
  bundle.platform->noise_px = kNoisePx;
  return AdjustJointly(bundle, 0.5, 100);
}

double WorstCorner(const Staged& staged, const PlatformShape& shape) {
  const std::vector<Eigen::Vector3d> found = CornerPositions(BoardCorners(staged.board), shape);
  double worst = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    worst = std::max(worst, (found[i] - staged.truth[i]).norm());
  }
  return worst;
}

TEST(PlatformChoice, LeavesAGoodPrintAlone) {
  Staged staged;
  staged.truth = BoardCorners(staged.board);
  const PlatformChoice choice = Choose(staged);
  EXPECT_EQ(PlatformModelName(choice.model), "as printed");
  EXPECT_EQ(choice.trials.size(), 4u);  // corners are not even tried
}

TEST(PlatformChoice, FindsTagsThatLieElsewhere) {
  constexpr double kFound_abs_mm = 0.03;
  const Staged staged = MovedTags();
  const PlatformChoice choice = Choose(staged);
  EXPECT_EQ(PlatformModelName(choice.model), "tags moved");
  const JointResult result = Adjust(staged, choice.model);
  EXPECT_LT(WorstCorner(staged, result.shape), kFound_abs_mm);
  EXPECT_GT(WorstCorner(staged, {}), 10 * kFound_abs_mm);
  const std::vector<Pose> poses = PosesAround(16);
  for (size_t v = 0; v < poses.size(); ++v) {
    EXPECT_LT((result.poses[v].Center() - poses[v].Center()).norm(), 0.2) << v;
  }
}

TEST(PlatformChoice, FindsABentPlateWithAndWithoutMovedTags) {
  constexpr double kFound_abs_mm = 0.05;
  for (const bool moved : {false, true}) {
    Staged staged = moved ? MovedTags() : Staged{DefaultBoard(), BoardCorners(DefaultBoard())};
    const std::vector<Eigen::Vector3d> printed = BoardCorners(staged.board);
    for (size_t i = 0; i < printed.size(); ++i) {
      staged.truth[i].z() = -1e-4 * printed[i].x() * printed[i].x();  // 1.2 mm at the edge
    }
    const PlatformChoice choice = Choose(staged);
    EXPECT_EQ(PlatformModelName(choice.model), moved ? "tags moved, bent" : "bent");
    const JointResult result = Adjust(staged, choice.model);
    EXPECT_NEAR(result.shape.bend_per_mm.x(), -1e-4, 3e-6);
    EXPECT_NEAR(result.shape.bend_per_mm.y(), 0, 3e-6);
    EXPECT_LT(WorstCorner(staged, result.shape), kFound_abs_mm);
  }
}

// A paper that stretched in one direction moves every corner by itself.
TEST(PlatformChoice, FindsAStretchedSheet) {
  Staged staged;
  staged.truth = BoardCorners(staged.board);
  for (Eigen::Vector3d& p : staged.truth) p.x() *= 1.004;
  const PlatformChoice choice = Choose(staged);
  EXPECT_EQ(choice.model.moves, PlatformMoves::kCorners);
  // The stretch is found; what size the whole is, pictures cannot tell: it stays the file's.
  const JointResult result = Adjust(staged, choice.model);
  const std::vector<Eigen::Vector3d> found =
      CornerPositions(BoardCorners(staged.board), result.shape);
  double xx = 0, yy = 0, fx = 0, fy = 0;
  const std::vector<Eigen::Vector3d> printed = BoardCorners(staged.board);
  for (size_t i = 0; i < printed.size(); ++i) {
    xx += printed[i].x() * printed[i].x(), fx += printed[i].x() * found[i].x();
    yy += printed[i].y() * printed[i].y(), fy += printed[i].y() * found[i].y();
  }
  EXPECT_NEAR(fx / xx - fy / yy, 0.004, 2e-4);
  EXPECT_NEAR((fx / xx + fy / yy) / 2, 1, 2e-4);
}

// Tags alone, all printed one percent too large: every camera is farther away, no residual shows
// it.
TEST(PlatformChoice, ScaleIsObservableThroughThePriorOnly) {
  Staged staged;
  staged.board.checker_columns = staged.board.checker_rows = 0;
  staged.truth = BoardCorners(staged.board);
  for (Eigen::Vector3d& p : staged.truth) p *= 1.01;
  EXPECT_EQ(PlatformModelName(Choose(staged).model), "as printed");
  const JointResult result = Adjust(staged, {PlatformMoves::kCorners, false});
  double scale = 0, size = 0;
  const std::vector<Eigen::Vector3d> printed = BoardCorners(staged.board);
  for (size_t i = 0; i < printed.size(); ++i) {
    scale += result.shape.shifts_mm[i].dot(printed[i].head<2>());
    size += printed[i].squaredNorm();
  }
  EXPECT_LT(std::abs(scale / size), 1e-4);
  EXPECT_NEAR(result.poses[0].Center().norm() * 1.01, PosesAround(16)[0].Center().norm(), 0.3);
}

TEST(PlatformChoice, FewViewsOrCornersCannotTell) {
  Staged staged = MovedTags();
  JointBundle bundle = BundleOfStaged(staged);
  bundle.views.resize(7);
  const PlatformChoice choice = ChoosePlatform(staged.board, bundle, kPriorMm, kNoisePx, 0.5);
  EXPECT_EQ(PlatformModelName(choice.model), "as printed");
  EXPECT_TRUE(choice.trials.empty());
}

TEST(PlatformShape, PlacesCornersAndTellsTheSlope) {
  PlatformShape shape;
  const Board board = DefaultBoard();
  shape.bend_per_mm = {1e-4, 2e-4, -3e-4};
  shape.shifts_mm.assign(BoardCorners(board).size(), {0.5, -0.25});
  const CornerPlace place = PlaceCorners(board, shape)[7];
  const double x = place.printed.x(), y = place.printed.y();
  EXPECT_EQ(place.position.x(), x + 0.5);
  EXPECT_EQ(place.position.y(), y - 0.25);
  EXPECT_NEAR(place.position.z(), 1e-4 * x * x + 2e-4 * x * y - 3e-4 * y * y, 1e-12);
  EXPECT_NEAR(place.slope.x(), 2e-4 * x + 2e-4 * y, 1e-12);
  EXPECT_NEAR(place.slope.y(), 2e-4 * x - 6e-4 * y, 1e-12);
  shape.shifts_mm.pop_back();
  EXPECT_THROW(PlaceCorners(board, shape), Error);
}

TEST(PlatformModel, NamesRoundTrip) {
  for (const PlatformMoves moves :
       {PlatformMoves::kNone, PlatformMoves::kTags, PlatformMoves::kCorners}) {
    for (const bool bent : {false, true}) {
      const PlatformModel read = PlatformModelFromName(PlatformModelName({moves, bent}));
      EXPECT_EQ(read.moves, moves);
      EXPECT_EQ(read.bent, bent);
    }
  }
  EXPECT_THROW(PlatformModelFromName("flat"), Error);
}

}  // namespace
}  // namespace lfm
