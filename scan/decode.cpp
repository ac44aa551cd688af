// SPDX-License-Identifier: BSD-3-Clause
#include "scan/decode.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kSaturation = 0.985;  // sRGB level 253.2: 254 and 255 may be clipped noise
constexpr int kSoftOne = 127;

/// One frame's luminance, and whether any channel of an integer picture is at its ceiling.
struct Frame {
  Image gray;  ///< linear float, one channel
  std::vector<uint8_t> saturated;
};

Frame PrepareFrame(const Image& image) {
  Frame frame;
  const Image linear = ToLinearFloat(image);
  frame.gray = ToGray(linear);
  frame.saturated.assign(frame.gray.size(), 0);
  if (image.type() == PixelType::kFloat32) return frame;
  const int color_channels = linear.channels() >= 3 ? 3 : 1;
  const float* values = linear.Data<float>();
  for (size_t p = 0; p < frame.saturated.size(); ++p) {
    for (int c = 0; c < color_channels; ++c) {
      if (values[p * linear.channels() + c] >= kSaturation) frame.saturated[p] = 1;
    }
  }
  return frame;
}

/// Loads frames by what they show and keeps the common size and the saturation mask.
class FrameReader {
 public:
  FrameReader(const PatternSequence& sequence, const FrameLoader& load)
      : sequence_(sequence), load_(load) {}

  std::optional<int> Find(PatternKind kind, PatternAxis axis, int index) const {
    for (size_t i = 0; i < sequence_.patterns.size(); ++i) {
      const Pattern& p = sequence_.patterns[i];
      const bool axis_matters = kind != PatternKind::kWhite && kind != PatternKind::kBlack;
      if (p.kind == kind && (!axis_matters || (p.axis == axis && p.index == index))) {
        return static_cast<int>(i);
      }
    }
    return std::nullopt;
  }

  Image Read(PatternKind kind, PatternAxis axis, int index) {
    const std::optional<int> found = Find(kind, axis, index);
    if (!found) {
      throw Error("the pattern sequence has no \"" + PatternName({kind, axis, index}) +
                  "\" frame; decoding needs it: add it to the roles and the capture");
    }
    Frame frame = PrepareFrame(load_(*found));
    if (saturated_.empty()) {
      width_ = frame.gray.width();
      height_ = frame.gray.height();
      saturated_.assign(frame.gray.size(), 0);
    }
    if (frame.gray.width() != width_ || frame.gray.height() != height_) {
      throw Error("frame \"" + PatternName({kind, axis, index}) + "\" has " +
                  std::to_string(frame.gray.width()) + " x " + std::to_string(frame.gray.height()) +
                  " pixels, the others " + std::to_string(width_) + " x " +
                  std::to_string(height_) + "; all frames must come from one camera");
    }
    for (size_t p = 0; p < saturated_.size(); ++p) saturated_[p] |= frame.saturated[p];
    return std::move(frame.gray);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<uint8_t>& saturated() const { return saturated_; }

 private:
  const PatternSequence& sequence_;
  const FrameLoader& load_;
  int width_ = 0, height_ = 0;
  std::vector<uint8_t> saturated_;
};

bool UsesAxis(const PatternSequence& sequence, PatternAxis axis) {
  return std::any_of(sequence.patterns.begin(), sequence.patterns.end(), [&](const Pattern& p) {
    return p.axis == axis && p.kind != PatternKind::kWhite && p.kind != PatternKind::kBlack;
  });
}

int8_t SoftBit(double difference, double contrast) {
  if (!(contrast > 0) || !std::isfinite(difference)) return 0;
  return static_cast<int8_t>(std::lround(std::clamp(difference / contrast, -1.0, 1.0) * kSoftOne));
}

/// Soft Gray bits of all pixels, pixel by pixel.
struct SoftBits {
  int bits = 0;
  std::vector<int8_t> values;
};

SoftBits ReadSoftBits(FrameReader& reader, const PatternSequence& sequence, PatternAxis axis,
                      const Image& white, const Image& black) {
  SoftBits soft;
  soft.bits = GrayBits(sequence, axis);
  const size_t pixels = white.size();
  soft.values.resize(pixels * soft.bits);
  for (int bit = 0; bit < soft.bits; ++bit) {
    const Image pattern = reader.Read(PatternKind::kGray, axis, bit);
    const bool has_inverse = reader.Find(PatternKind::kGrayInverse, axis, bit).has_value();
    const Image inverse = has_inverse ? reader.Read(PatternKind::kGrayInverse, axis, bit) : Image();
    for (size_t p = 0; p < pixels; ++p) {
      const float w = white.Data<float>()[p], b = black.Data<float>()[p];
      const float value = pattern.Data<float>()[p];
      const float opposite = has_inverse ? inverse.Data<float>()[p] : w + b - value;
      soft.values[p * soft.bits + bit] = SoftBit(value - opposite, w - b);
    }
  }
  return soft;
}

/// Least-squares fit of offset + A cos(phi - 2 pi i / N) to each pixel's phase frames.
struct PhaseFit {
  int steps = 0;
  std::vector<float> cosine, sine;  ///< A cos phi, A sin phi
  std::vector<float> variance;      ///< of one frame's value, from the residual
};

PhaseFit FitPhase(FrameReader& reader, const PatternSequence& sequence, PatternAxis axis,
                  size_t pixels) {
  PhaseFit fit;
  if (!reader.Find(PatternKind::kPhase, axis, 0)) return fit;
  fit.steps = sequence.phase_steps;
  std::vector<double> sum(pixels, 0), squares(pixels, 0), cosine(pixels, 0), sine(pixels, 0);
  for (int i = 0; i < fit.steps; ++i) {
    const Image frame = reader.Read(PatternKind::kPhase, axis, i);
    const double angle = 2 * std::numbers::pi * i / fit.steps;
    const double c = std::cos(angle), s = std::sin(angle);
    for (size_t p = 0; p < pixels; ++p) {
      const double v = frame.Data<float>()[p];
      sum[p] += v;
      squares[p] += v * v;
      cosine[p] += v * c;
      sine[p] += v * s;
    }
  }
  fit.cosine.resize(pixels);
  fit.sine.resize(pixels);
  fit.variance.resize(pixels);
  const double n = fit.steps;
  for (size_t p = 0; p < pixels; ++p) {
    const double c = 2 * cosine[p] / n, s = 2 * sine[p] / n;
    // Offset, cosine and sine are orthogonal: the residual is what their energies leave over.
    const double rest = squares[p] - sum[p] * sum[p] / n - n / 2 * (c * c + s * s);
    fit.cosine[p] = static_cast<float>(c);
    fit.sine[p] = static_cast<float>(s);
    fit.variance[p] = static_cast<float>(std::max(0.0, rest) / std::max(1.0, n - 3));
  }
  return fit;
}

/// Gray code expected at each whole projector coordinate, -127..127, falling to 0 at transitions
/// over a quarter of a period: as far as code and phase may disagree before a period is in doubt.
std::vector<int8_t> ExpectedBits(int size, int bits, int period) {
  std::vector<int8_t> table(static_cast<size_t>(size) * bits);
  for (int x = 0; x < size; ++x) {
    for (int bit = 0; bit < bits; ++bit) {
      const int shift = bits - 1 - bit;
      const int value = ((x ^ (x >> 1)) >> shift) & 1;
      // Transitions of this bit lie half a pixel before the odd multiples of 2^shift.
      const double half = std::ldexp(1.0, shift);
      const double from_transition = std::abs(std::remainder(x + 0.5 - half, 2 * half));
      const double weight = std::min(1.0, 4 * from_transition / period);
      table[static_cast<size_t>(x) * bits + bit] =
          static_cast<int8_t>(std::lround((value ? 1 : -1) * weight * kSoftOne));
    }
  }
  return table;
}

int Agreement(const int8_t* a, const int8_t* b, int bits) {
  int sum = 0;
  for (int i = 0; i < bits; ++i) sum += a[i] * b[i];
  return sum;
}

struct PeriodChoice {
  double position = 0;
  double agreement = 0;  ///< of the best, in bits
  double margin = 0;     ///< over the next, in bits
};

/// The period whose expected Gray code agrees best with the soft bits.
PeriodChoice ChoosePeriod(const int8_t* soft, const std::vector<int8_t>& expected, int bits,
                          double fraction_px, int period, int size) {
  int best = INT32_MIN, second = INT32_MIN;
  PeriodChoice choice;
  for (double x = fraction_px - period; x < size - 0.5; x += period) {
    if (x < -0.5) continue;
    const int whole = std::clamp(static_cast<int>(std::lround(x)), 0, size - 1);
    const int score = Agreement(soft, &expected[static_cast<size_t>(whole) * bits], bits);
    if (score > best) {
      second = best;
      best = score;
      choice.position = x;
    } else {
      second = std::max(second, score);
    }
  }
  const double one = static_cast<double>(kSoftOne) * kSoftOne;
  if (best == INT32_MIN) return choice;
  choice.agreement = best / one;
  choice.margin = second == INT32_MIN ? bits : (best - second) / one;
  return choice;
}

int HardGray(const int8_t* soft, int bits) {
  int value = 0, bit = 0;
  for (int i = 0; i < bits; ++i) {
    bit ^= soft[i] > 0 ? 1 : 0;
    value = value * 2 + bit;
  }
  return value;
}

/// Median of the residual variance, as a fraction of the amplitude squared: the frame noise that a
/// single pixel's few degrees of freedom are blended with.
double TypicalVariance(const PhaseFit& fit, const std::vector<uint8_t>& usable) {
  std::vector<float> values;
  for (size_t p = 0; p < usable.size(); ++p) {
    if (usable[p]) values.push_back(fit.variance[p]);
  }
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct AxisInput {
  int size = 0, period = 0;
  SoftBits soft;
  PhaseFit phase;
};

void DecodeGrayOnly(const AxisInput& in, const std::vector<uint8_t>& usable, AxisCoordinates& out) {
  for (size_t p = 0; p < usable.size(); ++p) {
    if (!usable[p]) continue;
    const int8_t* soft = &in.soft.values[p * in.soft.bits];
    const int value = HardGray(soft, in.soft.bits);
    if (value >= in.size) continue;
    int strength = 0;
    for (int i = 0; i < in.soft.bits; ++i) strength += std::abs(soft[i]);
    out.position[p] = static_cast<float>(value);
    out.sigma[p] = static_cast<float>(1 / std::sqrt(12.0));
    out.confidence[p] = static_cast<float>(strength) / (kSoftOne * std::max(1, in.soft.bits));
  }
}

void DecodePhase(const AxisInput& in, const std::vector<uint8_t>& usable,
                 const std::vector<float>& contrast, const DecodeOptions& options,
                 AxisCoordinates& out) {
  const std::vector<int8_t> expected = ExpectedBits(in.size, in.soft.bits, in.period);
  const double typical = TypicalVariance(in.phase, usable);
  const double turn = 2 * std::numbers::pi;
  // The prior counts as many degrees of freedom as the pixel itself.
  const double freedom = std::max(0, in.phase.steps - 3);
  for (size_t p = 0; p < usable.size(); ++p) {
    const double amplitude = std::hypot(in.phase.cosine[p], in.phase.sine[p]);
    const double modulation = 2 * amplitude / std::max(1e-12f, contrast[p]);
    if (!usable[p] || !(modulation >= options.min_modulation)) continue;
    const double phase = std::atan2(in.phase.sine[p], in.phase.cosine[p]);
    const PeriodChoice choice =
        ChoosePeriod(&in.soft.values[p * in.soft.bits], expected, in.soft.bits,
                     in.period * phase / turn, in.period, in.size);
    if (!(choice.margin >= options.min_margin) || choice.agreement <= 0) continue;
    const double variance = freedom > 0 ? 0.5 * (in.phase.variance[p] + typical) : typical;
    const double sigma = in.period / turn * std::sqrt(2.0 / in.phase.steps * variance) / amplitude;
    out.position[p] = static_cast<float>(choice.position);
    out.sigma[p] = static_cast<float>(std::clamp(sigma, 1e-4, static_cast<double>(in.period)));
    out.confidence[p] = static_cast<float>(std::clamp(choice.margin / 0.8, 0.0, 1.0) *
                                           std::clamp(modulation / 0.8, 0.0, 1.0));
  }
}

AxisCoordinates DecodeAxis(const AxisInput& in, const std::vector<uint8_t>& usable,
                           const std::vector<float>& contrast, const DecodeOptions& options) {
  AxisCoordinates out;
  out.position.assign(usable.size(), 0);
  out.sigma.assign(usable.size(), 0);
  out.confidence.assign(usable.size(), 0);
  if (in.phase.steps == 0) {
    DecodeGrayOnly(in, usable, out);
  } else {
    DecodePhase(in, usable, contrast, options, out);
  }
  return out;
}

}  // namespace

void RequireDecodable(const PatternSequence& sequence) {
  for (const Pattern& p : sequence.patterns) {
    const bool unknown =
        p.kind == PatternKind::kStripe || (p.kind == PatternKind::kPhase && p.period_px != 0);
    if (!unknown) continue;
    throw Error("pattern \"" + PatternName(p) + "\" cannot be decoded: " +
                (p.kind == PatternKind::kStripe ? "a moving stripe" : "a phase of stated period") +
                " is not read; scan with Gray code and one phase period (patterns gray-phase or "
                "gray)");
  }
}

DecodedPixels Decode(const PatternSequence& sequence, const FrameLoader& load,
                     const DecodeOptions& options) {
  RequireDecodable(sequence);
  FrameReader reader(sequence, load);
  const Image white = reader.Read(PatternKind::kWhite, PatternAxis::kColumn, 0);
  const Image black = reader.Read(PatternKind::kBlack, PatternAxis::kColumn, 0);
  const size_t pixels = white.size();

  std::vector<std::optional<AxisInput>> inputs;
  for (PatternAxis axis : {PatternAxis::kColumn, PatternAxis::kRow}) {
    inputs.emplace_back();
    if (!UsesAxis(sequence, axis)) continue;
    AxisInput in;
    in.size = axis == PatternAxis::kColumn ? sequence.projector_width : sequence.projector_height;
    in.period = sequence.phase_period_px;
    in.soft = ReadSoftBits(reader, sequence, axis, white, black);
    in.phase = FitPhase(reader, sequence, axis, pixels);
    inputs.back() = std::move(in);
  }

  DecodedPixels decoded;
  decoded.width = reader.width();
  decoded.height = reader.height();
  decoded.white.assign(white.Data<float>(), white.Data<float>() + pixels);
  decoded.contrast.resize(pixels);
  std::vector<uint8_t> usable(pixels);
  for (size_t p = 0; p < pixels; ++p) {
    const float contrast = white.Data<float>()[p] - black.Data<float>()[p];
    const bool finite = std::isfinite(contrast);
    decoded.contrast[p] = finite ? contrast : 0;
    if (!std::isfinite(decoded.white[p])) decoded.white[p] = 0;
    usable[p] = finite && contrast >= options.min_contrast && !reader.saturated()[p];
  }
  if (inputs[0]) decoded.column = DecodeAxis(*inputs[0], usable, decoded.contrast, options);
  if (inputs[1]) decoded.row = DecodeAxis(*inputs[1], usable, decoded.contrast, options);
  return decoded;
}

}  // namespace lfm
