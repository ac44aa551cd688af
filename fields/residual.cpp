// SPDX-License-Identifier: BSD-3-Clause
#include "fields/residual.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/stored_numbers.h"

namespace lfm {
namespace {

constexpr int64_t kChunk = 256;

struct Entry {
  float value = 0;
  uint16_t column = 0;
};

bool Before(const Entry& a, const Entry& b) {
  const float x = std::abs(a.value), y = std::abs(b.value);
  return x != y ? x > y : a.column < b.column;
}

void CheckSizes(const ClusteredModel& model, RowsView truth) {
  if (truth.rows != model.rows || truth.columns != model.columns) {
    throw Error("residual: the model has " + std::to_string(model.rows) + " x " +
                std::to_string(model.columns) + " numbers, the field " +
                std::to_string(truth.rows) + " x " + std::to_string(truth.columns));
  }
}

float LargestResidual(const ClusteredModel& model, RowsView truth) {
  std::vector<float> largest(static_cast<size_t>((truth.rows + kChunk - 1) / kChunk));
  ParallelChunks(truth.rows, kChunk, [&](int64_t begin, int64_t end, int64_t chunk) {
    std::vector<float> approximation(static_cast<size_t>(model.columns));
    float most = 0;
    for (int64_t r = begin; r < end; ++r) {
      EvaluateRow(model, r, 0, approximation.data());
      for (int j = 0; j < truth.columns; ++j) {
        most = std::max(most, std::abs(truth.Row(r)[j] - approximation[j]));
      }
    }
    largest[chunk] = most;
  });
  return largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
}

// What of one row is kept, in order.
class RowResidual {
 public:
  RowResidual(const ClusteredModel& model, RowsView truth, const ResidualOptions& options,
              StoredNumbers stored)
      : model_(model), truth_(truth), options_(options), stored_(stored) {
    approximation_.resize(static_cast<size_t>(model.columns));
  }

  const std::vector<Entry>& Of(int64_t row) {
    EvaluateRow(model_, row, 0, approximation_.data());
    const float* true_row = truth_.Row(row);
    const auto threshold = static_cast<float>(options_.threshold);
    kept_.clear();
    for (int j = 0; j < model_.columns; ++j) {
      const float difference = true_row[j] - approximation_[j];
      if (!(std::abs(difference) > threshold)) continue;
      const float value = stored_.Round(difference);
      if (value != 0) kept_.push_back({value, static_cast<uint16_t>(j)});
    }
    const auto largest =
        static_cast<size_t>(options_.largest < 0 ? model_.columns : options_.largest);
    if (kept_.size() > largest) {
      std::nth_element(kept_.begin(), kept_.begin() + static_cast<ptrdiff_t>(largest), kept_.end(),
                       Before);
      kept_.resize(largest);
    }
    return kept_;
  }
  const std::vector<Entry>& Sorted(int64_t row) {
    Of(row);
    std::sort(kept_.begin(), kept_.end(), Before);
    return kept_;
  }

 private:
  const ClusteredModel& model_;
  RowsView truth_;
  ResidualOptions options_;
  StoredNumbers stored_;
  std::vector<float> approximation_;
  std::vector<Entry> kept_;
};

}  // namespace

ClusteredModel WithResidual(ClusteredModel model, RowsView truth, const ResidualOptions& options) {
  CheckSizes(model, truth);
  if (options.largest < -1) throw Error("residual: a negative number of entries");
  if (!(options.threshold >= 0) || !std::isfinite(options.threshold)) {
    throw Error("residual: the threshold must be finite and not negative");
  }
  if (model.columns > 65536) throw Error("residual: more than 65536 columns");
  const StoredNumbers stored = StoredNumbersUpTo(LargestResidual(model, truth));
  std::vector<int64_t> first(static_cast<size_t>(model.rows) + 1);
  ParallelChunks(model.rows, kChunk, [&](int64_t begin, int64_t end, int64_t) {
    RowResidual residual(model, truth, options, stored);
    for (int64_t r = begin; r < end; ++r) {
      first[r + 1] = static_cast<int64_t>(residual.Of(r).size());
    }
  });
  for (int64_t r = 0; r < model.rows; ++r) first[r + 1] += first[r];
  std::vector<uint16_t> columns(static_cast<size_t>(first.back()));
  std::vector<float> values(static_cast<size_t>(first.back()));
  ParallelChunks(model.rows, kChunk, [&](int64_t begin, int64_t end, int64_t) {
    RowResidual residual(model, truth, options, stored);
    for (int64_t r = begin; r < end; ++r) {
      int64_t at = first[r];
      for (const Entry& entry : residual.Sorted(r)) {
        columns[at] = entry.column;
        values[at++] = entry.value;
      }
    }
  });
  model.first_residual = std::move(first);
  model.residual_column = std::move(columns);
  model.residual_value = std::move(values);
  return model;
}

double ResidualSparseness(const ClusteredModel& model, RowsView truth, double threshold,
                          const std::vector<int64_t>& which) {
  CheckSizes(model, truth);
  const int64_t count = which.empty() ? model.rows : static_cast<int64_t>(which.size());
  const auto chunks = static_cast<size_t>((count + kChunk - 1) / kChunk);
  std::vector<int64_t> small(chunks), all(chunks);
  ParallelChunks(count, kChunk, [&](int64_t begin, int64_t end, int64_t chunk) {
    std::vector<float> approximation(static_cast<size_t>(model.columns));
    for (int64_t i = begin; i < end; ++i) {
      const int64_t row = which.empty() ? i : which[i];
      const float* true_row = truth.Row(row);
      if (std::all_of(true_row, true_row + truth.columns, [](float v) { return v == 0; })) continue;
      EvaluateRow(model, row, 0, approximation.data());
      for (int j = 0; j < model.columns; ++j) {
        if (std::abs(double{true_row[j]} - approximation[j]) <= threshold) ++small[chunk];
      }
      all[chunk] += model.columns;
    }
  });
  int64_t small_sum = 0, all_sum = 0;
  for (size_t i = 0; i < chunks; ++i) {
    small_sum += small[i];
    all_sum += all[i];
  }
  return all_sum == 0 ? 1 : static_cast<double>(small_sum) / static_cast<double>(all_sum);
}

}  // namespace lfm
