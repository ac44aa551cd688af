// SPDX-License-Identifier: BSD-3-Clause
#include "calib/lens_choice.h"

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "rendered_board.h"
#include "simulated_views.h"

namespace lfm {
namespace {

std::vector<BundleView> NoisyViews(const Camera& camera, int count, uint32_t seed) {
  return SimulatedViews(camera, PosesAround(count), DefaultBoard(), 0.05, seed);
}

Camera WithLens(double k1, double k2, double p1, double p2, double k3) {
  Camera camera = SmallCamera();
  camera.k1 = k1, camera.k2 = k2, camera.p1 = p1, camera.p2 = p2, camera.k3 = k3;
  return camera;
}

TEST(LensChoice, TakesTheTermsThatTheLensHas) {
  constexpr double kScale_px = 0.5;
  for (const uint32_t seed : {1u, 2u}) {
    const auto choose = [&](const Camera& camera) {
      return ChooseLensTerms(camera, NoisyViews(camera, 10, seed), kScale_px).terms;
    };
    EXPECT_EQ(choose(WithLens(0, 0, 0, 0, 0)), 0) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0, 0, 0, 0)), 1) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0.2, 0, 0, 0)), 2) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0.2, 2e-3, -2e-3, 0)), 4) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0.2, 2e-3, -2e-3, 1.5)), 5) << seed;
  }
}

// A lens that no polynomial of three terms follows.
TEST(LensChoice, TakesTheRationalModelWhereItIsNeeded) {
  Camera camera = SmallCamera();
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
  camera.k4 = 0.5;
  std::vector<Pose> poses = PosesAround(12);
  for (Pose& pose : poses) pose.translation.z() -= 150;
  const LensChoice choice =
      ChooseLensTerms(camera, SimulatedViews(camera, poses, DefaultBoard(), 0.005, 1), 0.5);
  EXPECT_EQ(choice.terms, kAllLensTerms);
  ASSERT_EQ(choice.trials.size(), 6u);
  EXPECT_LT(choice.trials[5].heldout_rms_px, 0.01);
  EXPECT_GT(choice.trials[4].heldout_rms_px, 1.01 * choice.trials[5].heldout_rms_px);
}

TEST(LensChoice, ViewsOfFewCornersCannotTell) {
  const Camera camera = SmallCamera();
  Board board = DefaultBoard();
  board.checker_columns = board.checker_rows = 0;
  board.tags.resize(1);
  const LensChoice choice =
      ChooseLensTerms(camera, SimulatedViews(camera, PosesAround(9), board, 0.02, 1), 0.5);
  EXPECT_EQ(choice.terms, 1);
  EXPECT_TRUE(choice.trials.empty());
}

TEST(LensModelName, ListsTheTerms) {
  EXPECT_EQ(LensModelName(0), "none");
  EXPECT_EQ(LensModelName(4), "k1 k2 p1 p2");
  EXPECT_EQ(LensModelName(8), "k1 k2 p1 p2 k3 k4 k5 k6");
}

TEST(LensChoice, FewViewsCannotTell) {
  const Camera camera = WithLens(0, 0, 0, 0, 0);
  const LensChoice choice = ChooseLensTerms(camera, NoisyViews(camera, 3, 1), 0.5);
  EXPECT_EQ(choice.terms, kBrownLensTerms);
  EXPECT_TRUE(choice.trials.empty());
}

TEST(LensChoice, DoesNotDependOnTheNumberOfThreads) {
  const Camera camera = WithLens(-0.1, 0.05, 0, 0, 0);
  const std::vector<BundleView> views = NoisyViews(camera, 6, 1);
  SetThreadCount(1);
  const LensChoice one = ChooseLensTerms(camera, views, 0.5);
  SetThreadCount(3);
  const LensChoice three = ChooseLensTerms(camera, views, 0.5);
  EXPECT_EQ(three.terms, one.terms);
  ASSERT_EQ(three.trials.size(), 6u);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(three.trials[i].heldout_rms_px, one.trials[i].heldout_rms_px);
  }
  SetThreadCount(0);
}

TEST(KeepLensTerms, DropsFromTheEndOfTheOrder) {
  const Camera all = WithLens(1, 2, 3, 4, 5);
  const Camera two = KeepLensTerms(all, 2);
  EXPECT_EQ(two.k1, 1);
  EXPECT_EQ(two.k2, 2);
  EXPECT_EQ(two.p1, 0);
  EXPECT_EQ(two.p2, 0);
  EXPECT_EQ(two.k3, 0);
  EXPECT_EQ(KeepLensTerms(all, 4).p2, 4);
  EXPECT_FALSE(KeepLensTerms(all, 0).HasDistortion());
  EXPECT_EQ(KeepLensTerms(all, kAllLensTerms).k3, 5);
  EXPECT_EQ(two.fx, all.fx);
}

}  // namespace
}  // namespace lfm
