// SPDX-License-Identifier: BSD-3-Clause
#include "scan/frame_planes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

bool IsPlainBytes(const Image& image) {
  return image.type() == PixelType::kUint8 && image.channels() == 1 &&
         image.encoding() == ColorEncoding::kSrgb;
}

}  // namespace

const float* LinearOfLevels() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (size_t i = 0; i < t.size(); ++i) t[i] = LinearFromSrgb(static_cast<float>(i) / 255);
    return t;
  }();
  return table.data();
}

void FramePlanes::CheckSize(const Image& image, const std::string& name) {
  if (image.empty()) throw Error("frame \"" + name + "\" has no pixels; take the picture again");
  if (width_ == 0) {
    width_ = image.width();
    height_ = image.height();
  }
  if (image.width() == width_ && image.height() == height_) return;
  throw Error("frame \"" + name + "\" has " + std::to_string(image.width()) + " x " +
              std::to_string(image.height()) + " pixels, the others " + std::to_string(width_) +
              " x " + std::to_string(height_) + "; all frames must come from one camera");
}

void FramePlanes::Convert(FramePlane& plane, const Image& image) {
  const Image linear = ToLinearFloat(image);
  plane.owned = ToGray(linear);
  plane.floats = std::as_const(plane.owned).Data<float>();
  if (image.type() == PixelType::kFloat32) return;
  saturated_.resize(pixels(), 0);
  const int channels = linear.channels(), colors = channels >= 3 ? 3 : 1;
  const float* values = linear.Data<float>();
  for (size_t p = 0; p < saturated_.size(); ++p) {
    for (int c = 0; c < colors; ++c) {
      if (values[p * channels + c] >= kSaturatedLinear) saturated_[p] = 1;
    }
  }
}

void FramePlanes::Add(int frame, Image&& image, const std::string& name) {
  CheckSize(image, name);
  FramePlane& plane = planes_[static_cast<size_t>(frame)];
  if (!IsPlainBytes(image)) return Convert(plane, image);
  plane.owned = std::move(image);
  plane.bytes = std::as_const(plane.owned).Data<uint8_t>();
}

void FramePlanes::Add(int frame, const Image* image, const std::string& name) {
  CheckSize(*image, name);
  FramePlane& plane = planes_[static_cast<size_t>(frame)];
  if (!IsPlainBytes(*image)) return Convert(plane, *image);
  plane.bytes = image->Data<uint8_t>();
}

void FramePlanes::ReadLinear(int frame, size_t begin, size_t count, float* out,
                             uint8_t* saturated) const {
  const FramePlane& plane = (*this)[frame];
  if (plane.floats != nullptr) {
    std::copy_n(plane.floats + begin, count, out);
    return;
  }
  const float* table = LinearOfLevels();
  const uint8_t* bytes = plane.bytes + begin;
  for (size_t i = 0; i < count; ++i) out[i] = table[bytes[i]];
  for (size_t i = 0; i < count; ++i) saturated[i] |= bytes[i] >= kSaturatedLevel ? 1 : 0;
}

}  // namespace lfm
