// SPDX-License-Identifier: BSD-3-Clause
#include "bench/field_errors.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace lfm {
namespace {

// A pixel's mean over its channels that have energy; 0 without any.
double PixelError(const Field& field, const std::vector<float>& errors, size_t counts, size_t at,
                  int64_t point) {
  double sum = 0;
  int channels = 0;
  for (int c = 0; c < field.channels; ++c) {
    const float error = errors[field.RowOf(point, c) * counts + at];
    if (error < 0) continue;
    sum += error;
    ++channels;
  }
  return channels == 0 ? 0 : sum / channels;
}

uint8_t Level(double share) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
}

}  // namespace

std::vector<float> RowErrors(const ClusteredModel& model, RowsView truth,
                             const std::vector<int>& counts) {
  std::vector<float> errors(static_cast<size_t>(model.rows) * counts.size(), -1);
  ParallelChunks(model.rows, 256, [&](int64_t begin, int64_t end, int64_t) {
    std::vector<float> off(static_cast<size_t>(model.columns));
    for (int64_t r = begin; r < end; ++r) {
      EvaluateRow(model, r, 0, off.data());
      const float* row = truth.Row(r);
      double energy = 0, squares = 0;
      for (int j = 0; j < model.columns; ++j) {
        off[j] = row[j] - off[j];
        energy += double{row[j]} * row[j];
        squares += double{off[j]} * off[j];
      }
      if (energy <= 0) continue;
      int64_t at = model.first_residual.empty() ? 0 : model.first_residual[r];
      const int64_t first = at,
                    last = model.first_residual.empty() ? 0 : model.first_residual[r + 1];
      for (size_t i = 0; i < counts.size(); ++i) {
        for (; at < std::min<int64_t>(last, first + counts[i]); ++at) {
          const double before = off[model.residual_column[at]];
          const double after = before - model.residual_value[at];
          squares += after * after - before * before;
        }
        errors[r * counts.size() + i] = static_cast<float>(std::max(squares, 0.0) / energy);
      }
    }
  });
  return errors;
}

std::vector<double> MeanErrors(const std::vector<float>& row_errors, size_t counts,
                               const std::vector<int64_t>& which) {
  std::vector<double> sums(counts);
  int64_t rows = 0;
  for (int64_t r : which) {
    if (row_errors[r * counts] < 0) continue;
    ++rows;
    for (size_t i = 0; i < counts; ++i) sums[i] += row_errors[r * counts + i];
  }
  for (double& sum : sums) sum /= static_cast<double>(std::max<int64_t>(rows, 1));
  return sums;
}

int64_t ModelBytes(const ClusteredModel& model, int residuals) {
  int64_t bytes = 0;
  for (const FunctionRows& basis : model.bases) bytes += 2 * basis.rows * model.columns;
  bytes += 2 * static_cast<int64_t>(model.weights.size());
  bytes += model.rows * (model.bases.size() > 256 ? 2 : 1);
  if (model.first_residual.empty() || residuals == 0) return bytes;
  bytes += model.rows * (model.columns > 255 ? 2 : 1);
  const int64_t entry = model.columns > 256 ? 4 : 3;
  for (int64_t r = 0; r < model.rows; ++r) {
    const int64_t kept = model.first_residual[r + 1] - model.first_residual[r];
    bytes += entry * (residuals < 0 ? kept : std::min<int64_t>(kept, residuals));
  }
  return bytes;
}

Image ErrorPicture(const Field& field, const std::vector<float>& row_errors, size_t counts,
                   size_t at, double full_scale) {
  Image picture(field.width, field.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int64_t p = 0; p < field.points; ++p) {
    const double error = PixelError(field, row_errors, counts, at, p);
    std::fill_n(picture.Data<uint8_t>() + 3 * p, 3, Level(error / full_scale));
  }
  return picture;
}

Image DifferencePicture(const Field& field, const std::vector<float>& first,
                        const std::vector<float>& second, double full_scale) {
  Image picture(field.width, field.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int64_t p = 0; p < field.points; ++p) {
    const double more = PixelError(field, first, 1, 0, p) - PixelError(field, second, 1, 0, p);
    uint8_t* pixel = picture.Data<uint8_t>() + 3 * p;
    pixel[0] = Level(more / full_scale);
    pixel[2] = Level(-more / full_scale);
  }
  return picture;
}

}  // namespace lfm
