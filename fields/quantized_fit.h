// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/light_fit.h"
#include "fields/luminance_fit.h"

namespace lfm {

/// A fit in 8 bits a coefficient, as RTI viewers keep it: coefficient t of a row is
///
///   step[t] * (byte - bias[t])
///
/// for all rows alike. Of a luminance fit also the chroma, in 8 bits.
struct QuantizedFit {
  LightBasis basis = LightBasis::kPolynomial;
  FitSpace space = FitSpace::kDisplay;
  LightFrame frame;
  int64_t points = 0;
  int channels = 3;                ///< that have coefficients; 1 with a chroma
  std::vector<double> step, bias;  ///< a term
  std::vector<uint8_t> bytes;      ///< row (channel after channel) x term
  std::vector<uint8_t> chroma;     ///< points x 3, or empty

  /// What a file of it takes: a byte a coefficient and chroma, 4 a step and bias.
  int64_t Bytes() const;
};

/// Each term's range over all rows is laid on 0 to 255; `bias` is a whole number, so that .ptm
/// files can say it, and a coefficient comes back to half a step, which is 1/254 of the range. A
/// term that does not vary comes back as it is, to 1e-6. No rows are allowed.
QuantizedFit QuantizeFit(const LightFit& fit, int channels);
QuantizedFit QuantizeFit(const LuminanceFit& fit);

/// The fit that the bytes say; of one with a chroma, the luminance alone.
LightFit DequantizeFit(const QuantizedFit& quantized);
/// Linear radiance under a light, a value a row of a field of `channels` channels.
std::vector<float> EvaluateQuantizedFit(const QuantizedFit& quantized, int channels,
                                        const Eigen::Vector3d& to_light);

}  // namespace lfm
