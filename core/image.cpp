// SPDX-License-Identifier: BSD-3-Clause
#include "core/image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kMaxSide = 65536;
constexpr int64_t kParallelGrain = 1 << 16;  // values a task; smaller pictures stay on one thread

size_t BytesPerValue(PixelType type) {
  switch (type) {
    case PixelType::kUint8:
      return 1;
    case PixelType::kUint16:
      return 2;
    case PixelType::kFloat32:
      return 4;
  }
  return 0;
}

const char* TypeName(PixelType type) {
  switch (type) {
    case PixelType::kUint8:
      return "8-bit";
    case PixelType::kUint16:
      return "16-bit";
    case PixelType::kFloat32:
      return "float";
  }
  return "unknown";
}

double SrgbDecode(double value) {
  const double magnitude = std::abs(value);
  const double linear =
      magnitude <= 0.04045 ? magnitude / 12.92 : std::pow((magnitude + 0.055) / 1.055, 2.4);
  return std::copysign(linear, value);
}

double SrgbEncode(double value) {
  const double magnitude = std::abs(value);
  const double coded =
      magnitude <= 0.0031308 ? magnitude * 12.92 : 1.055 * std::pow(magnitude, 1 / 2.4) - 0.055;
  return std::copysign(coded, value);
}

uint8_t RoundToByte(double unit_value) {
  // Written so that NaN falls into the first branch.
  if (!(unit_value > 0)) return 0;
  if (unit_value >= 1) return 255;
  return static_cast<uint8_t>(unit_value * 255 + 0.5);
}

/// The value of every integer code, as linear float.
std::vector<float> MakeLinearTable(int codes, ColorEncoding encoding) {
  std::vector<float> table(codes);
  for (int i = 0; i < codes; ++i) {
    const double value = static_cast<double>(i) / (codes - 1);
    table[i] = static_cast<float>(encoding == ColorEncoding::kSrgb ? SrgbDecode(value) : value);
  }
  return table;
}

const std::vector<float>& LinearTable(PixelType type, ColorEncoding encoding) {
  static const std::vector<float> srgb8 = MakeLinearTable(256, ColorEncoding::kSrgb);
  static const std::vector<float> linear8 = MakeLinearTable(256, ColorEncoding::kLinear);
  static const std::vector<float> srgb16 = MakeLinearTable(65536, ColorEncoding::kSrgb);
  static const std::vector<float> linear16 = MakeLinearTable(65536, ColorEncoding::kLinear);
  if (type == PixelType::kUint8) return encoding == ColorEncoding::kSrgb ? srgb8 : linear8;
  return encoding == ColorEncoding::kSrgb ? srgb16 : linear16;
}

/// Linear float to 8-bit sRGB without a power function: a level guessed from a coarse bin, then
/// raised while the value lies above the border to the next level. The bins are so narrow that the
/// curve climbs by less than one level in each.
struct SrgbQuantizer {
  static constexpr int kBins = 1 << 14;
  std::array<float, 256> upper_border;     // smallest value of the next level
  std::array<uint8_t, kBins + 1> guess{};  // level at the lower end of a bin

  SrgbQuantizer() {
    for (int level = 0; level < 255; ++level) {
      upper_border[level] = static_cast<float>(SrgbDecode((level + 0.5) / 255));
    }
    upper_border[255] = std::numeric_limits<float>::infinity();
    int level = 0;
    for (int bin = 0; bin <= kBins; ++bin) {
      while (static_cast<float>(bin) / kBins >= upper_border[level]) ++level;
      guess[bin] = static_cast<uint8_t>(level);
    }
  }
  uint8_t operator()(float linear) const {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    int level = guess[static_cast<int>(linear * kBins)];
    while (linear >= upper_border[level]) ++level;
    return static_cast<uint8_t>(level);
  }
};

const SrgbQuantizer& Quantizer() {
  static const SrgbQuantizer quantizer;
  return quantizer;
}

bool IsAlpha(int channel, int channels) {
  return (channels == 2 || channels == 4) && channel == channels - 1;
}

/// out[i] = color(in[i]), or alpha(in[i]) for the values of an alpha channel.
template <typename From, typename To, typename Color, typename Alpha>
void ConvertValues(const From* in, To* out, size_t count, int channels, const Color& color,
                   const Alpha& alpha) {
  const bool has_alpha = channels == 2 || channels == 4;
  const auto convert = [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t i = begin; i < end; ++i) {
      out[i] = has_alpha && IsAlpha(static_cast<int>(i % channels), channels) ? alpha(in[i])
                                                                              : color(in[i]);
    }
  };
  ParallelChunks(static_cast<int64_t>(count), kParallelGrain, convert);
}

template <typename T>
void LuminanceOf(const Image& image, Image& gray) {
  const int channels = image.channels();
  const T* in = image.Data<T>();
  T* out = gray.Data<T>();
  for (size_t i = 0; i < gray.size(); ++i, in += channels) {
    if (channels < 3) {
      out[i] = in[0];
      continue;
    }
    const double y = 0.2126 * in[0] + 0.7152 * in[1] + 0.0722 * in[2];
    out[i] = std::is_integral_v<T> ? static_cast<T>(y + 0.5) : static_cast<T>(y);
  }
}

}  // namespace

Image::Image(int width, int height, int channels, PixelType type, ColorEncoding encoding)
    : width_(width), height_(height), channels_(channels), type_(type), encoding_(encoding) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    throw Error("picture of " + std::to_string(width) + " x " + std::to_string(height) +
                " pixels: sides must be in [1, 65536]");
  }
  if (channels < 1 || channels > 4) {
    throw Error("picture of " + std::to_string(channels) + " channels: must be 1 to 4");
  }
  bytes_.resize(size() * BytesPerValue(type));
}

void Image::FailType(PixelType asked) const {
  throw Error(std::string("a ") + TypeName(type_) + " picture was accessed as " + TypeName(asked),
              ErrorKind::kSystem);
}

float SrgbFromLinear(float linear) { return static_cast<float>(SrgbEncode(linear)); }

float LinearFromSrgb(float srgb) { return static_cast<float>(SrgbDecode(srgb)); }

Image ToLinearFloat(const Image& image) {
  if (image.empty()) return image;
  Image out(image.width(), image.height(), image.channels(), PixelType::kFloat32,
            ColorEncoding::kLinear);
  float* values = out.Data<float>();
  if (image.type() == PixelType::kFloat32) {
    const bool coded = image.encoding() == ColorEncoding::kSrgb;
    ConvertValues(
        image.Data<float>(), values, image.size(), image.channels(),
        [coded](float v) { return coded ? LinearFromSrgb(v) : v; }, [](float v) { return v; });
    return out;
  }
  const std::vector<float>& color = LinearTable(image.type(), image.encoding());
  const std::vector<float>& alpha = LinearTable(image.type(), ColorEncoding::kLinear);
  const auto look_up_color = [&](auto v) { return color[v]; };
  const auto look_up_alpha = [&](auto v) { return alpha[v]; };
  if (image.type() == PixelType::kUint8) {
    ConvertValues(image.Data<uint8_t>(), values, image.size(), image.channels(), look_up_color,
                  look_up_alpha);
  } else {
    ConvertValues(image.Data<uint16_t>(), values, image.size(), image.channels(), look_up_color,
                  look_up_alpha);
  }
  return out;
}

Image ToSrgb8(const Image& image) {
  const bool coded = image.encoding() == ColorEncoding::kSrgb;
  if (image.empty() || (image.type() == PixelType::kUint8 && coded)) return image;
  Image out(image.width(), image.height(), image.channels(), PixelType::kUint8,
            ColorEncoding::kSrgb);
  uint8_t* values = out.Data<uint8_t>();
  if (image.type() == PixelType::kFloat32) {
    const SrgbQuantizer& quantize = Quantizer();
    ConvertValues(
        image.Data<float>(), values, image.size(), image.channels(),
        [&](float v) { return coded ? RoundToByte(v) : quantize(v); }, RoundToByte);
    return out;
  }
  const auto convert_integers = [&](const auto* in, double largest) {
    std::vector<uint8_t> table(static_cast<size_t>(largest) + 1);
    for (size_t i = 0; i < table.size(); ++i) {
      table[i] = RoundToByte(coded ? i / largest : SrgbEncode(i / largest));
    }
    ConvertValues(
        in, values, image.size(), image.channels(), [&](auto v) { return table[v]; },
        [&](auto v) { return RoundToByte(v / largest); });
  };
  if (image.type() == PixelType::kUint8) {
    convert_integers(image.Data<uint8_t>(), 255.0);
  } else {
    convert_integers(image.Data<uint16_t>(), 65535.0);
  }
  return out;
}

Image ToRgb8(const Image& image) {
  const Image coded = ToSrgb8(image);
  if (coded.empty() || coded.channels() == 3) return coded;
  Image rgb(coded.width(), coded.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const bool is_gray = coded.channels() <= 2;
  const uint8_t* from = coded.Data<uint8_t>();
  uint8_t* to = rgb.Data<uint8_t>();
  for (size_t pixel = 0; pixel < rgb.size() / 3; ++pixel, from += coded.channels(), to += 3) {
    for (int c = 0; c < 3; ++c) to[c] = from[is_gray ? 0 : c];
  }
  return rgb;
}

Image ToGray(const Image& image) {
  if (image.empty() || image.channels() == 1) return image;
  Image gray(image.width(), image.height(), 1, image.type(), image.encoding());
  switch (image.type()) {
    case PixelType::kUint8:
      LuminanceOf<uint8_t>(image, gray);
      break;
    case PixelType::kUint16:
      LuminanceOf<uint16_t>(image, gray);
      break;
    case PixelType::kFloat32:
      LuminanceOf<float>(image, gray);
      break;
  }
  return gray;
}

float SampleBilinear(const Image& image, double x, double y, int channel) {
  // max and min in this order send a NaN to the first pixel.
  x = std::min(std::max(0.0, x), static_cast<double>(image.width() - 1));
  y = std::min(std::max(0.0, y), static_cast<double>(image.height() - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width() - 1), y1 = std::min(y0 + 1, image.height() - 1);
  const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  const float* data = image.Data<float>() + channel;
  const size_t stride = image.channels();
  const size_t row0 = static_cast<size_t>(y0) * image.width();
  const size_t row1 = static_cast<size_t>(y1) * image.width();
  const float top = (1 - fx) * data[(row0 + x0) * stride] + fx * data[(row0 + x1) * stride];
  const float bottom = (1 - fx) * data[(row1 + x0) * stride] + fx * data[(row1 + x1) * stride];
  return (1 - fy) * top + fy * bottom;
}

}  // namespace lfm
