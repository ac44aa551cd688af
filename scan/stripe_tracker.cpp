// SPDX-License-Identifier: BSD-3-Clause
#include "scan/stripe_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lfm {
namespace {

constexpr int kBinsPerWidth = 8;
constexpr float kNothing = -std::numeric_limits<float>::infinity();

}  // namespace

StripeTracker::StripeTracker(const StripeShape& stripe, int frames, size_t pixels)
    : stripe_(stripe), pixels_(pixels) {
  bin_ = std::max(1, stripe.width_px / (kBinsPerWidth * stripe.step_px));
  bins_ = frames / bin_;
  const double bins_per_width = stripe.width_px / BinPx();
  radius_ = static_cast<int>(std::ceil(1.25 * bins_per_width)) + 1;
  reach_ = static_cast<int>(bins_per_width / 2);
  const size_t window = static_cast<size_t>(2 * radius_ + 1);
  ring_.assign(window * pixels, 0);
  windows_.assign(window * pixels, 0);
  best_.assign(pixels, kNothing);
  rival_.assign(pixels, kNothing);
  darkest_.assign(pixels, -kNothing);
  peak_.assign(pixels, -1);
}

double StripeTracker::CenterPx(int bin) const {
  const double frame = static_cast<double>(bin) * bin_ + 0.5 * (bin_ - 1);
  return frame * stripe_.step_px - stripe_.width_px;
}

float* StripeTracker::BinValues(int bin) {
  return &ring_[static_cast<size_t>(bin % (2 * radius_ + 1)) * pixels_];
}

const float* StripeTracker::BinValues(int bin) const {
  return &ring_[static_cast<size_t>(bin % (2 * radius_ + 1)) * pixels_];
}

void StripeTracker::Add(const float* values) {
  if (bins_seen_ >= bins_) return;  // frames that fill no bin
  float* sums = BinValues(bins_seen_);
  if (in_bin_ == 0) std::fill_n(sums, pixels_, 0.0F);
  const float share = 1.0F / static_cast<float>(bin_);
  for (size_t p = 0; p < pixels_; ++p) sums[p] += share * values[p];
  if (++in_bin_ == bin_) CloseBin();
}

void StripeTracker::CloseBin() {
  in_bin_ = 0;
  ++bins_seen_;
  if (bins_seen_ > radius_) JudgeBin(bins_seen_ - 1 - radius_);
}

void StripeTracker::Finish() {
  for (int bin = std::max(0, bins_seen_ - radius_); bin < bins_seen_; ++bin) JudgeBin(bin);
}

void StripeTracker::JudgeBin(int bin) {
  const int first = std::max(0, bin - reach_), last = std::min(bins_seen_ - 1, bin + reach_);
  const int window_first = std::max(0, bin - radius_);
  const int window_last = std::min(bins_seen_ - 1, bin + radius_);
  // A mean, so that the first and last bins are not dark for having fewer neighbours.
  std::vector<float> response(pixels_, 0);
  const float share = 1.0F / static_cast<float>(last - first + 1);
  for (int b = first; b <= last; ++b) {
    const float* values = BinValues(b);
    for (size_t p = 0; p < pixels_; ++p) response[p] += share * values[p];
  }
  for (size_t p = 0; p < pixels_; ++p) {
    const float r = response[p];
    darkest_[p] = std::min(darkest_[p], r);
    const bool apart = peak_[p] >= 0 && bin - peak_[p] > radius_;
    if (!(r > best_[p])) {
      if (apart) rival_[p] = std::max(rival_[p], r);
      continue;
    }
    if (apart) rival_[p] = std::max(rival_[p], best_[p]);
    best_[p] = r;
    peak_[p] = bin;
    float* out = &windows_[p * static_cast<size_t>(window())];
    for (int b = window_first; b <= window_last; ++b) out[b - window_first] = BinValues(b)[p];
  }
}

StripeTracker::Moment StripeTracker::At(size_t pixel) const {
  Moment moment;
  moment.peak = peak_[pixel];
  if (moment.peak < 0 || !std::isfinite(best_[pixel]) || !std::isfinite(darkest_[pixel]) ||
      rival_[pixel] == -kNothing) {
    moment.peak = -1;
    return moment;
  }
  moment.first = std::max(0, moment.peak - radius_);
  moment.count = std::min(bins_seen_ - 1, moment.peak + radius_) - moment.first + 1;
  moment.values = &windows_[pixel * static_cast<size_t>(window())];
  const double height = best_[pixel] - darkest_[pixel];
  if (rival_[pixel] > kNothing && height > 0) {
    moment.rival = (rival_[pixel] - darkest_[pixel]) / height;
  }
  return moment;
}

}  // namespace lfm
