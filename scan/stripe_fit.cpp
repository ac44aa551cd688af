// SPDX-License-Identifier: BSD-3-Clause
#include "scan/stripe_fit.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {
namespace {

constexpr int kMaxIterations = 12;
constexpr double kSettledPx = 1e-4;
// A box is placed by its edges alone, and real edges are no Gaussian's integral: a pixel is square.
constexpr double kEdgeShape = 0.08;

/// Start: the brightness' centre of gravity about the brightest value.
double Centroid(const StripeSamples& s, double base, double width_px) {
  int top = 0;
  for (int i = 1; i < s.count; ++i) top = s.values[i] > s.values[top] ? i : top;
  double sum = 0, moment = 0;
  for (int i = 0; i < s.count; ++i) {
    const double offset = (i - top) * s.step_px;
    if (std::abs(offset) > width_px) continue;
    const double light = std::max(0.0, s.values[i] - base);
    sum += light;
    moment += light * offset;
  }
  return s.first_px + top * s.step_px + (sum > 0 ? moment / sum : 0);
}

/// Where noise cannot say which of many positions is right (no moment falls on the edge of a box),
/// curvature at the best one says nothing: mean and spread of all positions within a step, each as
/// likely as its residuals, base and height held.
void SpreadOverStep(const StripeModel& model, const StripeSamples& samples, const FrameNoise& noise,
                    StripeFit& fit) {
  constexpr int kSide = 12;
  double sum = 0, mean = 0, square = 0, least = 0;
  double cost[2 * kSide + 1];
  for (int g = -kSide; g <= kSide; ++g) {
    const double at = fit.position + g * samples.step_px / (1.5 * kSide);
    double& c = cost[g + kSide];
    c = 0;
    for (int i = 0; i < samples.count; ++i) {
      const double offset = at - (samples.first_px + i * samples.step_px);
      const double predicted = fit.base + fit.height * model.At(offset).value;
      const double residual = samples.values[i] - predicted;
      c += residual * residual / noise.Variance(predicted);
    }
    least = g == -kSide ? c : std::min(least, c);
  }
  for (int g = -kSide; g <= kSide; ++g) {
    const double weight = std::exp(-0.5 * (cost[g + kSide] - least));
    sum += weight;
    mean += weight * g;
    square += weight * g * g;
  }
  mean /= sum;
  const double spacing = samples.step_px / (1.5 * kSide);
  const double sigma = spacing * std::sqrt(std::max(0.0, square / sum - mean * mean));
  // Narrower than the grid resolves, the curvature is right.
  if (sigma < spacing) return;
  fit.position += mean * spacing;
  fit.sigma = sigma;
}

}  // namespace

StripeModel::Value StripeModel::At(double u) const {
  const double b = std::max(blur_px, 1e-3);
  if (profile == StripeProfile::kGauss) {
    const double s = width_px / std::sqrt(8 * std::numbers::ln2);
    const double t2 = s * s + b * b;
    const double value = s / std::sqrt(t2) * std::exp(-u * u / (2 * t2));
    return {value, -u / t2 * value};
  }
  const double left = (u + width_px / 2) / b, right = (u - width_px / 2) / b;
  const double density = 1 / (b * std::sqrt(2 * std::numbers::pi));
  return {0.5 * (std::erf(left / std::numbers::sqrt2) - std::erf(right / std::numbers::sqrt2)),
          density * (std::exp(-left * left / 2) - std::exp(-right * right / 2))};
}

std::optional<StripeFit> FitStripe(const StripeModel& model, const StripeSamples& samples,
                                   const FrameNoise& noise) {
  if (samples.count < 4) return std::nullopt;
  float low = samples.values[0], high = low;
  for (int i = 0; i < samples.count; ++i) {
    if (!std::isfinite(samples.values[i])) return std::nullopt;
    low = std::min(low, samples.values[i]);
    high = std::max(high, samples.values[i]);
  }
  if (!(high > low)) return std::nullopt;
  StripeFit fit{Centroid(samples, low, model.width_px), 0, low, high - low, 0};
  const double begin = samples.first_px;
  const double end = begin + samples.step_px * (samples.count - 1);
  Eigen::Matrix3d normal;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    normal.setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double cost = 0;
    for (int i = 0; i < samples.count; ++i) {
      const StripeModel::Value s = model.At(fit.position - (begin + i * samples.step_px));
      const double predicted = fit.base + fit.height * s.value;
      const double residual = samples.values[i] - predicted;
      const double weight = 1 / noise.Variance(predicted);
      const Eigen::Vector3d row(1, s.value, fit.height * s.slope);
      normal += weight * row * row.transpose();
      right += weight * residual * row;
      cost += weight * residual * residual;
    }
    fit.misfit = cost / (samples.count - 3);
    // A box may lie so that its position, to first order, changes nothing.
    normal(2, 2) += 1 / (model.width_px * model.width_px);
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
    if (!solver.isInvertible()) return std::nullopt;
    const Eigen::Vector3d step = solver.solve(right);
    fit.base += step(0);
    fit.height += step(1);
    // A bad start must not throw the stripe out of what was seen of it.
    const double move = std::clamp(step(2), -model.width_px / 2, model.width_px / 2);
    fit.position += move;
    if (!(fit.height > 0) || !(fit.position >= begin) || !(fit.position <= end)) {
      return std::nullopt;
    }
    if (std::abs(move) < kSettledPx) break;
  }
  const double variance = normal.inverse()(2, 2);
  if (!(variance > 0) || !std::isfinite(variance)) return std::nullopt;
  fit.sigma = std::sqrt(variance);
  if (model.profile == StripeProfile::kBox) {
    SpreadOverStep(model, samples, noise, fit);
    fit.sigma = std::hypot(fit.sigma, kEdgeShape * model.blur_px);
  }
  return fit;
}

}  // namespace lfm
