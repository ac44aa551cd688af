// SPDX-License-Identifier: BSD-3-Clause
#include "fields/quantized_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace lfm {
namespace {

// Ranges below this part of the largest magnitude are none: `bias` stays within 32 bits.
constexpr double kLeastRange = 1e-6;

struct Scale {
  double step = 1, bias = 0;
};

Scale ScaleOf(double least, double largest) {
  const double magnitude = std::max(std::abs(least), std::abs(largest));
  if (magnitude == 0) return {};
  if (largest - least <= kLeastRange * magnitude) {  // byte 0 or 1 says it all
    const double middle = 0.5 * (least + largest);
    return {std::abs(middle), middle < 0 ? 1.0 : 0.0};
  }
  // One step is left over for the rounding of the bias.
  const double step = (largest - least) / 254;
  return {step, std::floor(-least / step) + 1};
}

}  // namespace

int64_t QuantizedFit::Bytes() const {
  return static_cast<int64_t>(bytes.size() + chroma.size() + 4 * (step.size() + bias.size()));
}

QuantizedFit QuantizeFit(const LightFit& fit, int channels) {
  const FunctionRows& from = fit.coefficients;
  if (channels < 1 || from.rows % channels != 0) {
    throw Error("light fit: its rows are not those of " + std::to_string(channels) + " channels");
  }
  QuantizedFit result;
  result.basis = fit.basis;
  result.space = fit.space;
  result.frame = fit.frame;
  result.points = from.rows / channels;
  result.channels = channels;
  result.bytes.resize(static_cast<size_t>(from.rows) * from.columns);
  for (int t = 0; t < from.columns; ++t) {
    double least = from.rows > 0 ? from.Row(0)[t] : 0, largest = least;
    for (int64_t r = 0; r < from.rows; ++r) {
      least = std::min<double>(least, from.Row(r)[t]);
      largest = std::max<double>(largest, from.Row(r)[t]);
    }
    const Scale scale = ScaleOf(least, largest);
    result.step.push_back(scale.step);
    result.bias.push_back(scale.bias);
    for (int64_t r = 0; r < from.rows; ++r) {
      const double byte = std::round(from.Row(r)[t] / scale.step + scale.bias);
      result.bytes[static_cast<size_t>(r) * from.columns + t] =
          static_cast<uint8_t>(std::clamp(byte, 0.0, 255.0));
    }
  }
  return result;
}

QuantizedFit QuantizeFit(const LuminanceFit& fit) {
  QuantizedFit result = QuantizeFit(fit.luminance, 1);
  for (float chroma : fit.chroma) {
    result.chroma.push_back(
        static_cast<uint8_t>(std::lround(std::clamp(chroma, 0.0f, 1.0f) * 255)));
  }
  return result;
}

LightFit DequantizeFit(const QuantizedFit& quantized) {
  constexpr double kMostFloat = std::numeric_limits<float>::max();
  const int terms = LightBasisTerms(quantized.basis);
  LightFit fit{quantized.basis, quantized.space, quantized.frame,
               MakeFunctionRows(quantized.points * quantized.channels, terms)};
  for (int64_t r = 0; r < fit.coefficients.rows; ++r) {
    for (int t = 0; t < terms; ++t) {
      const double value =
          quantized.step[t] *
          (quantized.bytes[static_cast<size_t>(r) * terms + t] - quantized.bias[t]);
      fit.coefficients.Row(r)[t] = static_cast<float>(std::clamp(value, -kMostFloat, kMostFloat));
    }
  }
  return fit;
}

std::vector<float> EvaluateQuantizedFit(const QuantizedFit& quantized, int channels,
                                        const Eigen::Vector3d& to_light) {
  LightFit fit = DequantizeFit(quantized);
  if (quantized.chroma.empty()) return EvaluateFit(fit, to_light);
  LuminanceFit luminance{std::move(fit), {}};
  for (uint8_t chroma : quantized.chroma) {
    luminance.chroma.push_back(static_cast<float>(chroma) / 255);
  }
  return EvaluateLuminanceFit(luminance, channels, to_light);
}

}  // namespace lfm
