// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// A matrix some of whose entries are only lower bounds.
struct CensoredMatrix {
  Eigen::MatrixXf values;                                           ///< rows x views
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> is_censored;  ///< the same shape
};

/// Estimates what saturated pixels would have read: a low-rank fit with one-sided residuals.
///
/// Two terms (a diffuse and a glossy part) are fitted by alternating least squares to the entries
/// that are data; a censored entry takes part only while the fit lies below its bound, and then
/// pulls towards the bound. A censored entry becomes max(bound, fit), at most `ceiling`; an entry
/// that is data stays as it is, bit for bit. No view is dropped for being saturated: those are the
/// views that show the highlight, and a triangle without them would be too dark there. Where a view
/// (or row) has too little data for the fit, a ridge draws the fit towards zero, and the bound
/// remains. With fewer than six views, or nothing censored, or nothing but, the bounds remain too.
/// Values must be finite.
Eigen::MatrixXf ImputeCensored(const CensoredMatrix& matrix, float ceiling);

}  // namespace lfm
