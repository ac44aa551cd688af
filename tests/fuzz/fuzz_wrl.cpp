// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cstring>
#include <string>

#include "core/error.h"
#include "core/image.h"
#include "encode/afx.h"
#include "tests/fuzz/fuzz_one.h"

namespace lfm::testing {
namespace {

// The seeds name their pictures CHANNELS-WIDTH-HEIGHT.png; such pictures are made as they are asked
// for, so that the text alone is what mutates.
std::string MakePicture(const std::string& name) {
  int numbers[3] = {};
  const char* at = name.data();
  const char* end = at + name.size();
  for (int& number : numbers) {
    const auto result = std::from_chars(at, end, number);
    if (result.ec != std::errc() || result.ptr == end) throw Error("model.wrl: no such picture");
    at = result.ptr + 1;
  }
  const auto [channels, width, height] = numbers;
  const bool small =
      channels >= 1 && channels <= 4 && width >= 1 && width <= 512 && height >= 1 && height <= 512;
  if (!small) throw Error("model.wrl: no such picture");
  Image image(width, height, channels, PixelType::kUint8, ColorEncoding::kSrgb);
  for (size_t i = 0; i < image.size(); ++i) {
    image.Data<uint8_t>()[i] = static_cast<uint8_t>(i * 37 / static_cast<size_t>(channels));
  }
  const std::vector<std::byte> png = EncodePng(image, 1);
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

}  // namespace

void FuzzOne(std::span<const uint8_t> input) {
  const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
  UseModel(ReadAfxText(text, "model.wrl", MakePicture));
}

}  // namespace lfm::testing
