// SPDX-License-Identifier: BSD-3-Clause
#include "scan/decode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "scan/axis_frames.h"
#include "scan/frame_planes.h"
#include "scan/gray_decoding.h"
#include "scan/gray_kernel.h"
#include "scan/phase_decoding.h"
#include "scan/stripe_decoding.h"
#include "scan/stripe_tracker.h"

namespace lfm {
namespace {

/// Adds frame `index` to the planes, from memory or by loading it.
using FrameAdder = std::function<void(int index, FramePlanes& planes)>;

enum class AxisScheme { kNone, kPhase, kStripe, kGray };

AxisScheme SchemeOf(const AxisFrames& axis) {
  if (!axis.phases.empty()) return AxisScheme::kPhase;
  if (!axis.stripes.empty()) return AxisScheme::kStripe;
  return axis.gray.empty() ? AxisScheme::kNone : AxisScheme::kGray;
}

/// The brightest and darkest linear value that each pixel had; frames are folded in one by one.
struct ValueRange {
  std::vector<float> low, high;

  void Include(const FramePlanes& planes, int frame, std::vector<uint8_t>& saturated) {
    low.resize(planes.pixels(), std::numeric_limits<float>::infinity());
    high.resize(planes.pixels(), -std::numeric_limits<float>::infinity());
    std::vector<float> values(planes.pixels());
    planes.ReadLinear(frame, 0, values.size(), values.data(), saturated.data());
    for (size_t p = 0; p < values.size(); ++p) {
      low[p] = std::min(low[p], values[p]);
      high[p] = std::max(high[p], values[p]);
    }
  }
};

class SequenceDecoder {
 public:
  SequenceDecoder(const PatternSequence& sequence, const FrameAdder& add,
                  const DecodeOptions& options)
      : sequence_(sequence),
        add_(add),
        options_(options),
        frames_(SortFrames(sequence)),
        planes_(sequence.patterns.size()) {}

  DecodedPixels Run() {
    for (size_t i = 0; i < sequence_.patterns.size(); ++i) {
      if (sequence_.patterns[i].kind != PatternKind::kStripe) add_(static_cast<int>(i), planes_);
    }
    const std::optional<StripeTracker> columns = Track(frames_.column);
    const std::optional<StripeTracker> rows = Track(frames_.row);
    DecodedPixels decoded;
    decoded.width = planes_.width();
    decoded.height = planes_.height();
    PixelLight light = FindLight();
    ParallelFor(0, 2, [&](int64_t i) {
      if (i == 0) decoded.column = DecodeAxis(PatternAxis::kColumn, frames_.column, columns, light);
      if (i == 1) decoded.row = DecodeAxis(PatternAxis::kRow, frames_.row, rows, light);
    });
    decoded.white = std::move(light.white);
    decoded.contrast = std::move(light.contrast);
    return decoded;
  }

 private:
  bool HasBoth() const { return frames_.white >= 0 && frames_.black >= 0; }

  std::optional<StripeTracker> Track(const AxisFrames& axis) {
    if (SchemeOf(axis) != AxisScheme::kStripe) return std::nullopt;
    std::optional<StripeTracker> tracker;
    std::vector<float> values;
    for (const int frame : axis.stripes) {
      add_(frame, planes_);
      values.resize(planes_.pixels());
      saturated_.resize(planes_.pixels(), 0);
      if (!tracker) {
        tracker.emplace(axis.stripe, static_cast<int>(axis.stripes.size()), values.size());
      }
      planes_.ReadLinear(frame, 0, values.size(), values.data(), saturated_.data());
      tracker->Add(values.data());
      if (!HasBoth()) range_.Include(planes_, frame, saturated_);
      planes_.Release(frame);
    }
    tracker->Finish();
    return tracker;
  }

  PixelLight FindLight() {
    if (HasBoth() && planes_[frames_.white].bytes && planes_[frames_.black].bytes) {
      return LightOfBytes();
    }
    const size_t pixels = planes_.pixels();
    saturated_.resize(pixels, 0);
    for (size_t i = 0; !HasBoth() && i < planes_.frames(); ++i) {
      const int frame = static_cast<int>(i);
      if (planes_.Has(frame)) range_.Include(planes_, frame, saturated_);
    }
    PixelLight light;
    light.white.resize(pixels);
    light.contrast.resize(pixels);
    light.usable.resize(pixels);
    constexpr size_t kBlock = 1024;
    const auto blocks = static_cast<int64_t>((pixels + kBlock - 1) / kBlock);
    ParallelFor(0, blocks, [&](int64_t block) {
      std::array<float, kBlock> black;
      const size_t begin = static_cast<size_t>(block) * kBlock;
      const size_t count = std::min(kBlock, pixels - begin);
      float* white = &light.white[begin];
      ReadLight(frames_.white, range_.high, begin, count, white);
      ReadLight(frames_.black, range_.low, begin, count, black.data());
      for (size_t i = 0; i < count; ++i) {
        const float contrast = white[i] - black[i];
        const bool finite = std::isfinite(contrast);
        light.contrast[begin + i] = finite ? contrast : 0.0F;
        white[i] = finite ? white[i] : 0.0F;
        light.usable[begin + i] =
            static_cast<uint8_t>(finite & (contrast >= options_.min_contrast) & (contrast > 0) &
                                 (saturated_[begin + i] == 0));
      }
    });
    LeaveOutClipped(light);
    return light;
  }

  /// The same of white and black as plain bytes, appended block by block: memory is written once.
  PixelLight LightOfBytes() const {
    constexpr size_t kBlock = kernels::kGrayBlock;
    const float least = static_cast<float>(options_.min_contrast);
    const size_t pixels = planes_.pixels();
    PixelLight light;
    light.white.reserve(pixels);
    light.contrast.reserve(pixels);
    light.usable.reserve(pixels);
    kernels::GrayLight block;
    for (size_t begin = 0; begin < pixels; begin += kBlock) {
      const size_t count = std::min(kBlock, pixels - begin);
      kernels::ReadGrayLight(LinearOfLevels(), planes_[frames_.white].bytes + begin,
                             planes_[frames_.black].bytes + begin, least, static_cast<int>(count),
                             block);
      light.white.insert(light.white.end(), block.white, block.white + count);
      light.contrast.insert(light.contrast.end(), block.contrast, block.contrast + count);
      light.usable.insert(light.usable.end(), block.usable, block.usable + count);
    }
    LeaveOutClipped(light);
    return light;
  }

  void LeaveOutClipped(PixelLight& light) const {
    const std::vector<uint8_t>& clipped = planes_.saturated();
    for (size_t p = 0; p < clipped.size(); ++p) light.usable[p] &= clipped[p] ? 0 : 1;
  }

  void ReadLight(int frame, const std::vector<float>& instead, size_t begin, size_t count,
                 float* out) {
    if (frame >= 0) {
      planes_.ReadLinear(frame, begin, count, out, &saturated_[begin]);
    } else {
      std::copy_n(instead.begin() + static_cast<std::ptrdiff_t>(begin), count, out);
    }
  }

  AxisCoordinates DecodeAxis(PatternAxis axis, const AxisFrames& frames,
                             const std::optional<StripeTracker>& tracker,
                             const PixelLight& light) const {
    switch (SchemeOf(frames)) {
      case AxisScheme::kNone:
        return {};
      case AxisScheme::kPhase:
        return DecodePhaseAxis(planes_, frames, light, options_);
      case AxisScheme::kStripe:
        return DecodeStripeAxis(*tracker, frames, light, options_);
      case AxisScheme::kGray:
        return DecodeGrayAxis(planes_, frames, axis, frames_.white, frames_.black, light, options_);
    }
    return {};
  }

  const PatternSequence& sequence_;
  const FrameAdder& add_;
  const DecodeOptions& options_;
  SortedFrames frames_;
  FramePlanes planes_;
  ValueRange range_;
  std::vector<uint8_t> saturated_;
};

}  // namespace

void RequireComplete(const PatternSequence& sequence) { SortFrames(sequence); }

DecodedPixels Decode(const PatternSequence& sequence, const FrameLoader& load,
                     const DecodeOptions& options) {
  const FrameAdder add = [&](int index, FramePlanes& planes) {
    planes.Add(index, load(index), PatternName(sequence.patterns[static_cast<size_t>(index)]));
  };
  return SequenceDecoder(sequence, add, options).Run();
}

DecodedPixels Decode(const PatternSequence& sequence, std::span<const Image> frames,
                     const DecodeOptions& options) {
  if (frames.size() != sequence.patterns.size()) {
    throw Error("the sequence has " + std::to_string(sequence.patterns.size()) +
                " patterns, but there are " + std::to_string(frames.size()) +
                " frames; give one picture for each");
  }
  const FrameAdder add = [&](int index, FramePlanes& planes) {
    const size_t i = static_cast<size_t>(index);
    planes.Add(index, &frames[i], PatternName(sequence.patterns[i]));
  };
  return SequenceDecoder(sequence, add, options).Run();
}

}  // namespace lfm
