// SPDX-License-Identifier: BSD-3-Clause
#include "fields/picture_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

std::string SizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

bool CountsInMask(const Image& gray, int x, int y) {
  switch (gray.type()) {
    case PixelType::kUint8:
      return gray.At<uint8_t>(x, y) >= 128;
    case PixelType::kUint16:
      return gray.At<uint16_t>(x, y) >= 32768;
    case PixelType::kFloat32:
      return gray.At<float>(x, y) >= 0.5F;
  }
  return false;
}

std::array<double, 3> DivisorOf(const std::optional<Eigen::Vector3d>& intensity, int channels,
                                const std::string& name) {
  if (!intensity) return {1, 1, 1};
  const Eigen::Vector3d& rgb = *intensity;
  if (!rgb.allFinite() || !(rgb.minCoeff() > 0)) {
    throw Error(name + ": the light's intensity must be positive and finite");
  }
  if (channels == 3) return {rgb.x(), rgb.y(), rgb.z()};
  const double luminance = 0.2126 * rgb.x() + 0.7152 * rgb.y() + 0.0722 * rgb.z();
  return {luminance, luminance, luminance};
}

[[noreturn]] void FailNotFinite(const std::string& name, int x, int y) {
  throw Error(name + ": pixel (" + std::to_string(x) + ", " + std::to_string(y) +
              ") is not a finite number that can be held; repair the picture, or leave the pixel "
              "out with a mask");
}

// The mean of one channel over the pixels that count of the block whose first pixel is (x0, y0).
float BlockMean(const Image& linear, const PictureWindow& window, int x0, int y0, int channel,
                double divisor, const std::string& name) {
  double sum = 0;
  int count = 0;
  for (int y = y0; y < y0 + window.reduce; ++y) {
    for (int x = x0; x < x0 + window.reduce; ++x) {
      const size_t pixel = static_cast<size_t>(y) * window.picture_width + x;
      if (!window.pixel_counts.empty() && window.pixel_counts[pixel] == 0) continue;
      const float value = linear.At<float>(x, y, channel);
      if (!std::isfinite(value)) FailNotFinite(name, x, y);
      sum += value;
      ++count;
    }
  }
  if (count == 0) return 0;
  const auto mean = static_cast<float>(sum / count / divisor);
  if (!std::isfinite(mean)) FailNotFinite(name, x0, y0);
  return mean;
}

}  // namespace

PictureWindow MakeWindow(int picture_width, int picture_height, const FieldReadOptions& options,
                         const std::string& name) {
  PictureWindow window;
  window.picture_width = picture_width;
  window.picture_height = picture_height;
  window.left = options.crop_left;
  window.top = options.crop_top;
  window.reduce = options.reduce;
  const int width = options.crop_width == 0 ? picture_width - window.left : options.crop_width;
  const int height = options.crop_height == 0 ? picture_height - window.top : options.crop_height;
  if (window.left < 0 || window.top < 0 || width < 1 || height < 1 || window.reduce < 1 ||
      width > picture_width - window.left || height > picture_height - window.top) {
    throw Error(name + ": the crop of " + SizeText(width, height) + " pixels at (" +
                std::to_string(window.left) + ", " + std::to_string(window.top) +
                ") leaves the pictures, which are " + SizeText(picture_width, picture_height));
  }
  window.width = width / window.reduce;
  window.height = height / window.reduce;
  if (window.points() == 0) {
    throw Error(name + ": blocks of " + std::to_string(window.reduce) +
                " pixels leave nothing of " + SizeText(width, height) + "; reduce less");
  }
  return window;
}

PictureWindow WithMask(PictureWindow window, const Image& mask, const std::string& name) {
  if (mask.width() != window.picture_width || mask.height() != window.picture_height) {
    throw Error(name + ": the mask is " + SizeText(mask.width(), mask.height()) +
                ", the pictures are " + SizeText(window.picture_width, window.picture_height));
  }
  const Image gray = ToGray(mask);
  window.pixel_counts.resize(static_cast<size_t>(mask.width()) * mask.height());
  window.point_counts.assign(static_cast<size_t>(window.points()), 0);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!CountsInMask(gray, x, y)) continue;
      window.pixel_counts[static_cast<size_t>(y) * mask.width() + x] = 1;
      const int column = (x - window.left) / window.reduce, row = (y - window.top) / window.reduce;
      if (x < window.left || y < window.top || column >= window.width || row >= window.height) {
        continue;
      }
      window.point_counts[static_cast<size_t>(row) * window.width + column] = 1;
    }
  }
  if (std::find(window.point_counts.begin(), window.point_counts.end(), 1) ==
      window.point_counts.end()) {
    throw Error(name + ": the mask leaves no pixel that counts; white pixels do");
  }
  return window;
}

Camera CameraOfWindow(const Camera& camera, const PictureWindow& window) {
  const double r = window.reduce;
  Camera result = camera;
  result.width = window.width;
  result.height = window.height;
  result.fx = camera.fx / r;
  result.fy = camera.fy / r;
  result.cx = (camera.cx - window.left + 0.5) / r - 0.5;
  result.cy = (camera.cy - window.top + 0.5) / r - 0.5;
  return result;
}

PictureColumn ReadColumn(const Image& picture, const std::optional<Eigen::Vector3d>& intensity,
                         const PictureWindow& window, const std::string& name) {
  if (picture.width() != window.picture_width || picture.height() != window.picture_height) {
    throw Error(name + ": is " + SizeText(picture.width(), picture.height()) +
                " pixels, but the capture's camera says " +
                SizeText(window.picture_width, window.picture_height) +
                "; all pictures of a field have one size");
  }
  const Image linear = ToLinearFloat(picture);
  PictureColumn column;
  column.channels = picture.channels() <= 2 ? 1 : 3;
  const std::array<double, 3> divisor = DivisorOf(intensity, column.channels, name);
  column.values.resize(static_cast<size_t>(window.points() * column.channels));
  float* out = column.values.data();
  for (int c = 0; c < column.channels; ++c) {
    for (int y = 0; y < window.height; ++y) {
      for (int x = 0; x < window.width; ++x) {
        const float mean =
            BlockMean(linear, window, window.left + x * window.reduce,
                      window.top + y * window.reduce, c, divisor[static_cast<size_t>(c)], name);
        if (mean < 0) ++column.negative;
        *out++ = mean > 0 ? mean : 0.0F;
      }
    }
  }
  return column;
}

}  // namespace lfm
