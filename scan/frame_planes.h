// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/image.h"

namespace lfm {

/// Linear value at and above which an integer picture may be clipped: sRGB level 253.2, so 254 and
/// 255.
inline constexpr float kSaturatedLinear = 0.985F;
inline constexpr uint8_t kSaturatedLevel = 254;

/// The luminance of one frame: bytes (sRGB-coded) for an 8-bit picture of one channel, else linear
/// float. Points into the picture where it can.
struct FramePlane {
  Image owned;
  const uint8_t* bytes = nullptr;
  const float* floats = nullptr;
};

/// Frames of one sequence in memory, addressed like its patterns; frames that were not added are
/// empty. All have one size.
class FramePlanes {
 public:
  explicit FramePlanes(size_t frames) : planes_(frames) {}

  /// `name` is for errors. Throws Error when the size differs from the frames before. The second
  /// form keeps pointers into `image`, which must outlive this.
  void Add(int frame, Image&& image, const std::string& name);
  void Add(int frame, const Image* image, const std::string& name);

  /// Forgets a frame's pixels.
  void Release(int frame) { planes_[static_cast<size_t>(frame)] = FramePlane(); }
  bool Has(int frame) const { return (*this)[frame].bytes || (*this)[frame].floats; }
  size_t frames() const { return planes_.size(); }

  int width() const { return width_; }
  int height() const { return height_; }
  size_t pixels() const { return static_cast<size_t>(width_) * height_; }
  const FramePlane& operator[](int frame) const { return planes_[static_cast<size_t>(frame)]; }
  /// Not 0 where a frame that is kept as float came from integers at their ceiling, in any channel;
  /// empty without such frames.
  const std::vector<uint8_t>& saturated() const { return saturated_; }

  /// Linear values of `count` pixels from `begin`; sets `saturated` where a byte is at its ceiling.
  void ReadLinear(int frame, size_t begin, size_t count, float* out, uint8_t* saturated) const;

 private:
  void CheckSize(const Image& image, const std::string& name);
  void Convert(FramePlane& plane, const Image& image);

  int width_ = 0, height_ = 0;
  std::vector<FramePlane> planes_;
  std::vector<uint8_t> saturated_;
};

/// Linear values of the 256 sRGB levels.
const float* LinearOfLevels();

}  // namespace lfm
