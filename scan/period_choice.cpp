// SPDX-License-Identifier: BSD-3-Clause
#include "scan/period_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lfm {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr float kLikelihoodPerBit = 23;

/// The Gray code's bit at whole coordinate x, -1 or 1, falling to 0 at the bit's edges over a
/// quarter of a period.
double ExpectedBit(int x, int shift, int period) {
  const int value = ((x ^ (x >> 1)) >> shift) & 1;
  // Edges of this bit lie half a pixel before the odd multiples of 2^shift.
  const double half = std::ldexp(1.0, shift);
  const double from_edge = std::abs(std::remainder(x + 0.5 - half, 2 * half));
  return (value ? 1 : -1) * std::min(1.0, 4 * from_edge / period);
}

}  // namespace

PeriodChooser::PeriodChooser(const AxisFrames& frames)
    : size_(frames.size),
      period_px_(frames.phases.front().period_px),
      candidates_((frames.size + period_px_) / period_px_),
      bits_(static_cast<int>(frames.gray.size())),
      scores_(static_cast<size_t>(candidates_)) {
  MakeBitTable(frames);
  double least = 0.5;
  for (int k = 1; k < candidates_; ++k) {
    double seen = 0;
    for (size_t j = 1; j < frames.phases.size(); ++j) {
      const double turns = 1.0 * k * period_px_ / frames.phases[j].period_px;
      seen = std::max(seen, std::abs(std::remainder(turns, 1.0)));
    }
    if (seen > 0) least = std::min(least, seen);
  }
  half_step_ = std::numbers::pi * least;
  for (size_t j = 1; j < frames.phases.size(); ++j) {
    longer_.push_back(frames.phases[j].period_px);
    for (int k = 0; k < candidates_; ++k) {
      const double angle = kTurn * k * period_px_ / longer_.back();
      cosines_.push_back(static_cast<float>(std::cos(angle)));
      sines_.push_back(static_cast<float>(std::sin(angle)));
    }
  }
}

void PeriodChooser::MakeBitTable(const AxisFrames& frames) {
  if (bits_ == 0) return;
  places_ = std::min(period_px_, size_) + 1;
  const size_t row = static_cast<size_t>(candidates_);
  bit_table_.resize(static_cast<size_t>(places_) * static_cast<size_t>(bits_) * row);
  for (int place = 0; place < places_; ++place) {
    for (int bit = 0; bit < bits_; ++bit) {
      float* out = &bit_table_[(static_cast<size_t>(place) * bits_ + bit) * row];
      for (int k = 0; k < candidates_; ++k) {
        const int x = std::clamp(place - 1 + k * period_px_, 0, size_ - 1);
        out[k] = kLikelihoodPerBit *
                 static_cast<float>(ExpectedBit(x, frames.bits - 1 - bit, period_px_));
      }
    }
  }
}

std::optional<ChosenPeriod> PeriodChooser::Choose(double fraction_px,
                                                  const PeriodEvidence& evidence) {
  const int place = static_cast<int>(std::lround(fraction_px)) + 1;
  if (place < 0 || (bits_ > 0 && place >= places_) || !(fraction_px < size_)) return std::nullopt;
  std::fill(scores_.begin(), scores_.end(), 0.0F);
  for (int bit = 0; bit < bits_; ++bit) {
    const float* table = &bit_table_[(static_cast<size_t>(place) * bits_ + bit) * scores_.size()];
    const float b = evidence.bits[static_cast<size_t>(bit)];
    for (size_t k = 0; k < scores_.size(); ++k) scores_[k] += b * table[k];
  }
  for (size_t j = 0; j < longer_.size(); ++j) {
    const double angle = evidence.phases[j] - kTurn * fraction_px / longer_[j];
    const double weight = 1 / (evidence.variances[j] + half_step_ * half_step_ / 16);
    const float c = static_cast<float>(weight * std::cos(angle));
    const float s = static_cast<float>(weight * std::sin(angle));
    const float* cosines = &cosines_[j * scores_.size()];
    const float* sines = &sines_[j * scores_.size()];
    for (size_t k = 0; k < scores_.size(); ++k) scores_[k] += c * cosines[k] + s * sines[k];
  }
  const size_t valid =
      std::min(scores_.size(), static_cast<size_t>(std::ceil((size_ - fraction_px) / period_px_)));
  float best = -std::numeric_limits<float>::infinity(), second = best;
  size_t found = 0;
  for (size_t k = 0; k < valid; ++k) {
    if (scores_[k] > best) found = k;
    second = std::max(second, std::min(best, scores_[k]));
    best = std::max(best, scores_[k]);
  }
  const bool alone = bits_ == 0 && longer_.empty();
  if (valid == 0 || !(best > 0 || alone)) return std::nullopt;
  ChosenPeriod chosen;
  chosen.position = fraction_px + static_cast<double>(found) * period_px_;
  chosen.margin = valid == 1 ? std::numeric_limits<double>::infinity() : best - second;
  return chosen;
}

}  // namespace lfm
