// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace lfm {

/// What a PNG says of itself in its first bytes: known before anything is decoded.
struct PngHeader {
  int64_t width = 0, height = 0;  ///< up to 2^32 - 1
  int bit_depth = 0;
  int channels = 0;  ///< 1 grey, 3 RGB; 0 for palettes and alpha
};

/// Empty for bytes that do not begin as a PNG does.
inline std::optional<PngHeader> ReadPngHeader(std::string_view png) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  constexpr size_t kHeaderBytes = 29;  // signature; length, name and content of IHDR
  if (png.size() < kHeaderBytes || !png.starts_with(kSignature) || png.substr(12, 4) != "IHDR") {
    return std::nullopt;
  }
  const auto big_endian = [&](size_t at) {
    int64_t value = 0;
    for (size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<uint8_t>(png[i]);
    return value;
  };
  const int color_type = png[25];
  return PngHeader{big_endian(16), big_endian(20), png[24],
                   color_type == 0   ? 1
                   : color_type == 2 ? 3
                                     : 0};
}

}  // namespace lfm
