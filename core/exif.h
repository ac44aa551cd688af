// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace lfm {

/// What a photograph says of the camera that took it.
struct ExifCamera {
  std::string make, model;  ///< trimmed; printable ASCII, 64 characters at most
  double focal_mm = 0;      ///< 0 when it does not say
};

/// From the bytes of a JPEG (segment APP1) or PNG (chunk eXIf) file: EXIF 2.32, tags Make (0x010f),
/// Model (0x0110) and FocalLength (0x920a). No answer for other files, without EXIF, or when none
/// of the three is there. What is truncated, hostile (offsets outside, loops, counts beyond the
/// data) or not finite counts as not there: pictures are often written by careless programs.
std::optional<ExifCamera> ParseExifCamera(std::span<const uint8_t> file);

/// The same for a file; no answer when it cannot be read.
std::optional<ExifCamera> ReadExifCamera(const std::filesystem::path& file);

}  // namespace lfm
