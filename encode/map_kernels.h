// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// The hot loops of decoding the transport form, compiled for several instruction sets and
/// dispatched at run time, as product_kernels.h. Plain pointers only.
namespace lfm::kernels {

/// Numbers a row of a basis, and of samples: rows are padded to whole vectors.
constexpr int PaddedSide(int side) { return (side + 7) / 8 * 8; }

/// samples (side rows of PaddedSide(side)) = B^T C B, the inverse cosine transform (type II) of
/// coefficients C whose lowest `used` rows and columns are given (`low`, used x used, row-major, 0
/// beyond). B is the basis: side rows of PaddedSide(side), row k the k-th cosine, padded with
/// zeros. `scratch` takes used x PaddedSide(side) numbers. Padding in `samples` becomes 0. Zero
/// coefficients cost little. 0 <= used <= side <= kMostSide.
void InverseCosines(const float* basis, int side, const float* low, int used, float* scratch,
                    float* samples);
constexpr int kMostSide = 16384;

/// codes[i] = (values[i] factor - bias) steps, to the nearest, 0 to 255; 0 for NaN. Equal values
/// get equal codes wherever they stand.
void QuantizeCodes(const float* values, long count, float factor, float bias, float steps,
                   uint8_t* codes);

}  // namespace lfm::kernels
