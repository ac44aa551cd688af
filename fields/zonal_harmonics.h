// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

namespace lfm {

/// A function on the sphere that depends on the angle to an axis only, given the angle's cosine.
using ZonalFunction = std::function<double(double cosine)>;

/// F_l = 2 pi * integral from -1 to 1 of f(t) P_l(t) dt for l = 0 to max_degree: what convolution
/// with f multiplies harmonics of degree l by (Funk-Hecke). Gauss-Legendre with `nodes` points on
/// either side of t = 0, where clamped lobes have their kink: exact when f is a polynomial of
/// degree 2 nodes - 1 - max_degree on each side. Throws Error unless 0 <= max_degree <= 20000 and
/// 1 <= nodes <= 20000.
std::vector<double> ZonalCoefficients(const ZonalFunction& f, int max_degree, int nodes);

/// The same of the Phong lobe f(t) = max(t, 0)^exponent in closed form; exponent 1 is Lambert's
/// clamped cosine: pi, 2 pi / 3, pi / 4, 0, -pi / 24, ...
std::vector<double> PhongZonalCoefficients(double exponent, int max_degree);

/// f itself at a cosine, from its coefficients: sum of (2 l + 1) / (4 pi) F_l P_l(cosine).
double EvaluateZonal(const std::vector<double>& coefficients, double cosine);

/// The degree below which the squared coefficients, (2 l + 1) of each, hold all but 1e-12 of their
/// sum: beyond it they can be left out of spectra.
int SignificantDegrees(const std::vector<double>& coefficients);

/// Eigenvalues of M(a, b) = (f (*) f)(a . b) over the spherical cap 0 <= theta <= beta (Mahajan
/// 2007, Equation 16), largest first, each as often as it occurs. M commutes with turns about the
/// cap's axis, so every azimuthal order m is a problem of its own in theta alone, with
/// Gauss-Legendre nodes; orders come in pairs +-m. Exact to rounding: nothing is discretised that
/// is not a polynomial. `coefficients`: F_l of f. On the whole sphere: F_l^2, 2 l + 1 times.
/// Eigenvalues below 1e-15 of the largest may be missing. Throws Error unless 0 < beta <= pi.
std::vector<double> CapEigenvalues(const std::vector<double>& coefficients, double beta);

/// Those of one order m alone, each once.
std::vector<double> CapEigenvaluesOfOrder(const std::vector<double>& coefficients, double beta,
                                          int order);

/// Coefficients of h(theta) = g(scale theta), 0 where scale theta > pi; `g`: coefficients of g.
/// With scale = beta / pi it is the cut and "stretched" g that the paper holds against M's
/// eigenvalues (Section 2.2, Figure 6). The approximate scale theorem: scale^2 H_(scale l) ~ G_l
/// for large l, as for the Fourier transform of the plane. Throws Error unless scale is positive
/// and finite.
std::vector<double> ScaledCoefficients(const std::vector<double>& g, double scale, int max_degree);

/// F_l^2: the coefficients of g = f (*) f.
std::vector<double> SquaredCoefficients(const std::vector<double>& coefficients);

/// (2 l + 1) copies of each, largest first.
std::vector<double> WithMultiplicity(const std::vector<double>& coefficients);

}  // namespace lfm
