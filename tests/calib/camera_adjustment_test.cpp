// SPDX-License-Identifier: BSD-3-Clause
#include "calib/camera_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "calib/calib.h"
#include "rendered_board.h"
#include "simulated_views.h"

namespace lfm {
namespace {

constexpr double kNoisePx = 0.05;

CalibPicture PictureOf(const BundleView& view, size_t index) {
  CalibPicture picture;
  picture.id = "photo_" + std::to_string(index);
  picture.camera = "photo";
  picture.camera_from_world = view.camera_from_world;
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    picture.corners.push_back(
        {view.corners[i], view.pixels[i], kNoisePx * kNoisePx * Eigen::Matrix2d::Identity()});
  }
  return picture;
}

Adjustment AdjustmentOf(const std::vector<BundleView>& views) {
  Adjustment adjustment;
  adjustment.cameras["photo"] = {SmallCamera(), false, 2};
  for (size_t v = 0; v < views.size(); ++v) {
    adjustment.pictures.push_back(PictureOf(views[v], v));
  }
  return adjustment;
}

double MeanNoise(const Adjustment& adjustment) {
  double squared = 0;
  for (const CalibPicture& picture : adjustment.pictures) {
    squared += picture.noise_px * picture.noise_px;
  }
  return std::sqrt(squared / static_cast<double>(adjustment.pictures.size()));
}

TEST(AdjustCorners, NoiseOfIndependentCornersIsFound) {
  const Adjustment adjusted = AdjustCorners(
      AdjustmentOf(SimulatedViews(SmallCamera(), PosesAround(8), DefaultBoard(), kNoisePx, 3)),
      DefaultBoard(), {});
  EXPECT_NEAR(MeanNoise(adjusted), kNoisePx, 0.05 * kNoisePx);
}

// A field of errors that neighbouring corners share is no worse by its squares, but tells less.
TEST(AdjustCorners, WhatNeighboursShareRaisesTheNoise) {
  std::vector<BundleView> views =
      SimulatedViews(SmallCamera(), PosesAround(8), DefaultBoard(), 0, 1);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, kNoisePx);
  constexpr double kCellPx = 30;
  for (BundleView& view : views) {
    std::map<std::pair<int, int>, Eigen::Vector2d> cells;
    for (Eigen::Vector2d& pixel : view.pixels) {
      const std::pair<int, int> cell(static_cast<int>(pixel.x() / kCellPx),
                                     static_cast<int>(pixel.y() / kCellPx));
      if (!cells.contains(cell)) cells[cell] = {normal(random), normal(random)};
      pixel += cells[cell];
    }
  }
  const Adjustment adjusted = AdjustCorners(AdjustmentOf(views), DefaultBoard(), {});
  EXPECT_GT(MeanNoise(adjusted), 1.15 * kNoisePx);
}

TEST(AdjustCorners, NoisyPicturesWeighLess) {
  std::vector<BundleView> views =
      SimulatedViews(SmallCamera(), PosesAround(8), DefaultBoard(), kNoisePx, 3);
  views[2] = SimulatedViews(SmallCamera(), {PosesAround(8)[2]}, DefaultBoard(), 4 * kNoisePx, 9)[0];
  const Adjustment adjusted = AdjustCorners(AdjustmentOf(views), DefaultBoard(), {});
  EXPECT_GT(adjusted.pictures[2].noise_px, 2.5 * adjusted.pictures[1].noise_px);
  const AdjustmentBundle all = BundleOf(adjusted, DefaultBoard(), PhotoSplit::kTrain, {});
  EXPECT_LT(all.bundle.views[2].weight, 0.2 * all.bundle.views[1].weight);
}

TEST(BundleOf, CopiesOfAPictureSayTogetherWhatOneSays) {
  std::vector<BundleView> views =
      SimulatedViews(SmallCamera(), PosesAround(6), DefaultBoard(), kNoisePx, 3);
  for (int copy = 0; copy < 5; ++copy) views.push_back(views[0]);
  Adjustment adjustment = AdjustmentOf(views);
  const AdjustmentBundle train = BundleOf(adjustment, DefaultBoard(), PhotoSplit::kTrain, {});
  EXPECT_EQ(train.repeats[0], 6);
  EXPECT_EQ(train.repeats[1], 1);
  EXPECT_NEAR(train.bundle.views[0].weight, train.bundle.views[1].weight / 6, 1e-12);
  // Copies among test pictures tell cameras and platform nothing: each is posed alone.
  for (CalibPicture& picture : adjustment.pictures) picture.split = PhotoSplit::kTest;
  const AdjustmentBundle test = BundleOf(adjustment, DefaultBoard(), PhotoSplit::kTest, {});
  EXPECT_EQ(test.repeats[0], 1);
}

}  // namespace
}  // namespace lfm
