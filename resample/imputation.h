// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace lfm {

/// What is known of a sample in one view.
enum class Knowledge : uint8_t {
  kData,        ///< its value
  kLowerBound,  ///< at least its value: a pixel was saturated
  kMissing,     ///< nothing: it is hidden, or lies too near a depth edge
};

inline constexpr int kMaxImputationTerms = 4;

/// The views of one patch, some entries of which are not data.
struct PartialMatrix {
  /// Rows x views; a row is one channel of one sample. What stands at a missing entry is not used,
  /// but must be finite.
  Eigen::MatrixXf values;
  Eigen::Matrix<Knowledge, Eigen::Dynamic, Eigen::Dynamic> knowledge;  ///< the same shape
};

/// Estimates what the entries that are not data would have been: a low-rank fit with one-sided
/// residuals.
///
/// Two terms (a diffuse and a glossy part; one with fewer than six views) are fitted by alternating
/// ridge regression to the entries that are data. A lower bound takes part only while
/// the fit lies below it, and then pulls towards it; it becomes max(bound, fit). A missing entry
/// becomes the fit, not below zero. Both are at most `ceiling`. Data stay as they are, bit for bit.
///
/// Where entries are missing, up to `max_terms` terms (1 to kMaxImputationTerms, a third of the
/// views at most; what a shadow or a second highlight adds) are then fitted from there, with
/// bounds at what they were found to be; they decide about the missing ones.
///
/// No view is dropped for being saturated: those are the views that show the highlight, and a
/// triangle without them would be too dark there. A view without any data or bound takes the rows'
/// means over the other views. A row without any is left at zero: what lies beside it the caller
/// knows (triangle_resampling takes the nearest sample). Never NaN for finite values. The ridge
/// costs about a thousandth of a well-known value; it draws a view that tells little towards the
/// mean of all views.
Eigen::MatrixXf Impute(const PartialMatrix& matrix, float ceiling, int max_terms = 3);

}  // namespace lfm
