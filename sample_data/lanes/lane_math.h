// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lanes.h"

/// Elementary functions and vectors of lanes. Polynomials and range reductions follow S. Moshier's
/// Cephes library (single precision); errors are a few units in the last place unless stated.
namespace lfm {
inline namespace LFM_LANE_SET {

inline constexpr float kLanePi = 3.14159265358979323846f;

/// e^x; 0 below -87, held at 88 above.
template <typename F>
LFM_LANE F Exp(F x) {
  const F held = Clamp(x, -87.0f, 88.0f);
  const F n = Floor(held * 1.44269504088896341f + 0.5f);
  const F r = held - n * 0.693359375f + n * 2.12194440e-4f;
  F p = 1.9875691500e-4f * r + 1.3981999507e-3f;
  p = p * r + 8.3334519073e-3f;
  p = p * r + 4.1665795894e-2f;
  p = p * r + 1.6666665459e-1f;
  p = p * r + 5.0000001201e-1f;
  const F scale = FromBits((ToInt(n) + 127) << 23);
  return Select(x < -87.0f, Splat<F>(0), (p * r * r + r + 1.0f) * scale);
}

/// The natural logarithm of a normal x > 0.
template <typename F>
LFM_LANE F Log(F x) {
  const auto bits = BitsOf(x);
  F m = FromBits((bits & 0x007fffff) | 0x3f000000);  // [0.5, 1)
  F e = ToFloat((bits >> 23) - 126);
  const auto small = m < 0.707106781186547524f;
  e = Select(small, e - 1.0f, e);
  m = Select(small, m + m, m) - 1.0f;
  const F z = m * m;
  F p = 7.0376836292e-2f * m - 1.1514610310e-1f;
  p = p * m + 1.1676998740e-1f;
  p = p * m - 1.2420140846e-1f;
  p = p * m + 1.4249322787e-1f;
  p = p * m - 1.6668057665e-1f;
  p = p * m + 2.0000714765e-1f;
  p = p * m - 2.4999993993e-1f;
  p = p * m + 3.3333331174e-1f;
  return m + (p * m * z - 2.12194440e-4f * e - 0.5f * z) + 0.693359375f * e;
}

/// log(1 + x) for x > -1, accurate near 0.
template <typename F>
LFM_LANE F Log1p(F x) {
  const F u = 1.0f + x;
  return Log(u) + (x - (u - 1.0f)) / u;
}

/// e^x - 1 for x <= 0, accurate near 0.
template <typename F>
LFM_LANE F Expm1(F x) {
  F p = x * (1.0f / 362880) + 1.0f / 40320;
  p = p * x + 1.0f / 5040;
  p = p * x + 1.0f / 720;
  p = p * x + 1.0f / 120;
  p = p * x + 1.0f / 24;
  p = p * x + 1.0f / 6;
  p = p * x + 0.5f;
  return Select(x > -0.5f, p * x * x + x, Exp(x) - 1.0f);
}

/// x^power for x >= 0 and power > 0.
template <typename F, typename P>
LFM_LANE F Pow(F x, P power) {
  return Select(x > 1e-37f, Exp(power * Log(Max(x, 1e-37f))), Splat<F>(0));
}

/// Sine and cosine of `turns` full turns; |turns| below 1e6.
template <typename F>
LFM_LANE void SinCosTurns(F turns, F& sine, F& cosine) {
  const F quarters = turns * 4.0f, q = Floor(quarters + 0.5f);
  const F x = (quarters - q) * 1.57079632679489662f, z = x * x;
  const F s = ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z * x + x;
  const F c =
      ((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f) * z * z -
      0.5f * z + 1.0f;
  const auto k = ToInt(q);
  const auto swapped = (k & 1) != 0;
  const F a = Select(swapped, c, s), b = Select(swapped, s, c);
  sine = Select((k & 2) != 0, -a, a);
  cosine = Select(((k + 1) & 2) != 0, -b, b);
}

/// The angle of (x, y) in [-pi, pi]; 0 at the origin.
template <typename F>
LFM_LANE F Atan2(F y, F x) {
  const F ax = Abs(x), ay = Abs(y);
  const F most = Max(ax, ay), t = Select(most > 0.0f, Min(ax, ay) / most, Splat<F>(0));
  const auto far = t > 0.414213562373095f;  // tan(pi / 8)
  const F r = Select(far, (t - 1.0f) / (t + 1.0f), t), z = r * r;
  F a = (((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z -
         3.33329491539e-1f) *
            z * r +
        r;
  a = Select(far, a + 0.785398163397448f, a);
  a = Select(ay > ax, 1.57079632679489662f - a, a);
  a = Select(x < 0.0f, kLanePi - a, a);
  return Select(y < 0.0f, -a, a);
}

template <typename F>
struct Vec {
  F x, y, z;
};
template <typename F>
LFM_LANE Vec<F> operator+(const Vec<F>& a, const Vec<F>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename F>
LFM_LANE Vec<F> operator-(const Vec<F>& a, const Vec<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename F>
LFM_LANE Vec<F> operator-(const Vec<F>& a) {
  return {-a.x, -a.y, -a.z};
}
template <typename F>
LFM_LANE Vec<F> operator*(F s, const Vec<F>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <typename F>
LFM_LANE F Dot(const Vec<F>& a, const Vec<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename F>
LFM_LANE Vec<F> Cross(const Vec<F>& a, const Vec<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// A channel at a time.
template <typename F>
LFM_LANE Vec<F> Times(const Vec<F>& a, const Vec<F>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <typename F>
LFM_LANE F LargestOf(const Vec<F>& a) {
  return Max(Max(a.x, a.y), a.z);
}
/// All three channels the same.
template <typename F>
LFM_LANE Vec<F> Gray(F value) {
  return {value, value, value};
}
/// `v` at length 1 (one division, not three).
template <typename F>
LFM_LANE Vec<F> UnitVector(const Vec<F>& v) {
  return (1.0f / Sqrt(Dot(v, v))) * v;
}
template <typename F>
LFM_LANE MaskOf<F> IsZero(const Vec<F>& a) {
  return (a.x == 0.0f) & (a.y == 0.0f) & (a.z == 0.0f);
}
template <typename F>
LFM_LANE Vec<F> Select(MaskOf<F> mask, const Vec<F>& yes, const Vec<F>& no) {
  return {Select(mask, yes.x, no.x), Select(mask, yes.y, no.y), Select(mask, yes.z, no.z)};
}
template <typename F>
LFM_LANE Vec<F> GatherVec(const float* base, IntOf<F> index) {
  return {Gather(base, index), Gather(base, index + 1), Gather(base, index + 2)};
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
