// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/exposed_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lfm {

std::string PictureEnding(PhotoFormat format) {
  switch (format) {
    case PhotoFormat::kExr:
      return ".exr";
    case PhotoFormat::kJpeg:
      return ".jpg";
    case PhotoFormat::kPng8:
    case PhotoFormat::kPng16:
      break;
  }
  return ".png";
}

Image MakePicture(int width, int height, PhotoFormat format) {
  switch (format) {
    case PhotoFormat::kPng16:
      return Image(width, height, 3, PixelType::kUint16, ColorEncoding::kLinear);
    case PhotoFormat::kExr:
      return Image(width, height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
    case PhotoFormat::kPng8:
    case PhotoFormat::kJpeg:
      break;
  }
  return Image(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
}

void ExposePictureRow(const Sensor& sensor, std::span<const float> row, uint64_t seed,
                      uint64_t index, int y, Image& picture) {
  const int count = static_cast<int>(row.size());
  const auto line = static_cast<uint64_t>(y);
  switch (picture.type()) {
    case PixelType::kUint8:
      ExposeRow(sensor, row.data(), count, seed, index, line, &picture.At<uint8_t>(0, y));
      return;
    case PixelType::kFloat32:
      ExposeRowLinear(sensor, row.data(), count, seed, index, line, &picture.At<float>(0, y));
      return;
    case PixelType::kUint16:
      break;
  }
  std::vector<float> values(row.size());
  ExposeRowLinear(sensor, row.data(), count, seed, index, line, values.data());
  uint16_t* out = &picture.At<uint16_t>(0, y);
  for (size_t i = 0; i < values.size(); ++i) {
    out[i] = static_cast<uint16_t>(std::lround(std::max(0.0f, values[i]) * 65535));
  }
}

}  // namespace lfm
