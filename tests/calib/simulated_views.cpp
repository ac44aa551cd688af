// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_views.h"

#include <random>

namespace lfm {

std::vector<BundleView> SimulatedViews(const Camera& camera, const std::vector<Pose>& poses,
                                       const Board& board,
                                       const std::vector<Eigen::Vector3d>& truth, double noise_px,
                                       uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const std::vector<Eigen::Vector3d> printed = BoardCorners(board);
  std::vector<BundleView> views;
  for (const Pose& pose : poses) {
    BundleView view{pose, {}, {}};
    for (size_t i = 0; i < printed.size(); ++i) {
      const auto pixel = Project(camera, pose * truth[i]);
      if (!pixel || !camera.Contains(*pixel)) continue;
      view.points.push_back(printed[i]);
      const double dx = noise_px * normal(random), dy = noise_px * normal(random);
      view.pixels.push_back(*pixel + Eigen::Vector2d(dx, dy));
      view.corners.push_back(static_cast<int>(i));
    }
    views.push_back(view);
  }
  return views;
}

std::vector<BundleView> SimulatedViews(const Camera& camera, const std::vector<Pose>& poses,
                                       const Board& board, double noise_px, uint32_t seed) {
  return SimulatedViews(camera, poses, board, BoardCorners(board), noise_px, seed);
}

Eigen::Matrix<double, 6, 1> PoseDifference(const Pose& found, const Pose& truth) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(found.rotation * truth.rotation.transpose()));
  Eigen::Matrix<double, 6, 1> difference;
  difference << turn.angle() * turn.axis(), found.translation - truth.translation;
  return difference;
}

}  // namespace lfm
