// SPDX-License-Identifier: BSD-3-Clause
#include "scan/stripe_decoding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "scan/frame_noise.h"
#include "scan/stripe_fit.h"

namespace lfm {
namespace {

constexpr double kMaxRival = 0.5;
constexpr double kMaxMisfit = 100;  // ten times the noise, root mean square
constexpr double kChance = 3;
constexpr size_t kSampledPixels = 1500;
constexpr double kBlurs[] = {0.3, 0.5, 0.75, 1, 1.4, 2, 2.8, 4, 5.6, 8};

StripeSamples SamplesOf(const StripeTracker& tracker, const StripeTracker::Moment& moment) {
  return {tracker.CenterPx(moment.first), tracker.BinPx(), moment.values, moment.count};
}

/// Pixels that stand for all: lit, with one clear peak inside what was seen.
std::vector<size_t> SamplePixels(const StripeTracker& tracker, const PixelLight& light) {
  std::vector<size_t> clear;
  for (size_t p = 0; p < light.usable.size(); ++p) {
    if (!light.usable[p]) continue;
    const StripeTracker::Moment moment = tracker.At(p);
    if (moment.peak >= 0 && moment.count == tracker.window() && moment.rival < kMaxRival) {
      clear.push_back(p);
    }
  }
  const size_t count = std::min(clear.size(), kSampledPixels);
  std::vector<size_t> some;
  for (size_t i = 0; i < count; ++i) some.push_back(clear[i * clear.size() / count]);
  return some;
}

double MeanMisfit(const StripeTracker& tracker, const std::vector<size_t>& pixels,
                  const StripeModel& model) {
  double sum = 0;
  for (size_t p : pixels) {
    const std::optional<StripeFit> fit =
        FitStripe(model, SamplesOf(tracker, tracker.At(p)), FrameNoise{1, 0});
    // As a share of the stripe's height squared, so that bright pixels do not outvote the rest.
    sum += fit ? std::min(1.0, fit->misfit / (fit->height * fit->height)) : 1.0;
  }
  return pixels.empty() ? 0 : sum / static_cast<double>(pixels.size());
}

double EstimateBlur(const StripeTracker& tracker, const std::vector<size_t>& pixels,
                    StripeModel model) {
  double best = std::numeric_limits<double>::infinity(), blur = kBlurs[0];
  for (const double candidate : kBlurs) {
    model.blur_px = candidate;
    const double misfit = MeanMisfit(tracker, pixels, model);
    if (misfit < best) {
      best = misfit;
      blur = candidate;
    }
  }
  return blur;
}

FrameNoise EstimateNoise(const StripeTracker& tracker, const std::vector<size_t>& pixels,
                         const StripeModel& model) {
  std::vector<NoiseSample> samples;
  for (size_t p : pixels) {
    const StripeSamples seen = SamplesOf(tracker, tracker.At(p));
    const std::optional<StripeFit> fit = FitStripe(model, seen, FrameNoise{1, 0});
    if (!fit) continue;
    const double freedom = static_cast<double>(seen.count - 3) / seen.count;
    for (int i = 0; i < seen.count; ++i) {
      const double offset = fit->position - (seen.first_px + i * seen.step_px);
      const double value = fit->base + fit->height * model.At(offset).value;
      const double residual = seen.values[i] - value;
      samples.push_back(
          {static_cast<float>(value), static_cast<float>(residual * residual / freedom)});
    }
  }
  return FitFrameNoise(std::move(samples), 1);
}

}  // namespace

AxisCoordinates DecodeStripeAxis(const StripeTracker& tracker, const AxisFrames& frames,
                                 const PixelLight& light, const DecodeOptions& options) {
  const size_t pixels = light.usable.size();
  AxisCoordinates out;
  out.position.assign(pixels, 0);
  out.sigma.assign(pixels, 0);
  out.confidence.assign(pixels, 0);
  StripeModel model{frames.stripe.profile, static_cast<double>(frames.stripe.width_px), 0};
  const std::vector<size_t> sample = SamplePixels(tracker, light);
  model.blur_px = EstimateBlur(tracker, sample, model);
  const FrameNoise noise = EstimateNoise(tracker, sample, model);
  for (size_t p = 0; p < pixels; ++p) {
    if (!light.usable[p]) continue;
    const StripeTracker::Moment moment = tracker.At(p);
    if (moment.peak < 0 || moment.rival > kMaxRival) continue;
    const std::optional<StripeFit> fit = FitStripe(model, SamplesOf(tracker, moment), noise);
    if (!fit || fit->misfit > kMaxMisfit) continue;
    const double share = fit->height / light.contrast[p];
    if (!(share >= options.min_modulation)) continue;
    if (!(fit->position > -1) || !(fit->position < frames.size)) continue;
    // What is left over beyond chance is no noise; the position is as much less certain.
    const double sigma = fit->sigma * (fit->misfit > kChance ? std::sqrt(fit->misfit) : 1.0);
    if (!(sigma < frames.stripe.width_px)) continue;
    out.position[p] = static_cast<float>(fit->position);
    out.sigma[p] = static_cast<float>(sigma);
    out.confidence[p] = static_cast<float>(std::clamp(share / 0.8, 0.0, 1.0) *
                                           std::clamp(1 - moment.rival, 0.0, 1.0));
  }
  return out;
}

}  // namespace lfm
