// SPDX-License-Identifier: BSD-3-Clause
#include "core/exif.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "core/error.h"
#include "core/mapped_file.h"

namespace lfm {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr uint16_t kMake = 0x010f, kModel = 0x0110, kExifDirectory = 0x8769, kFocalLength = 0x920a;
constexpr uint16_t kAscii = 2, kLong = 4, kRational = 5;
constexpr size_t kMaxText = 64;
constexpr double kMaxFocalMm = 1e5;

bool StartsWith(Bytes bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

// A TIFF block whose numbers have either byte order; every read is checked.
class TiffBlock {
 public:
  TiffBlock(Bytes bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}
  std::optional<uint32_t> Number(size_t offset, size_t size) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset) return std::nullopt;
    uint32_t value = 0;
    for (size_t i = 0; i < size; ++i) {
      value = value << 8 | bytes_[offset + (big_endian_ ? i : size - 1 - i)];
    }
    return value;
  }
  std::string Text(size_t offset, size_t count) const {
    std::string text;
    for (size_t i = 0; i < std::min(count, kMaxText) && offset + i < bytes_.size(); ++i) {
      const char c = static_cast<char>(bytes_[offset + i]);
      if (c == 0) break;
      if (c >= ' ' && c <= '~') text += c;
    }
    const size_t first = text.find_first_not_of(' ');
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
  }

 private:
  Bytes bytes_;
  bool big_endian_;
};

std::optional<double> FocalAt(const TiffBlock& tiff, size_t offset) {
  const auto above = tiff.Number(offset, 4), below = tiff.Number(offset + 4, 4);
  if (!above || !below || *below == 0) return std::nullopt;
  const double focal = static_cast<double>(*above) / *below;
  return focal > 0 && focal < kMaxFocalMm ? std::optional(focal) : std::nullopt;
}

// One directory: fills `camera`, returns where the EXIF directory is.
std::optional<uint32_t> ReadDirectory(const TiffBlock& tiff, size_t offset, ExifCamera& camera) {
  constexpr size_t kEntry = 12;
  const auto entries = tiff.Number(offset, 2);
  std::optional<uint32_t> exif;
  for (uint32_t i = 0; entries && i < *entries; ++i) {
    const size_t entry = offset + 2 + kEntry * i;
    const auto tag = tiff.Number(entry, 2), type = tiff.Number(entry + 2, 2);
    const auto count = tiff.Number(entry + 4, 4), value = tiff.Number(entry + 8, 4);
    if (!value) break;
    // Four bytes lie in the entry itself.
    const size_t text = *count <= 4 ? entry + 8 : *value;
    if (*tag == kMake && *type == kAscii) camera.make = tiff.Text(text, *count);
    if (*tag == kModel && *type == kAscii) camera.model = tiff.Text(text, *count);
    if (*tag == kFocalLength && *type == kRational) {
      camera.focal_mm = FocalAt(tiff, *value).value_or(camera.focal_mm);
    }
    if (*tag == kExifDirectory && *type == kLong) exif = *value;
  }
  return exif;
}

std::optional<ExifCamera> ParseTiff(Bytes bytes) {
  const bool big = StartsWith(bytes, "MM");
  if (!big && !StartsWith(bytes, "II")) return std::nullopt;
  const TiffBlock tiff(bytes, big);
  const auto magic = tiff.Number(2, 2), first = tiff.Number(4, 4);
  if (!first || *magic != 42) return std::nullopt;
  ExifCamera camera;
  // Two directories and no more: there is nothing to loop over.
  if (const auto exif = ReadDirectory(tiff, *first, camera)) ReadDirectory(tiff, *exif, camera);
  if (camera.make.empty() && camera.model.empty() && camera.focal_mm == 0) return std::nullopt;
  return camera;
}

uint32_t BigEndian(Bytes bytes) {
  uint32_t value = 0;
  for (const uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

std::optional<ExifCamera> ParseJpeg(Bytes file) {
  constexpr std::string_view kExif("Exif\0\0", 6);
  constexpr uint8_t kApp1 = 0xe1, kStartOfScan = 0xda;
  size_t at = 2;
  while (at + 4 <= file.size() && file[at] == 0xff && file[at + 1] != kStartOfScan) {
    const size_t length = BigEndian(file.subspan(at + 2, 2));
    if (length < 2 || at + 2 + length > file.size()) return std::nullopt;
    const Bytes content = file.subspan(at + 4, length - 2);
    if (file[at + 1] == kApp1 && StartsWith(content, kExif)) {
      return ParseTiff(content.subspan(kExif.size()));
    }
    at += 2 + length;
  }
  return std::nullopt;
}

std::optional<ExifCamera> ParsePng(Bytes file) {
  size_t at = 8;
  while (file.size() - at >= 12) {
    const size_t length = BigEndian(file.subspan(at, 4));
    if (length > file.size() - at - 12) return std::nullopt;
    if (StartsWith(file.subspan(at + 4), "eXIf")) return ParseTiff(file.subspan(at + 8, length));
    at += 12 + length;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ExifCamera> ParseExifCamera(Bytes file) {
  if (StartsWith(file, "\xff\xd8")) return ParseJpeg(file);
  if (StartsWith(file, "\x89PNG\r\n\x1a\n")) return ParsePng(file);
  return std::nullopt;
}

std::optional<ExifCamera> ReadExifCamera(const std::filesystem::path& file) {
  try {
    const MappedFile mapped(file);
    return ParseExifCamera(
        {reinterpret_cast<const uint8_t*>(mapped.bytes().data()), mapped.bytes().size()});
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace lfm
