// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/pattern_table.h"

#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

constexpr int kPlacesWhenBlurred = 4;

bool IsConstant(const Pattern& pattern) {
  return pattern.kind == PatternKind::kWhite || pattern.kind == PatternKind::kBlack;
}

// Values of the frames `slots` at every pixel along an axis, pixel by pixel.
std::vector<double> ShownValues(const PatternSequence& sequence, const std::vector<int>& slots,
                                PatternAxis axis, int size, double gamma) {
  std::vector<double> values;
  for (int x = 0; x < size; ++x) {
    for (int frame : slots) {
      const Pattern& pattern = sequence.patterns[frame];
      const double value = axis == PatternAxis::kColumn ? PatternValue(sequence, pattern, x, 0)
                                                        : PatternValue(sequence, pattern, 0, x);
      values.push_back(gamma == 1 ? value : std::pow(value, gamma));
    }
  }
  return values;
}

// Three frames after each other share a picture; `slots` in manifest order.
void LeakColors(const PatternSequence& sequence, const std::vector<int>& slots, double leak,
                std::vector<double>& values) {
  std::vector<size_t> colored;
  for (size_t i = 0; i < slots.size(); ++i) {
    if (!IsConstant(sequence.patterns[slots[i]])) colored.push_back(i);
  }
  for (size_t first = 0; first < colored.size(); first += 3) {
    const size_t count = std::min<size_t>(3, colored.size() - first);
    for (size_t pixel = 0; pixel < values.size(); pixel += slots.size()) {
      double sum = 0;
      for (size_t k = 0; k < count; ++k) sum += values[pixel + colored[first + k]];
      for (size_t k = 0; k < count; ++k) {
        double& own = values[pixel + colored[first + k]];
        own = (1 - static_cast<double>(count) * leak) * own + leak * sum;
      }
    }
  }
}

// At `places` points a pixel: the pixels' squares convolved with a Gaussian; exact, by its
// integral over each pixel.
std::vector<float> Blur(const std::vector<double>& values, int size, int slots, double sigma,
                        int places) {
  std::vector<float> blurred(static_cast<size_t>(size) * places * slots, 0.0f);
  const int reach = static_cast<int>(std::ceil(5 * sigma)) + 1;
  const double scale = 1 / (sigma * std::sqrt(2.0));
  for (int i = 0; i < size * places; ++i) {
    // In the frame where pixel k covers [k, k + 1).
    const double at = (i + 0.5) / places;
    const int middle = static_cast<int>(at);
    for (int k = std::max(0, middle - reach); k <= std::min(size - 1, middle + reach); ++k) {
      const double weight = 0.5 * (std::erf((k + 1 - at) * scale) - std::erf((k - at) * scale));
      for (int s = 0; s < slots; ++s) {
        blurred[static_cast<size_t>(i) * slots + s] +=
            static_cast<float>(weight * values[static_cast<size_t>(k) * slots + s]);
      }
    }
  }
  return blurred;
}

std::vector<float> MakeTable(const PatternSequence& sequence, const std::vector<int>& slots,
                             PatternAxis axis, int size, const ScanTrouble& trouble, int places) {
  std::vector<double> values = ShownValues(sequence, slots, axis, size, trouble.projector_gamma);
  if (trouble.crosstalk_percent > 0) {
    LeakColors(sequence, slots, trouble.crosstalk_percent / 100, values);
  }
  if (trouble.projector_defocus_px > 0) {
    return Blur(values, size, static_cast<int>(slots.size()), trouble.projector_defocus_px, places);
  }
  return std::vector<float>(values.begin(), values.end());
}

}  // namespace

PatternTable::PatternTable(const PatternSequence& sequence, const ScanTrouble& trouble)
    : frames_(static_cast<int>(sequence.patterns.size())),
      columns_(sequence.projector_width),
      rows_(sequence.projector_height),
      places_(trouble.projector_defocus_px > 0 ? kPlacesWhenBlurred : 1) {
  std::vector<int> rows;
  for (int f = 0; f < frames_; ++f) {
    const Pattern& pattern = sequence.patterns[f];
    (pattern.axis == PatternAxis::kRow && !IsConstant(pattern) ? rows : frame_of_slot_)
        .push_back(f);
  }
  column_slots_ = static_cast<int>(frame_of_slot_.size());
  row_slots_ = static_cast<int>(rows.size());
  by_column_ =
      MakeTable(sequence, frame_of_slot_, PatternAxis::kColumn, columns_, trouble, places_);
  by_row_ = MakeTable(sequence, rows, PatternAxis::kRow, rows_, trouble, places_);
  frame_of_slot_.insert(frame_of_slot_.end(), rows.begin(), rows.end());
}

ProjectedSpan PatternTable::ColumnSpan(double center, double width) const {
  return MakeSpan((center + 0.5) * places_ - 0.5, width * places_, columns_ * places_);
}

ProjectedSpan PatternTable::RowSpan(double center, double width) const {
  return MakeSpan((center + 0.5) * places_ - 0.5, width * places_, rows_ * places_);
}

void PatternTable::AddSpan(const std::vector<float>& table, int slots, const ProjectedSpan& span,
                           float weight, float* sums) {
  const float* values = table.data() + static_cast<size_t>(span.index) * slots;
  const float first = weight * (1 - span.share);
  for (int i = 0; i < slots; ++i) sums[i] += first * values[i];
  if (span.share <= 0) return;
  const float second = weight * span.share;
  values += slots;
  for (int i = 0; i < slots; ++i) sums[i] += second * values[i];
}

void PatternTable::Accumulate(const ProjectedSample& sample, float* sums) const {
  AddSpan(by_column_, column_slots_, sample.column, sample.weight, sums);
  AddSpan(by_row_, row_slots_, sample.row, sample.weight, sums + column_slots_);
}

ProjectedSpan MakeSpan(double center, double width, int count) {
  const double half = 0.5 * std::clamp(width, 1e-6, 1.0);
  // In the frame where pixel i covers [i, i + 1).
  const double low = std::clamp(center + 0.5 - half, 0.0, count - 1e-9);
  const double high = std::clamp(center + 0.5 + half, low, count - 1e-9);
  ProjectedSpan span;
  span.index = static_cast<int>(low);
  if (static_cast<int>(high) > span.index) {
    span.share = static_cast<float>((high - static_cast<int>(high)) / (high - low));
  }
  return span;
}

}  // namespace lfm
