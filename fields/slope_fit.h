// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace lfm {

/// A straight line through log(dimension) against log(area): dimension ~ area^slope.
struct SlopeFit {
  double slope = 0;
  /// Half the width of the 95 % confidence interval, by Student's t with points - 2 degrees of
  /// freedom; absent with two points, which leave nothing over to judge by.
  std::optional<double> half_width;
  int points = 0;
  double from_area = 0, to_area = 0;
};

/// Least squares, all points weighing the same (on the logarithmic scale), through those whose area
/// is within `octaves` octaves of the largest (Mahajan 2007's slopes are of the right end of its
/// plots). Points whose area or dimension is not positive and finite do not count. Nothing when
/// fewer than two different areas are left. Equal dimensions give slope 0, interval 0. Throws Error
/// when sizes differ or `octaves` is not positive.
std::optional<SlopeFit> FitSlope(const std::vector<double>& areas,
                                 const std::vector<double>& dimensions, double octaves = 3);

/// The slope from each point to the next, of area in ascending order: one less than points that
/// count. Points of equal area are skipped.
struct LocalSlope {
  double area = 0;  ///< geometric mean of the two
  double slope = 0;
};
std::vector<LocalSlope> LocalSlopes(const std::vector<double>& areas,
                                    const std::vector<double>& dimensions);

/// The straight line y = offset + slope x by least squares, and the root mean square of what is
/// left over relative to that of y: Equation 12 of Mahajan 2007, omega = beta' omega_G + omega_H.
struct LineFit {
  double slope = 0, offset = 0, relative_residual = 0;
};
/// Nothing with fewer than two different x. Throws Error when sizes differ.
std::optional<LineFit> FitLine(const std::vector<double>& x, const std::vector<double>& y);

/// The factor of the standard error that a two-sided 95 % interval takes, to 2e-4; infinite
/// degrees tend to 1.96. Throws Error for degrees < 1.
double StudentFactor95(int degrees);

}  // namespace lfm
