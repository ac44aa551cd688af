// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <cstring>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/image.h"
#include "core/image_codecs.h"

namespace lfm {
namespace {

enum class FileFormat { kUnknown, kPng, kJpeg, kExr, kHdr };

bool StartsWith(const EncodedImage& file, std::string_view magic) {
  return file.size >= magic.size() && std::memcmp(file.data, magic.data(), magic.size()) == 0;
}

FileFormat DetectFormat(const EncodedImage& file) {
  if (StartsWith(file, "\x89PNG\r\n\x1a\n")) return FileFormat::kPng;
  if (StartsWith(file, "\xff\xd8\xff")) return FileFormat::kJpeg;
  if (StartsWith(file, "\x76\x2f\x31\x01")) return FileFormat::kExr;
  if (StartsWith(file, "#?RADIANCE") || StartsWith(file, "#?RGBE")) return FileFormat::kHdr;
  return FileFormat::kUnknown;
}

[[noreturn]] void FailUnknown(const EncodedImage& file, const char* expected) {
  if (file.size == 0) throw Error(file.name + ": the file is empty; expected " + expected);
  throw Error(file.name + ": not a picture that can be read; expected " + expected);
}

std::string Ending(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending;
}

void RequireFloatLinear(const Image& image, const std::string& name) {
  if (image.type() != PixelType::kFloat32 || image.encoding() != ColorEncoding::kLinear) {
    throw Error(name + ": holds linear float values; convert the picture with ToLinearFloat");
  }
}

void RequireCoded8(const Image& image, const std::string& name) {
  if (image.type() == PixelType::kUint8 && image.encoding() != ColorEncoding::kSrgb) {
    throw Error(name + ": 8-bit files are read as sRGB; convert the picture with ToSrgb8");
  }
}

std::string Encode(const Image& image, const std::string& ending, const std::string& name,
                   const ImageWriteOptions& options) {
  if (image.empty()) throw Error(name + ": the picture to write is empty");
  if (ending == ".png") {
    if (image.type() == PixelType::kFloat32) {
      throw Error(name + ": PNG holds 8 or 16 bits; convert with ToSrgb8 or write .exr");
    }
    RequireCoded8(image, name);
    return EncodePngFile(image, options.png_compression);
  }
  if (ending == ".jpg" || ending == ".jpeg") {
    if (image.type() != PixelType::kUint8 || (image.channels() != 1 && image.channels() != 3)) {
      throw Error(name + ": JPEG holds 8 bits and 1 or 3 channels; write .png instead");
    }
    RequireCoded8(image, name);
    return EncodeJpeg(image, options.jpeg_quality);
  }
  if (ending == ".exr") {
    RequireFloatLinear(image, name);
    return EncodeExr(image);
  }
  if (ending == ".hdr") {
    RequireFloatLinear(image, name);
    if (image.channels() != 3) throw Error(name + ": HDR holds 3 channels; write .exr instead");
    return EncodeHdr(image);
  }
  throw Error(name + ": unknown ending of a picture file; use .png, .jpg, .exr or .hdr");
}

}  // namespace

void RequirePlausibleSize(const EncodedImage& file, int64_t width, int64_t height,
                          int64_t bytes_per_pixel) {
  constexpr int64_t kMaxSide = 65536;
  // Far above what deflate (1032 : 1) and flat JPEG blocks (512 : 1) reach; EXR's flat areas can go
  // beyond, so pictures that any machine can hold pass unasked.
  constexpr int64_t kMaxRatio = 4096, kSmallPicture = int64_t{64} << 20;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    throw Error(file.name + ": the header promises " + std::to_string(width) + " x " +
                std::to_string(height) + " pixels; sides must be in [1, 65536]");
  }
  const int64_t decoded = width * height * bytes_per_pixel;
  if (decoded > kSmallPicture && decoded / kMaxRatio > static_cast<int64_t>(file.size)) {
    throw Error(file.name + ": the file is truncated: " + std::to_string(file.size) +
                " bytes cannot hold " + std::to_string(width) + " x " + std::to_string(height) +
                " pixels; copy it again");
  }
}

Image ReadImage(const std::filesystem::path& file, std::optional<ColorEncoding> encoding) {
  const std::string content = ReadFile(file);
  const EncodedImage encoded{reinterpret_cast<const unsigned char*>(content.data()), content.size(),
                             file.string()};
  switch (DetectFormat(encoded)) {
    case FileFormat::kPng:
      return DecodePng(encoded, encoding);
    case FileFormat::kJpeg:
      return DecodeJpeg(encoded);
    case FileFormat::kExr:
      return DecodeExr(encoded);
    case FileFormat::kHdr:
      return DecodeHdr(encoded);
    case FileFormat::kUnknown:
      break;
  }
  FailUnknown(encoded, "PNG, JPEG, EXR or Radiance HDR");
}

void WriteImage(const Image& image, const std::filesystem::path& file,
                const ImageWriteOptions& options) {
  WriteFileAtomically(file, Encode(image, Ending(file), file.string(), options));
}

std::vector<std::byte> EncodePng(const Image& image, int compression) {
  if (image.empty() || image.type() == PixelType::kFloat32) {
    throw Error("PNG holds 8 or 16 bits a value and at least one pixel");
  }
  const std::string encoded = EncodePngFile(image, compression);
  std::vector<std::byte> bytes(encoded.size());
  std::memcpy(bytes.data(), encoded.data(), encoded.size());
  return bytes;
}

Image DecodeImage(const std::byte* data, size_t size, const std::string& name_for_errors) {
  const EncodedImage encoded{reinterpret_cast<const unsigned char*>(data), size, name_for_errors};
  switch (DetectFormat(encoded)) {
    case FileFormat::kPng:
      return DecodePng(encoded, std::nullopt);
    case FileFormat::kJpeg:
      return DecodeJpeg(encoded);
    default:
      FailUnknown(encoded, "PNG or JPEG");
  }
}

}  // namespace lfm
