// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

namespace lfm {

/// Flatland light transport T(alpha, gamma) = f(alpha - gamma) with even f (Mahajan 2007, Section
/// 2.1, Equation 4). What matters of it is its covariance
///
///   g(d) = integral over the circle of f(u) f(d - u) du                    (Equation 6)
///
/// as a function of the difference d of two places, radians, |d| <= pi.
using FlatCovariance = std::function<double(double difference)>;

/// Of any f, by the trapezium rule with `samples` points round the circle: exact to rounding for f
/// that is smooth and periodic, within O(1 / samples) where it jumps. Throws Error when `samples`
/// is not positive.
FlatCovariance CovarianceOf(std::function<double(double angle)> f, int samples);
/// Of the Phong lobe f(x) = max(cos x, 0)^exponent, exponent >= 1; cos x is Lambert's.
FlatCovariance PhongCovariance(double exponent);
/// Of a half-circle that a blocker leaves visible, f = 1 for |x| < pi / 2: g = pi - |d|, exactly.
FlatCovariance StepCovariance();

/// g_k = g(2 beta k / p) for k = 0 to p - 1: the first row of M^p (Equation 7) of a patch of
/// half-angle width beta, -beta <= alpha <= beta. Differences of places reach 2 beta there, twice
/// what Equation 9 cuts g off at; with beta / 2 the numbers are those of Equation 9. Throws Error
/// unless p is 1 to 20000 and beta in (0, pi].
std::vector<double> SampleCovariance(const FlatCovariance& g, double beta, int p);

/// Eigenvalues of the symmetric Toeplitz matrix M_ij = g_|i-j|, largest first, in float64. Such a
/// matrix is the same read backwards, so it falls into a symmetric and an antisymmetric half.
/// Throws Error when a number is not finite.
std::vector<double> ToeplitzEigenvalues(const std::vector<double>& g);

/// lambda_r ~ sum over k from -(p - 1) to p - 1 of g_k exp(2 pi i k r / p)     (Equation 8)
///
/// for r = 0 to p - 1, largest first. They sum up to trace(M) as the eigenvalues do; some are
/// negative where g is cut off while it is still large.
std::vector<double> TruncatedFourier(const std::vector<double>& g);

/// sum |a - b| / sum |a|, what Figure 4 shows side by side; numbers that one list lacks are 0.
/// 0 when both are all zeros; infinite when only a is.
double SummedDifference(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace lfm
