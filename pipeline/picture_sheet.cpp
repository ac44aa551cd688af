// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/picture_sheet.h"

#include <algorithm>
#include <cstdlib>

#include "core/error.h"

namespace lfm {

Image SideBySide(const std::vector<Image>& pictures) {
  if (pictures.empty()) throw Error("picture sheet: there is no picture", ErrorKind::kSystem);
  constexpr int kGap = 8;
  int width = -kGap, height = 0;
  for (const Image& picture : pictures) {
    width += picture.width() + kGap;
    height = std::max(height, picture.height());
  }
  Image sheet(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(sheet.Data<uint8_t>(), sheet.size(), uint8_t{255});
  int left = 0;
  for (const Image& any : pictures) {
    const Image picture = ToSrgb8(any);
    const int last = picture.channels() - 1;
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
          sheet.At<uint8_t>(left + x, y, c) = picture.At<uint8_t>(x, y, std::min(c, last));
        }
      }
    }
    left += picture.width() + kGap;
  }
  return sheet;
}

Image DifferencePicture(const Image& a, const Image& b, const Image& mask, int gain) {
  Image difference(a.width(), a.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (mask.At<uint8_t>(x, y) < 128) continue;
      for (int c = 0; c < 3; ++c) {
        const int d = std::abs(a.At<uint8_t>(x, y, c) - b.At<uint8_t>(x, y, c));
        difference.At<uint8_t>(x, y, c) = static_cast<uint8_t>(std::min(255, gain * d));
      }
    }
  }
  return difference;
}

Image CropToMask(const Image& picture, const Image& mask, int margin) {
  int left = mask.width(), right = -1, top = mask.height(), bottom = -1;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask.At<uint8_t>(x, y) < 128) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
  }
  if (right < 0) return picture;
  left = std::max(0, left - margin);
  top = std::max(0, top - margin);
  right = std::min(mask.width() - 1, right + margin);
  bottom = std::min(mask.height() - 1, bottom + margin);
  Image crop(right - left + 1, bottom - top + 1, picture.channels(), PixelType::kUint8,
             picture.encoding());
  const size_t row = static_cast<size_t>(crop.width()) * picture.channels();
  for (int y = 0; y < crop.height(); ++y) {
    std::copy_n(&picture.At<uint8_t>(left, top + y), row, &crop.At<uint8_t>(0, y));
  }
  return crop;
}

}  // namespace lfm
