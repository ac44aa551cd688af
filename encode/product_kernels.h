// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// The hot loops of the factorisation, compiled for several instruction sets and dispatched at run
/// time. Plain pointers only: no Eigen object may cross, since its alignment depends on the
/// instruction set. Matrices are row-major float32 without padding. Results are the same from run
/// to run on one instruction set; they differ in the last bits between instruction sets.
///
/// `width` is the number of columns multiplied at once: 8, 16 or 24.
namespace lfm::kernels {

/// Sparse view weights sorted by view: entries [offsets[i], offsets[i + 1]) belong to view i.
struct WeightsByView {
  const int* offsets;         ///< views + 1
  const uint16_t* direction;  ///< grid entry q of each nonzero
  const float* weight;
};

/// y (rows x width) = p (rows x cols) * z (cols x width).
void Multiply(const float* p, int rows, int cols, const float* z, int width, float* y);

/// t (cols x width) = p^T * y (rows x width).
void MultiplyTransposed(const float* p, int rows, int cols, const float* y, int width, float* t);

/// z (channels * views x width) = W x, channel by channel; x is (channels * directions x width).
void DirectionsToViews(const WeightsByView& weights, int views, int directions, int channels,
                       const float* x, int width, float* z);

/// x += W^T t: the transpose. `view` and `weight` hold three entries a direction (ViewWeights).
void AddViewsToDirections(const uint16_t* view, const float* weight, int views, int directions,
                          int channels, const float* t, int width, float* x);

/// g (width x width) = x^T x in float64; x is (rows x width).
void Gram(const float* x, int rows, int width, double* g);

/// Nonnegative least squares by coordinate descent: each row x (`terms` of `stride` numbers, at
/// most 16) goes `rounds` times towards the minimum of x G x^T - 2 x p^T over x >= 0; g is terms x
/// terms, `inverse` the inverses of its diagonal, or 0.
void DescendNonnegative(const float* products, const float* g, const float* inverse, int terms,
                        int stride, int rows, int rounds, float* x);

}  // namespace lfm::kernels
