// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_pictures.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace lfm {
namespace {

/// A fully saturated colour of hue in turns: 0 red, 1/3 green, 2/3 blue.
Eigen::Vector3f HueColor(double turns) {
  const auto channel = [&](double shift) {
    const double t = turns + shift;
    const double distance = std::abs(6 * (t - std::floor(t)) - 3);
    return static_cast<float>(std::clamp(distance - 1, 0.0, 1.0));
  };
  return {channel(0), channel(2.0 / 3), channel(1.0 / 3)};
}

Eigen::Vector3f HeatColor(double value) {
  const auto ramp = [&](double from, double to) {
    return static_cast<float>(std::clamp((value - from) / (to - from), 0.0, 1.0));
  };
  return {ramp(0, 0.5), ramp(0.25, 0.85), ramp(0.7, 1)};
}

void Paint(Image& image, size_t pixel, const Eigen::Vector3f& color) {
  uint8_t* out = image.Data<uint8_t>() + 3 * pixel;
  for (int c = 0; c < 3; ++c) {
    out[c] = static_cast<uint8_t>(std::lround(255 * std::clamp(color[c], 0.0F, 1.0F)));
  }
}

}  // namespace

ScanPictures DrawDecoded(const DecodedPixels& decoded, const PatternSequence& sequence) {
  const size_t pixels = decoded.white.size();
  if (pixels == 0 || decoded.column.position.size() != pixels) {
    throw Error("a scan without decoded columns cannot be drawn", ErrorKind::kSystem);
  }
  ScanPictures pictures;
  for (Image* image : {&pictures.columns, &pictures.phase, &pictures.confidence}) {
    *image = Image(decoded.width, decoded.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  }
  const double last = std::max(1, sequence.projector_width - 1);
  for (size_t p = 0; p < pixels; ++p) {
    const double column = decoded.column.position[p], confidence = decoded.column.confidence[p];
    Paint(pictures.confidence, p, HeatColor(confidence));
    const float gray = 0.3F * SrgbFromLinear(std::clamp(decoded.white[p], 0.0F, 1.0F));
    const Eigen::Vector3f unlit = Eigen::Vector3f::Constant(gray);
    const bool known = confidence > 0;
    const double share = std::clamp(column / last, 0.0, 1.0);
    Paint(pictures.columns, p, known ? HueColor(2.0 / 3 * (1 - share)) : unlit);
    Paint(pictures.phase, p, known ? HueColor(column / sequence.phase_period_px) : unlit);
  }
  return pictures;
}

ScanPictures DrawScan(const Capture& capture, int index, const ImageLoader& load_image,
                      const ScanOptions& options) {
  if (!capture.scanner || index < 0 ||
      static_cast<size_t>(index) >= capture.scanner->scans.size()) {
    throw Error("capture \"" + capture.name + "\" has no scan number " + std::to_string(index));
  }
  const Scanner& scanner = *capture.scanner;
  const ScanSet& set = scanner.scans[static_cast<size_t>(index)];
  const PatternSequence sequence =
      SequenceFromNames(scanner.projector_width, scanner.projector_height, scanner.scan_roles);
  if (set.frames.size() != sequence.patterns.size()) {
    throw Error("scan " + set.id + " has " + std::to_string(set.frames.size()) +
                " frames, its roles are " + std::to_string(sequence.patterns.size()));
  }
  DecodeOptions decode_options;
  decode_options.min_contrast = options.min_contrast;
  const FrameLoader load = [&](int frame) {
    return load_image(set.frames[static_cast<size_t>(frame)]);
  };
  return DrawDecoded(Decode(sequence, load, decode_options), sequence);
}

}  // namespace lfm
