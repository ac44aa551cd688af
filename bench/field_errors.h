// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "fields/clustered_model.h"
#include "fields/field.h"

namespace lfm {

/// The error |R - model|^2 / |R|^2 (Yamada 2009, Equation 16) of each row with each number of
/// residual entries: rows x counts. Rows without energy have -1. `counts` ascends.
std::vector<float> RowErrors(const ClusteredModel& model, RowsView truth,
                             const std::vector<int>& counts);

/// For each count the mean over the rows `which` that have energy, as RelativeError.
std::vector<double> MeanErrors(const std::vector<float>& row_errors, size_t counts,
                               const std::vector<int64_t>& which);

/// What the model takes in a file: float16 bases, weights and residual values, a residual's column
/// in a byte (two beyond 256 columns), a row's cluster in a byte (two beyond 256 clusters) and its
/// number of residuals in one (two beyond 255), with at most `residuals` entries a row.
int64_t ModelBytes(const ClusteredModel& model, int residuals);

/// A pixel's mean error over its channels, white at `full_scale`.
Image ErrorPicture(const Field& field, const std::vector<float>& row_errors, size_t counts,
                   size_t at, double full_scale);
/// Where the first model's error is greater, red; where the second's is, blue; full colour at
/// `full_scale`.
Image DifferencePicture(const Field& field, const std::vector<float>& first,
                        const std::vector<float>& second, double full_scale);

}  // namespace lfm
