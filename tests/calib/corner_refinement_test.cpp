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

constexpr double kRefinedRms_abs_px = 0.05;
constexpr double kRefinedBias_abs_px = 0.01;

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
                 const std::vector<Eigen::Vector3d>& corners, const Camera& camera,
                 const Pose& pose) {
  Accuracy accuracy;
  accuracy.corners = found.size();
  for (const CornerObservation& observation : found) {
    const auto projected = Project(camera, pose * corners[observation.corner]);
    const Eigen::Vector2d error = observation.pixel - *projected;
    accuracy.rms_px += error.squaredNorm();
    accuracy.bias_px += error / static_cast<double>(found.size());
    accuracy.worst_px = std::max(accuracy.worst_px, error.norm());
  }
  accuracy.rms_px = std::sqrt(accuracy.rms_px / static_cast<double>(found.size()));
  return accuracy;
}

TEST(CornerRefinement, FindsTagAndCheckerCornersToAFewHundredths) {
  const Board board = DefaultBoard();
  const BoardPrint print(board);
  const auto corners = BoardCorners(board);
  ASSERT_EQ(corners.size(), 24u * 4 + 81);
  const Camera camera = SmallCamera();
  for (const Pose& pose : PosesAround(4)) {
    const Image gray = LinearGray(RenderBoard(print, camera, pose));
    const auto found =
        FindCorners(gray, print, corners, camera, Disturbed(pose), {.max_shift_px = 3});
    const Accuracy accuracy = Measure(found, corners, camera, pose);
    EXPECT_GE(accuracy.corners, 150u);
    EXPECT_LT(accuracy.rms_px, kRefinedRms_abs_px);
    EXPECT_LT(accuracy.bias_px.norm(), kRefinedBias_abs_px);
    EXPECT_LT(accuracy.worst_px, 0.25);
    RecordProperty("rms_px", std::to_string(accuracy.rms_px));
    std::printf("corners %zu rms %.4f bias %.4f worst %.3f\n", accuracy.corners, accuracy.rms_px,
                accuracy.bias_px.norm(), accuracy.worst_px);
  }
}

}  // namespace
}  // namespace lfm
