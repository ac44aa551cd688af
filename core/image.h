// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace lfm {

enum class PixelType { kUint8, kUint16, kFloat32 };
enum class ColorEncoding {
  kLinear,  ///< proportional to radiance
  kSrgb,    ///< the transfer curve of IEC 61966-2-1
};

/// A picture in memory: rows from the top, pixels from the left, channels interleaved (RGB, never
/// BGR; RGBA with straight alpha), no padding.
///
/// Integer types represent [0, 1] as [0, 255] or [0, 65535].
class Image {
 public:
  Image() = default;
  /// Zero-filled. Throws Error unless 1 <= width, height <= 65536 and 1 <= channels <= 4.
  Image(int width, int height, int channels, PixelType type, ColorEncoding encoding);

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  PixelType type() const { return type_; }
  ColorEncoding encoding() const { return encoding_; }
  bool empty() const { return width_ == 0; }
  size_t size() const { return static_cast<size_t>(width_) * height_ * channels_; }  ///< values

  /// The values; T must be the type's (uint8_t, uint16_t or float), else Error (kSystem).
  template <typename T>
  T* Data() {
    RequireType<T>();
    return reinterpret_cast<T*>(bytes_.data());
  }
  template <typename T>
  const T* Data() const {
    RequireType<T>();
    return reinterpret_cast<const T*>(bytes_.data());
  }
  template <typename T>
  T& At(int x, int y, int channel = 0) {
    return Data<T>()[(static_cast<size_t>(y) * width_ + x) * channels_ + channel];
  }
  template <typename T>
  const T& At(int x, int y, int channel = 0) const {
    return Data<T>()[(static_cast<size_t>(y) * width_ + x) * channels_ + channel];
  }
  const std::vector<std::byte>& Bytes() const { return bytes_; }

 private:
  template <typename T>
  void RequireType() const {
    static_assert(std::is_same_v<T, uint8_t> || std::is_same_v<T, uint16_t> ||
                  std::is_same_v<T, float>);
    constexpr PixelType kAsked = std::is_same_v<T, uint8_t>    ? PixelType::kUint8
                                 : std::is_same_v<T, uint16_t> ? PixelType::kUint16
                                                               : PixelType::kFloat32;
    if (type_ != kAsked) FailType(kAsked);
  }
  [[noreturn]] void FailType(PixelType asked) const;

  int width_ = 0, height_ = 0, channels_ = 0;
  PixelType type_ = PixelType::kUint8;
  ColorEncoding encoding_ = ColorEncoding::kSrgb;
  std::vector<std::byte> bytes_;
};

/// Encodes a linear value in [0, 1] with the sRGB curve; below 0 the curve is mirrored, above 1 it
/// goes on by its formula.
float SrgbFromLinear(float linear);
/// The inverse of SrgbFromLinear, to 1e-6.
float LinearFromSrgb(float srgb);

/// The same picture as linear float32. Exact for linear float input, table-driven for 8 and 16
/// bits. The last of two or four channels is alpha (coverage): scaled to [0, 1], never through the
/// curve.
Image ToLinearFloat(const Image& image);
/// The same picture as 8-bit sRGB, rounded to nearest, clamped to [0, 255]; NaN becomes 0. Alpha
/// is treated as in ToLinearFloat.
Image ToSrgb8(const Image& image);
/// The same picture as 8-bit sRGB with exactly three channels: gray is repeated, alpha left out
/// (the colours of transparent pixels stay what they are).
Image ToRgb8(const Image& image);
/// One channel: Rec. 709 luminance of an RGB picture (computed on the stored values), or a copy of
/// the only colour channel. Alpha is left out; type and encoding stay.
Image ToGray(const Image& image);

/// Reads PNG, JPEG, EXR or Radiance HDR by content, not by name.
///
/// 8-bit files are sRGB; EXR and HDR are linear float. A 16-bit PNG does not say: pass `encoding`
/// or get an Error. EXIF orientation is not applied: photographs are taken as stored.
/// Throws Error (file, cause, cure) when the file is missing, truncated, not a picture, or larger
/// than 65536 pixels a side.
Image ReadImage(const std::filesystem::path& file,
                std::optional<ColorEncoding> encoding = std::nullopt);

struct ImageWriteOptions {
  int png_compression = 2;  ///< 0-9; above 2 a photograph costs twice the time for 3 % fewer bytes
  int jpeg_quality = 92;    ///< 1-100
};
/// Writes by the ending of `file`: .png (8 bit sRGB, or 16 bit), .jpg (8 bit sRGB, 1 or 3
/// channels), .exr (float linear) or .hdr (float linear, 3 channels; negative values and NaN become
/// 0, since that format has neither). Atomic: a temporary file, then a rename. Throws Error where
/// type, encoding and ending do not agree.
void WriteImage(const Image& image, const std::filesystem::path& file,
                const ImageWriteOptions& options = {});

/// Encodes 8 or 16 bits to PNG bytes in memory, whatever the values mean; decodes PNG or JPEG bytes
/// of 8 bits (for textures inside GLB files).
std::vector<std::byte> EncodePng(const Image& image, int compression = 6);
Image DecodeImage(const std::byte* data, size_t size, const std::string& name_for_errors);

/// Bilinear value of a float picture's channel at (x, y) in pixel coordinates (centre of the
/// top-left pixel = (0, 0)); coordinates are clamped to the picture (a NaN to its first pixel).
float SampleBilinear(const Image& image, double x, double y, int channel);

}  // namespace lfm
