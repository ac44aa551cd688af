// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/image.h"

// The picture formats behind ReadImage and WriteImage: one .cpp a format. Private to core.

namespace lfm {

/// A picture file in memory, and the name that errors give it.
struct EncodedImage {
  const unsigned char* data = nullptr;
  size_t size = 0;
  std::string name;
};

/// Throws Error unless both sides are in [1, 65536] and a file of this length can hold so many
/// pixels: a forged header must fail before memory is taken for what it promises.
void RequirePlausibleSize(const EncodedImage& file, int64_t width, int64_t height,
                          int64_t bytes_per_pixel);

/// `encoding` is what a 16-bit file holds; without it such a file is an Error.
Image DecodePng(const EncodedImage& file, std::optional<ColorEncoding> encoding);
std::string EncodePngFile(const Image& image, int compression);

Image DecodeJpeg(const EncodedImage& file);
std::string EncodeJpeg(const Image& image, int quality);

Image DecodeExr(const EncodedImage& file);
std::string EncodeExr(const Image& image);

Image DecodeHdr(const EncodedImage& file);
std::string EncodeHdr(const Image& image);

}  // namespace lfm
