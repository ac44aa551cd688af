// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/pixel_sum.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMaxSamplesPerSide = 16;

Eigen::Vector3f LinearColor(const Eigen::Vector3f& coded) {
  return coded.unaryExpr([](float value) { return LinearFromSrgb(value); });
}

Eigen::Vector3f CodedColor(const Eigen::Vector3f& linear) {
  return linear.unaryExpr([](float value) { return SrgbFromLinear(value); });
}

uint8_t Code8(float value) {
  return static_cast<uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
}

}  // namespace

// Most pixels of one sample never ask for linear light, which costs as much as a third of their
// ray.
void PixelSum::Add(const Eigen::Vector3f& coded) {
  if (hits_ > 0) linear_before_ += LinearColor(last_);
  last_ = coded;
  ++hits_;
}

Eigen::Vector3f PixelSum::Linear() const {
  if (hits_ == 0) return Eigen::Vector3f::Zero();
  return linear_before_ + LinearColor(last_);
}

Rendering EmptyRendering(int width, int height, const RenderOptions& options) {
  Rendering rendering{Image(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb),
                      Image(width, height, 1, PixelType::kUint8, ColorEncoding::kLinear),
                      Image(width, height, 4, PixelType::kUint8, ColorEncoding::kSrgb),
                      {},
                      {}};
  if (options.linear_light) {
    rendering.linear_color = Image(width, height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
    rendering.linear_layer = Image(width, height, 4, PixelType::kFloat32, ColorEncoding::kLinear);
  }
  return rendering;
}

void ValidateOptions(const RenderOptions& options) {
  if (options.samples_per_side < 1 || options.samples_per_side > kMaxSamplesPerSide) {
    throw Error("supersampling is " + std::to_string(options.samples_per_side) +
                " rays a side; choose 1 to " + std::to_string(kMaxSamplesPerSide));
  }
  if (!options.background.allFinite() || options.background.minCoeff() < 0 ||
      options.background.maxCoeff() > 1) {
    throw Error("the background colour lies outside [0, 1]");
  }
}

void StorePixel(const PixelSum& sum, const RenderOptions& options, int x, int y,
                Rendering& rendering) {
  const int samples = options.samples_per_side * options.samples_per_side;
  const float share = static_cast<float>(sum.hits()) / samples;
  Eigen::Vector3f over = options.background;
  Eigen::Vector3f alone = Eigen::Vector3f::Zero();
  if (samples == 1 && sum.hits() == 1) {
    over = alone = sum.last();
  } else if (sum.hits() > 0) {
    const Eigen::Vector3f linear = sum.Linear();
    alone = CodedColor(linear / sum.hits());
    over = CodedColor(linear / samples + (1 - share) * LinearColor(options.background));
  }
  for (int c = 0; c < 3; ++c) {
    rendering.color.At<uint8_t>(x, y, c) = Code8(over[c]);
    rendering.layer.At<uint8_t>(x, y, c) = Code8(alone[c]);
  }
  if (options.linear_light) {
    const Eigen::Vector3f layer = sum.Linear() / static_cast<float>(samples);
    const Eigen::Vector3f color = layer + (1 - share) * LinearColor(options.background);
    for (int c = 0; c < 3; ++c) {
      rendering.linear_color.At<float>(x, y, c) = color[c];
      rendering.linear_layer.At<float>(x, y, c) = layer[c];
    }
    rendering.linear_layer.At<float>(x, y, 3) = share;
  }
  rendering.coverage.At<uint8_t>(x, y) = rendering.layer.At<uint8_t>(x, y, 3) = Code8(share);
}

}  // namespace lfm
