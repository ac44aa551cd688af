// SPDX-License-Identifier: BSD-3-Clause
#include "resample/area_sampling.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "resample/light_field.h"

namespace lfm {
namespace {

/// Taps to each side along one axis, and how far apart.
struct Row {
  int count = 0;
  double step_px = 0, deviation_px = 1;

  double Weight(int k) const {
    const double t = k * step_px / deviation_px;
    return std::exp(-t * t / 2);
  }
};

Row RowOf(double variance_px2) {
  constexpr double kLeastDeviation_px = 0.1, kReach = 2.5;
  constexpr int kLeastCount = 2, kMostCount = 32;
  const double deviation = std::sqrt(std::max(0.0, variance_px2));
  if (deviation < kLeastDeviation_px) return {};
  const double reach = kReach * deviation;
  const int count =
      static_cast<int>(std::clamp(std::ceil(reach), double{kLeastCount}, double{kMostCount}));
  return {count, reach / count, deviation};
}

/// Nothing but data from a pixel to the tap.
bool IsReached(const PhotoPixels& photo, const Eigen::Vector2d& pixel,
               const Eigen::Vector2d& offset_px) {
  const int steps = std::max(1, static_cast<int>(std::ceil(offset_px.norm())));
  for (int k = 1; k <= steps; ++k) {
    const auto reading = ReadBilinear(photo, pixel + offset_px * k / steps);
    if (!reading || reading->use != PixelUse::kData) return false;
  }
  return true;
}

/// The mean over the taps; no answer with less than half of the weight.
std::optional<PixelReading> MeanOver(const PhotoPixels& photo, const Eigen::Vector2d& pixel,
                                     const std::vector<FootprintTap>& taps, bool all_are_data) {
  PixelReading mean{PixelUse::kData, {0, 0, 0}, {false, false, false}};
  float weight = 0;
  for (const FootprintTap& tap : taps) {
    if (!all_are_data && !IsReached(photo, pixel, tap.offset_px)) continue;
    const auto reading = ReadBilinear(photo, pixel + tap.offset_px);
    if (!reading || reading->use != PixelUse::kData) {
      return MeanOver(photo, pixel, taps, false);
    }
    weight += tap.weight;
    for (size_t c = 0; c < 3; ++c) {
      mean.level[c] += tap.weight * reading->level[c];
      mean.saturated[c] = mean.saturated[c] || reading->saturated[c];
    }
  }
  if (weight < 0.5F) return std::nullopt;
  for (float& level : mean.level) level /= weight;
  return mean;
}

}  // namespace

std::vector<FootprintTap> FootprintTaps(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d c = a - b;
  const Eigen::Matrix2d hat = (a * a.transpose() + b * b.transpose() + c * c.transpose()) / 12;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(hat);
  const Row u = RowOf(axes.eigenvalues()[0] - 1.0 / 6), v = RowOf(axes.eigenvalues()[1] - 1.0 / 6);
  std::vector<FootprintTap> taps = {{Eigen::Vector2d::Zero(), 1}};
  double sum = 1;
  for (int j = -v.count; j <= v.count; ++j) {
    for (int i = -u.count; i <= u.count; ++i) {
      if (i == 0 && j == 0) continue;
      const double weight = u.Weight(i) * v.Weight(j);
      taps.push_back({axes.eigenvectors() * Eigen::Vector2d(i * u.step_px, j * v.step_px),
                      static_cast<float>(weight)});
      sum += weight;
    }
  }
  for (FootprintTap& tap : taps) tap.weight /= static_cast<float>(sum);
  return taps;
}

SampledView SampleViewByArea(const PhotoPixels& photo, const Camera& camera,
                             const Pose& camera_from_world,
                             const std::vector<Eigen::Vector3d>& points, int edge_samples) {
  const auto corner = [&](int i, int j) {
    const auto index = static_cast<size_t>(PatchSampleIndex(edge_samples, i, j));
    return Project(camera, camera_from_world * points[index]);
  };
  const int last = edge_samples - 1;
  const auto c0 = corner(0, 0), c1 = corner(last, 0), c2 = corner(0, last);
  if (!c0 || !c1 || !c2) return SampleView(photo, camera, camera_from_world, points);
  const std::vector<FootprintTap> taps = FootprintTaps((*c1 - *c0) / last, (*c2 - *c0) / last);
  if (taps.size() == 1) return SampleView(photo, camera, camera_from_world, points);
  SampledView view = UnknownView(points.size());
  for (size_t s = 0; s < points.size(); ++s) {
    const auto pixel = Project(camera, camera_from_world * points[s]);
    const auto centre = pixel ? ReadBilinear(photo, *pixel) : std::nullopt;
    if (!centre || centre->use == PixelUse::kForbidden) {
      HideSample(view, s);
    } else if (centre->use == PixelUse::kData) {
      if (const auto mean = MeanOver(photo, *pixel, taps, true)) SetSample(view, s, *mean);
    }
  }
  return view;
}

}  // namespace lfm
