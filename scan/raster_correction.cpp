// SPDX-License-Identifier: BSD-3-Clause
#include "scan/raster_correction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kIterations = 20;
constexpr double kMaxSteepness = 0.8;  // of e, for the iteration to converge
constexpr double kJumpPx = 12;         // projector px between neighbours: another surface
constexpr double kLeftShare = 0.15;    // of e's swing after its removal: slopes are not exact
constexpr double kOutlierPx = 0.5;
constexpr size_t kMinPoints = 200;
constexpr double kMinSignificance = 5;

double Sinc(double x) {
  const double a = kPi * x;
  return std::abs(a) < 1e-6 ? 1 - a * a / 6 : std::sin(a) / a;
}

bool Known(const Eigen::Vector2d& slope) { return slope.allFinite() && slope.squaredNorm() > 0; }

/// e's first two amplitudes, for gain 1.
Eigen::Vector2d Amplitudes(const Eigen::Vector2d& slope) {
  return {-Sinc(slope.x()) * Sinc(slope.y()) / kPi,
          Sinc(2 * slope.x()) * Sinc(2 * slope.y()) / (2 * kPi)};
}

/// e's largest derivative.
double Steepness(const Eigen::Vector2d& slope, double gain) {
  const Eigen::Vector2d a = Amplitudes(slope);
  return 2 * kPi * (gain * std::abs(a.x()) + 2 * std::pow(gain, 4) * std::abs(a.y()));
}

bool CanRemove(const Eigen::Vector2d& slope, double gain) {
  return gain > 0 && Known(slope) && Steepness(slope, gain) < kMaxSteepness;
}

/// Difference between two pixels; none where either is not decoded, or they jump.
std::optional<double> Difference(const AxisCoordinates& axis, size_t before, size_t after) {
  if (axis.confidence[before] <= 0 || axis.confidence[after] <= 0) return std::nullopt;
  const double difference = axis.position[after] - axis.position[before];
  if (!(std::abs(difference) <= kJumpPx)) return std::nullopt;
  return difference;
}

double SlopeAlong(const AxisCoordinates& axis, size_t p, size_t stride, int place, int size) {
  for (const size_t reach : {2, 1}) {
    const int r = static_cast<int>(reach);
    if (place < r || place + r >= size) continue;
    const auto both = Difference(axis, p - reach * stride, p + reach * stride);
    if (both) return *both / (2 * r);
  }
  if (place + 1 < size) {
    const auto ahead = Difference(axis, p, p + stride);
    if (ahead) return *ahead;
  }
  if (place > 0) return Difference(axis, p - stride, p).value_or(0);
  return 0;
}

}  // namespace

double RasterOffsetPx(double position, const Eigen::Vector2d& slope, double gain) {
  const Eigen::Vector2d a = Amplitudes(slope);
  const double phase = 2 * kPi * (position - std::floor(position));
  return gain * a.x() * std::sin(phase) + std::pow(gain, 4) * a.y() * std::sin(2 * phase);
}

double RemoveRaster(double decoded, const Eigen::Vector2d& slope, double gain) {
  if (!CanRemove(slope, gain)) return decoded;
  double position = decoded;
  for (int i = 0; i < kIterations; ++i) {
    const double next = decoded - RasterOffsetPx(position, slope, gain);
    const bool settled = std::abs(next - position) < 1e-7;
    position = next;
    if (settled) break;
  }
  return position;
}

Eigen::Vector2d SlopeAt(const AxisCoordinates& axis, int width, int height, int x, int y) {
  const size_t p = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  return {SlopeAlong(axis, p, 1, x, width),
          SlopeAlong(axis, p, static_cast<size_t>(width), y, height)};
}

AxisCoordinates CorrectRaster(AxisCoordinates axis, int width, int height, double gain) {
  if (gain <= 0) return axis;
  AxisCoordinates corrected = axis;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t p = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      if (axis.confidence[p] <= 0) continue;
      const Eigen::Vector2d slope = SlopeAt(axis, width, height, x, y);
      const double share = CanRemove(slope, gain) ? kLeftShare : 1;
      const double left = share * gain * std::abs(Amplitudes(slope).x()) / std::numbers::sqrt2;
      corrected.position[p] = static_cast<float>(RemoveRaster(axis.position[p], slope, gain));
      corrected.sigma[p] = static_cast<float>(std::hypot(axis.sigma[p], left));
    }
  }
  return corrected;
}

std::vector<PlateCorrespondence> CorrectRaster(std::vector<PlateCorrespondence> all, double gain) {
  for (PlateCorrespondence& c : all) {
    c.projector_px.x() = RemoveRaster(c.projector_px.x(), c.column_slope, gain);
    c.projector_px.y() = RemoveRaster(c.projector_px.y(), c.row_slope, gain);
  }
  return all;
}

double FitRasterGain(const RigState& state, const std::vector<PlateCorrespondence>& all) {
  double product = 0, square = 0, residual_square = 0;
  size_t count = 0;
  for (const PlateCorrespondence& c : all) {
    const std::optional<Eigen::Vector2d> off = RigResidualPx(state, c);
    if (!off) continue;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d& slope = axis == 0 ? c.column_slope : c.row_slope;
      if (!Known(slope) || !(c.sigma_px[axis] > 0)) continue;
      const double decoded_off = -(*off)[axis];
      if (!(std::abs(decoded_off) <= kOutlierPx)) continue;
      const double place = c.projector_px[axis] - decoded_off;
      const double basis = Amplitudes(slope).x() * std::sin(2 * kPi * (place - std::floor(place)));
      product += basis * decoded_off;
      square += basis * basis;
      residual_square += decoded_off * decoded_off;
      ++count;
    }
  }
  if (count < kMinPoints || !(square > 0)) return 0;
  const double gain = product / square;
  const double left = std::max(0.0, residual_square - gain * product);
  const double sigma = std::sqrt(left / static_cast<double>(count) / square);
  return gain > kMinSignificance * sigma ? std::min(gain, 1.5) : 0;
}

}  // namespace lfm
