// SPDX-License-Identifier: BSD-3-Clause
#include "calib/lens_choice.h"

#include <gtest/gtest.h>

#include <random>

#include "calib/corner_refinement.h"
#include "core/parallel.h"
#include "rendered_board.h"

namespace lfm {
namespace {

/// Corners seen through `camera` with noise of 0.05 px.
std::vector<BundleView> NoisyViews(const Camera& camera, int count, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<BundleView> views;
  for (const Pose& pose : PosesAround(count)) {
    BundleView view{pose, {}, {}};
    for (const Eigen::Vector3d& corner : BoardCorners(DefaultBoard())) {
      const auto pixel = Project(camera, pose * corner);
      if (!pixel || !camera.Contains(*pixel)) continue;
      view.points.push_back(corner);
      view.pixels.push_back(*pixel + Eigen::Vector2d(noise(random), noise(random)));
    }
    views.push_back(view);
  }
  return views;
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
      return ChooseLensTerms(camera, NoisyViews(camera, 10, seed), kScale_px);
    };
    EXPECT_EQ(choose(WithLens(0, 0, 0, 0, 0)), 0) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0, 0, 0, 0)), 1) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0.2, 0, 0, 0)), 2) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0.2, 2e-3, -2e-3, 0)), 4) << seed;
    EXPECT_EQ(choose(WithLens(-0.1, 0.2, 2e-3, -2e-3, 1.5)), 5) << seed;
  }
}

TEST(LensChoice, FewViewsCannotTell) {
  const Camera camera = WithLens(0, 0, 0, 0, 0);
  EXPECT_EQ(ChooseLensTerms(camera, NoisyViews(camera, 3, 1), 0.5), kAllLensTerms);
}

TEST(LensChoice, DoesNotDependOnTheNumberOfThreads) {
  const Camera camera = WithLens(-0.1, 0.05, 0, 0, 0);
  const std::vector<BundleView> views = NoisyViews(camera, 6, 1);
  SetThreadCount(1);
  const int one = ChooseLensTerms(camera, views, 0.5);
  SetThreadCount(3);
  EXPECT_EQ(ChooseLensTerms(camera, views, 0.5), one);
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
