// SPDX-License-Identifier: BSD-3-Clause
#include "scan/phase_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {
namespace {

constexpr int kMaxHarmonics = 3;
constexpr double kTurn = 2 * std::numbers::pi;

/// out += factor * values
void Accumulate(const float* values, float factor, size_t count, float* out) {
  for (size_t i = 0; i < count; ++i) out[i] += factor * values[i];
}

/// Coefficients of a harmonic, for all pixels.
void Project(const float* frames, size_t stride, int steps, int harmonic, size_t count,
             std::vector<float>& cosine, std::vector<float>& sine) {
  cosine.assign(count, 0);
  sine.assign(count, 0);
  for (int i = 0; i < steps; ++i) {
    const double angle = kTurn * harmonic * i / steps;
    const float* frame = frames + static_cast<size_t>(i) * stride;
    Accumulate(frame, static_cast<float>(2 * std::cos(angle) / steps), count, cosine.data());
    Accumulate(frame, static_cast<float>(2 * std::sin(angle) / steps), count, sine.data());
  }
}

}  // namespace

int FittedHarmonics(int steps) { return std::clamp((steps - 2) / 2, 1, kMaxHarmonics); }

int ResidualFreedom(int steps) { return std::max(0, steps - 1 - 2 * FittedHarmonics(steps)); }

void FitPhases(const float* frames, size_t stride, int steps, size_t count, PhaseFits& fits) {
  fits.offset.assign(count, 0);
  for (int i = 0; i < steps; ++i) {
    Accumulate(frames + static_cast<size_t>(i) * stride, 1.0F / static_cast<float>(steps), count,
               fits.offset.data());
  }
  Project(frames, stride, steps, 1, count, fits.cosine, fits.sine);
  fits.residual.assign(count, 0);
  const int freedom = ResidualFreedom(steps);
  if (freedom == 0) return;
  std::vector<float> cosine[kMaxHarmonics + 1], sine[kMaxHarmonics + 1], rest(count);
  for (int h = 2; h <= FittedHarmonics(steps); ++h) {
    Project(frames, stride, steps, h, count, cosine[h], sine[h]);
  }
  for (int i = 0; i < steps; ++i) {
    const float* frame = frames + static_cast<size_t>(i) * stride;
    for (size_t p = 0; p < count; ++p) rest[p] = frame[p] - fits.offset[p];
    for (int h = 1; h <= FittedHarmonics(steps); ++h) {
      const double angle = kTurn * h * i / steps;
      Accumulate((h == 1 ? fits.cosine : cosine[h]).data(), static_cast<float>(-std::cos(angle)),
                 count, rest.data());
      Accumulate((h == 1 ? fits.sine : sine[h]).data(), static_cast<float>(-std::sin(angle)), count,
                 rest.data());
    }
    for (size_t p = 0; p < count; ++p) fits.residual[p] += rest[p] * rest[p];
  }
  for (float& r : fits.residual) r /= static_cast<float>(freedom);
}

double PhaseCorrection::Apply(double phase) const {
  if (steps == 0) return phase;
  const double angle = steps * phase;
  return phase + 2.0 / steps * (cosine * std::sin(angle) - sine * std::cos(angle));
}

PhaseCorrection EstimateCorrection(const std::vector<float>& phases, int steps) {
  constexpr size_t kLeastPixels = 4096;
  constexpr double kLeastMean = 0.02;
  if (phases.size() < kLeastPixels) return {};
  PhaseCorrection correction{steps, 0, 0};
  for (const float phase : phases) {
    correction.cosine += std::cos(steps * static_cast<double>(phase));
    correction.sine += std::sin(steps * static_cast<double>(phase));
  }
  correction.cosine /= static_cast<double>(phases.size());
  correction.sine /= static_cast<double>(phases.size());
  return std::hypot(correction.cosine, correction.sine) >= kLeastMean ? correction
                                                                      : PhaseCorrection{};
}

}  // namespace lfm
