// SPDX-License-Identifier: BSD-3-Clause
#include "fields/ptm_file.h"

#include <algorithm>
#include <cstdio>

#include "core/atomic_file.h"
#include "core/error.h"
#include "fields/header_text.h"

namespace lfm {
namespace {

constexpr int kTerms = 6;
constexpr double kWhite = 255;  // of a .ptm file's values

// Rows from the bottom, `count` bytes a pixel: the same both ways.
void CopyFlipped(const uint8_t* from, int width, int height, int count, uint8_t* to) {
  const size_t row = static_cast<size_t>(width) * count;
  for (int y = 0; y < height; ++y) std::copy_n(from + (height - 1 - y) * row, row, to + y * row);
}

std::string HeaderOf(const FitPicture& picture, bool luminance) {
  std::string header = "PTM_1.2\n";
  header += luminance ? "PTM_FORMAT_LRGB\n" : "PTM_FORMAT_RGB\n";
  header += std::to_string(picture.width) + "\n" + std::to_string(picture.height) + "\n";
  char text[64];
  for (int t = 0; t < kTerms; ++t) {
    std::snprintf(text, sizeof text, "%.9g", picture.fit.step[t] * kWhite);
    header += (t == 0 ? "" : " ") + std::string(text);
  }
  header += "\n";
  for (int t = 0; t < kTerms; ++t) {
    std::snprintf(text, sizeof text, "%.0f", picture.fit.bias[t]);
    header += (t == 0 ? "" : " ") + std::string(text);
  }
  return header + "\n";
}

// Whether the format is PTM_FORMAT_LRGB; Error for those that are not read.
bool ReadFormat(HeaderText& text) {
  const std::string version = text.Word();
  if (version != "PTM_1.2") text.Fail("is no polynomial texture map of version 1.2");
  const std::string format = text.Word();
  if (format == "PTM_FORMAT_LRGB") return true;
  if (format == "PTM_FORMAT_RGB") return false;
  text.Fail("is of the format '" + format +
            "'; PTM_FORMAT_RGB and PTM_FORMAT_LRGB are read, so save it as one of these");
}

}  // namespace

std::string EncodePtm(const FitPicture& picture) {
  const QuantizedFit& fit = picture.fit;
  const int64_t points = static_cast<int64_t>(picture.width) * picture.height;
  if (fit.basis != LightBasis::kPolynomial || fit.space != FitSpace::kDisplay) {
    throw Error("a .ptm file holds a polynomial fit of display-coded values");
  }
  if (points == 0 || fit.points != points || (fit.channels != 1 && fit.channels != 3)) {
    throw Error("a .ptm file holds one or three channels of a picture's pixels");
  }
  const bool luminance = fit.channels == 1;
  std::string bytes = HeaderOf(picture, luminance);
  const size_t header = bytes.size(), plane = static_cast<size_t>(points) * kTerms;
  const size_t chroma = luminance ? static_cast<size_t>(points) * 3 : 0;
  bytes.resize(header + plane * fit.channels + chroma, static_cast<char>(255));
  auto* to = reinterpret_cast<uint8_t*>(bytes.data() + header);
  for (int c = 0; c < fit.channels; ++c) {
    CopyFlipped(fit.bytes.data() + c * plane, picture.width, picture.height, kTerms,
                to + c * plane);
  }
  if (!fit.chroma.empty()) {
    CopyFlipped(fit.chroma.data(), picture.width, picture.height, 3, to + plane);
  }
  return bytes;
}

FitPicture DecodePtm(std::string_view bytes, const std::string& name) {
  HeaderText text(bytes, name);
  const bool luminance = ReadFormat(text);
  FitPicture picture;
  picture.width = text.Integer(1, 65536);
  picture.height = text.Integer(1, 65536);
  QuantizedFit& fit = picture.fit;
  for (int t = 0; t < kTerms; ++t) fit.step.push_back(text.Number(1e12) / kWhite);
  for (int t = 0; t < kTerms; ++t) fit.bias.push_back(text.Number(1e12));
  const std::string_view content = text.Rest();
  fit.points = static_cast<int64_t>(picture.width) * picture.height;
  fit.channels = luminance ? 1 : 3;
  const size_t plane = static_cast<size_t>(fit.points) * kTerms;
  const size_t chroma = luminance ? static_cast<size_t>(fit.points) * 3 : 0;
  text.RequireSize(plane * fit.channels + chroma);
  const auto* from = reinterpret_cast<const uint8_t*>(content.data());
  fit.bytes.resize(plane * fit.channels);
  for (int c = 0; c < fit.channels; ++c) {
    CopyFlipped(from + c * plane, picture.width, picture.height, kTerms,
                fit.bytes.data() + c * plane);
  }
  fit.chroma.resize(chroma);
  if (luminance) {
    CopyFlipped(from + plane, picture.width, picture.height, 3, fit.chroma.data());
  }
  return picture;
}

void WritePtm(const FitPicture& picture, const std::filesystem::path& file) {
  WriteFileAtomically(file, EncodePtm(picture));
}

FitPicture ReadPtm(const std::filesystem::path& file) {
  return DecodePtm(ReadFile(file), file.string());
}

}  // namespace lfm
