// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_conditions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "sample_data/random.h"

namespace lfm {
namespace {

constexpr uint64_t kConditionStream = 31, kOccludedStream = 32, kHalfFrameStream = 33;
constexpr double kGoldenAngle = 2.399963229728653;

// The share of `candidates`, rounded, whose random numbers are lowest.
std::vector<int> DrawShare(const std::vector<int>& candidates, double share, uint64_t seed,
                           uint64_t stream) {
  std::vector<std::pair<uint64_t, int>> order;
  for (int i : candidates) {
    order.emplace_back(RandomStream(seed, stream, static_cast<uint64_t>(i)).Bits(), i);
  }
  std::sort(order.begin(), order.end());
  const auto count = static_cast<size_t>(std::lround(share * static_cast<double>(order.size())));
  std::vector<int> drawn;
  for (size_t k = 0; k < count; ++k) drawn.push_back(order[k].second);
  return drawn;
}

// Evenly over a disc of diameter 1, their mean exactly in the middle (Vogel 1979).
std::vector<Eigen::Vector2d> LensPoints(int count) {
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector2d mean(0, 0);
  for (int i = 0; i < count; ++i) {
    const double radius = 0.5 * std::sqrt((i + 0.5) / count), angle = kGoldenAngle * i;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    mean += points.back() / count;
  }
  for (Eigen::Vector2d& p : points) p -= mean;
  return points;
}

// A stride that visits all of `count` places and jumps far each time.
int ScatteringStride(int count) {
  int stride = std::max(1, static_cast<int>(std::lround(0.618 * count)));
  while (std::gcd(stride, count) != 1) ++stride;
  return stride;
}

}  // namespace

std::vector<PhotoConditions> DrawPhotoConditions(const PhotoTrouble& trouble,
                                                 const std::vector<PhotoSplit>& splits,
                                                 uint64_t seed) {
  std::vector<PhotoConditions> conditions(splits.size());
  std::vector<int> training;
  const double gain_sigma = trouble.white_balance_jitter_percent / 100;
  for (size_t i = 0; i < splits.size(); ++i) {
    if (splits[i] == PhotoSplit::kTrain) training.push_back(static_cast<int>(i));
    RandomStream random(seed, kConditionStream, i);
    PhotoConditions& c = conditions[i];
    c.exposure_stops = trouble.exposure_jitter_stops * random.Normal();
    c.gains.x() = static_cast<float>(std::exp(gain_sigma * random.Normal()));
    c.gains.z() = static_cast<float>(std::exp(gain_sigma * random.Normal()));
    const double angle = 2 * std::numbers::pi * random.Uniform();
    c.travel_mm = trouble.motion_blur_mm * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  }
  for (int i : DrawShare(training, trouble.occluded_share, seed, kOccludedStream)) {
    conditions[static_cast<size_t>(i)].occluded = true;
  }
  for (int i : DrawShare(training, trouble.half_frame_share, seed, kHalfFrameStream)) {
    conditions[static_cast<size_t>(i)].half_framed = true;
  }
  return conditions;
}

double VignettingGain(const Camera& camera, double stops, double x, double y) {
  const double dx = x - (camera.width - 1) / 2.0, dy = y - (camera.height - 1) / 2.0;
  const double w = camera.width, h = camera.height;
  const double r2 = 4 * (dx * dx + dy * dy) / (w * w + h * h);
  const double tan2 = (std::exp2(stops / 2) - 1) * r2;
  return 1 / ((1 + tan2) * (1 + tan2));
}

Pose AimAtBorder(const Camera& camera, const Pose& camera_from_world, const Eigen::Vector3d& point,
                 int side, double along) {
  const double x = -0.5 + along * camera.width, y = -0.5 + along * camera.height;
  const Eigen::Vector2d places[4] = {
      {-0.5, y}, {x, -0.5}, {camera.width - 0.5, y}, {x, camera.height - 0.5}};
  const Eigen::Vector3d aim = Unproject(camera, places[side % 4]);
  const Eigen::Vector3d now = camera_from_world * point;
  const Pose turn{Eigen::Quaterniond::FromTwoVectors(now, aim).toRotationMatrix(),
                  Eigen::Vector3d::Zero()};
  return turn * camera_from_world;
}

std::vector<ExposureSample> ExposureSamples(const Pose& camera_from_world,
                                            const Eigen::Vector3d& travel_mm, double aperture_mm,
                                            double focus_depth_mm, int samples) {
  if (aperture_mm <= 0 && travel_mm.isZero(0)) return {{camera_from_world, 0, 0}};
  const std::vector<Eigen::Vector2d> lens = LensPoints(samples);
  const int stride = ScatteringStride(samples);
  std::vector<ExposureSample> exposures;
  for (int i = 0; i < samples; ++i) {
    const int place = static_cast<int>(int64_t{i} * stride % samples);
    const double time = (place + 0.5) / samples - 0.5;
    const Eigen::Vector2d point = aperture_mm * lens[static_cast<size_t>(i)];
    ExposureSample sample;
    sample.camera_from_world = camera_from_world;
    sample.camera_from_world.translation -=
        time * travel_mm + Eigen::Vector3d(point.x(), point.y(), 0);
    sample.shift_x = static_cast<float>(-point.x() / focus_depth_mm);
    sample.shift_y = static_cast<float>(-point.y() / focus_depth_mm);
    exposures.push_back(sample);
  }
  return exposures;
}

}  // namespace lfm
