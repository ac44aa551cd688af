// SPDX-License-Identifier: BSD-3-Clause
// SSIM: Z. Wang, A. Bovik, H. Sheikh, E. Simoncelli, "Image quality assessment: from error
// visibility to structural similarity", IEEE Transactions on Image Processing 13(4), 2004.
#include "core/image_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kCeilingDb = 99;
constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = (0.01 * 255) * (0.01 * 255), kC2 = (0.03 * 255) * (0.03 * 255);

/// A part of a picture in double precision.
struct Field {
  int width = 0, height = 0;
  std::vector<double> values;
};

/// Where windows are evaluated: the mask's bounding box.
struct Box {
  int x0, y0, x1, y1;  // inclusive
};

Box MaskBounds(const Image& mask) {
  Box box{mask.width(), mask.height(), -1, -1};
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask.At<uint8_t>(x, y) < 128) continue;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y)};
    }
  }
  return box;
}

Box Grow(const Box& box, int by, const Image& image) {
  return {std::max(box.x0 - by, 0), std::max(box.y0 - by, 0),
          std::min(box.x1 + by, image.width() - 1), std::min(box.y1 + by, image.height() - 1)};
}

double Luminance(const Image& image, int x, int y) {
  return 0.2126 * image.At<uint8_t>(x, y, 0) + 0.7152 * image.At<uint8_t>(x, y, 1) +
         0.0722 * image.At<uint8_t>(x, y, 2);
}

/// Luminance inside `box`; outside the mask that of `reference`.
Field LuminanceField(const Image& image, const Image& reference, const Image& mask,
                     const Box& box) {
  Field field{box.x1 - box.x0 + 1, box.y1 - box.y0 + 1, {}};
  field.values.reserve(static_cast<size_t>(field.width) * field.height);
  for (int y = box.y0; y <= box.y1; ++y) {
    for (int x = box.x0; x <= box.x1; ++x) {
      field.values.push_back(Luminance(mask.At<uint8_t>(x, y) >= 128 ? image : reference, x, y));
    }
  }
  return field;
}

Field Product(const Field& a, const Field& b) {
  Field product = a;
  for (size_t i = 0; i < product.values.size(); ++i) product.values[i] *= b.values[i];
  return product;
}

/// Filters along a line of `count` values `stride` apart; the window is cut off at the ends.
void BlurLine(const double* in, double* out, int count, size_t stride,
              const std::array<double, 2 * kRadius + 1>& weights) {
  for (int i = 0; i < count; ++i) {
    double sum = 0, weight = 0;
    for (int k = std::max(-kRadius, -i); k <= std::min(kRadius, count - 1 - i); ++k) {
      sum += weights[k + kRadius] * in[(i + k) * stride];
      weight += weights[k + kRadius];
    }
    out[i * stride] = sum / weight;
  }
}

Field GaussianMean(const Field& field) {
  std::array<double, 2 * kRadius + 1> weights;
  for (int k = -kRadius; k <= kRadius; ++k) {
    weights[k + kRadius] = std::exp(-k * k / (2 * kSigma * kSigma));
  }
  Field rows = field, both = field;
  for (int y = 0; y < field.height; ++y) {
    const size_t start = static_cast<size_t>(y) * field.width;
    BlurLine(&field.values[start], &rows.values[start], field.width, 1, weights);
  }
  for (int x = 0; x < field.width; ++x) {
    BlurLine(&rows.values[x], &both.values[x], field.height, field.width, weights);
  }
  return both;
}

double MeanSsim(const Image& image, const Image& reference, const Image& mask) {
  // Windows reach beyond the mask by their radius; the box ends there or at the picture's edge.
  const Box box = Grow(MaskBounds(mask), kRadius, mask);
  const Field a = LuminanceField(image, reference, mask, box);
  const Field b = LuminanceField(reference, reference, mask, box);
  const Field mean_a = GaussianMean(a), mean_b = GaussianMean(b);
  const Field mean_aa = GaussianMean(Product(a, a)), mean_bb = GaussianMean(Product(b, b));
  const Field mean_ab = GaussianMean(Product(a, b));
  double sum = 0;
  int64_t count = 0;
  size_t i = 0;
  for (int y = box.y0; y <= box.y1; ++y) {
    for (int x = box.x0; x <= box.x1; ++x, ++i) {
      if (mask.At<uint8_t>(x, y) < 128) continue;
      const double ma = mean_a.values[i], mb = mean_b.values[i];
      const double variance_a = mean_aa.values[i] - ma * ma;
      const double variance_b = mean_bb.values[i] - mb * mb;
      const double covariance = mean_ab.values[i] - ma * mb;
      sum += (2 * ma * mb + kC1) * (2 * covariance + kC2) /
             ((ma * ma + mb * mb + kC1) * (variance_a + variance_b + kC2));
      ++count;
    }
  }
  return sum / count;
}

void RequireComparable(const Image& image, const Image& reference, const Image& mask) {
  const auto is_rgb8 = [](const Image& i) {
    return i.type() == PixelType::kUint8 && i.channels() == 3 &&
           i.encoding() == ColorEncoding::kSrgb;
  };
  if (!is_rgb8(image) || !is_rgb8(reference)) {
    throw Error("pictures to compare must be 8-bit sRGB with three channels");
  }
  if (mask.type() != PixelType::kUint8 || mask.channels() != 1) {
    throw Error("the mask of a comparison must be 8-bit with one channel");
  }
  for (const Image* other : {&reference, &mask}) {
    if (other->width() != image.width() || other->height() != image.height()) {
      throw Error("pictures to compare differ in size: " + std::to_string(image.width()) + " x " +
                  std::to_string(image.height()) + " and " + std::to_string(other->width()) +
                  " x " + std::to_string(other->height()));
    }
  }
}

}  // namespace

double PsnrFromMse(double mse) {
  if (!std::isfinite(mse) || mse < 0) throw Error("a mean squared error must be finite and >= 0");
  if (mse == 0) return kCeilingDb;
  return std::min(kCeilingDb, 10 * std::log10(255.0 * 255.0 / mse));
}

ImageDifference CompareImages(const Image& image, const Image& reference, const Image& mask) {
  RequireComparable(image, reference, mask);
  ImageDifference result;
  int64_t squares = 0, magnitudes = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (mask.At<uint8_t>(x, y) < 128) continue;
      ++result.pixels;
      for (int c = 0; c < 3; ++c) {
        const int difference =
            static_cast<int>(image.At<uint8_t>(x, y, c)) - reference.At<uint8_t>(x, y, c);
        squares += difference * difference;
        magnitudes += std::abs(difference);
      }
    }
  }
  if (result.pixels == 0) throw Error("the mask of a comparison is empty");
  result.mse = static_cast<double>(squares) / (3.0 * result.pixels);
  result.ape = static_cast<double>(magnitudes) / (3.0 * result.pixels);
  result.psnr_db = PsnrFromMse(result.mse);
  result.ssim = MeanSsim(image, reference, mask);
  return result;
}

}  // namespace lfm
