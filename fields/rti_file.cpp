// SPDX-License-Identifier: BSD-3-Clause
#include "fields/rti_file.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "core/atomic_file.h"
#include "core/error.h"
#include "fields/header_text.h"

namespace lfm {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr int kHarmonics = 3;  // the file's word for what it holds
constexpr int kColors = 3;
constexpr double kWholeByte = 255;

void AddFloat(double value, std::string& bytes) {
  const auto number = static_cast<float>(value);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

LightBasis BasisOf(int terms, const HeaderText& text) {
  for (LightBasis basis :
       {LightBasis::kHarmonics4, LightBasis::kHarmonics9, LightBasis::kHarmonics16}) {
    if (LightBasisTerms(basis) == terms) return basis;
  }
  text.Fail("has " + std::to_string(terms) + " terms; 4, 9 and 16 are read");
}

std::vector<double> ReadFloats(const char* from, int count, const HeaderText& text) {
  std::vector<double> numbers;
  for (int i = 0; i < count; ++i) {
    float number;
    std::memcpy(&number, from + i * sizeof number, sizeof number);
    if (!std::isfinite(number)) text.Fail("has a scale or bias that is not finite");
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace

std::string EncodeRti(const FitPicture& picture) {
  const QuantizedFit& fit = picture.fit;
  const int64_t points = static_cast<int64_t>(picture.width) * picture.height;
  if (fit.basis == LightBasis::kPolynomial || fit.space != FitSpace::kDisplay) {
    throw Error("an .rti file holds hemispherical harmonics of display-coded values");
  }
  if (points == 0 || fit.points != points || !fit.chroma.empty() ||
      (fit.channels != 1 && fit.channels != kColors)) {
    throw Error("an .rti file holds one or three channels of a picture's pixels");
  }
  const int terms = LightBasisTerms(fit.basis);
  std::string bytes = "#HSH1.2\r\n" + std::to_string(kHarmonics) + "\r\n" +
                      std::to_string(picture.width) + " " + std::to_string(picture.height) + " " +
                      std::to_string(kColors) + "\r\n" + std::to_string(terms) + " 2 1\r\n";
  for (int t = 0; t < terms; ++t) AddFloat(fit.step[t] * kWholeByte, bytes);
  for (int t = 0; t < terms; ++t) AddFloat(-fit.bias[t] * fit.step[t], bytes);
  bytes.reserve(bytes.size() + static_cast<size_t>(points) * kColors * terms);
  for (int64_t point = 0; point < points; ++point) {
    for (int c = 0; c < kColors; ++c) {
      const int64_t row = (fit.channels == 1 ? 0 : c) * points + point;
      bytes.append(reinterpret_cast<const char*>(fit.bytes.data()) + row * terms, terms);
    }
  }
  return bytes;
}

FitPicture DecodeRti(std::string_view bytes, const std::string& name) {
  HeaderText text(bytes, name);
  if (!bytes.starts_with("#")) text.Fail("is no .rti file");
  text.SkipComments();
  if (text.Integer(0, 255) != kHarmonics) {
    text.Fail("holds no hemispherical harmonics; polynomials are read from .ptm files");
  }
  FitPicture picture;
  picture.width = text.Integer(1, 65536);
  picture.height = text.Integer(1, 65536);
  text.Integer(kColors, kColors);
  QuantizedFit& fit = picture.fit;
  const int terms = text.Integer(1, 255);
  fit.basis = BasisOf(terms, text);
  text.Integer(0, 255);  // how colours are held: with three channels, on their own
  text.Integer(1, 1);    // bytes a coefficient
  const std::string_view content = text.Rest();
  fit.points = static_cast<int64_t>(picture.width) * picture.height;
  const size_t scales = 2 * terms * sizeof(float);
  text.RequireSize(scales + static_cast<size_t>(fit.points) * kColors * terms);
  const std::vector<double> numbers = ReadFloats(content.data(), 2 * terms, text);
  for (int t = 0; t < terms; ++t) {
    const double scale = numbers[t], bias = numbers[terms + t];
    // A term without a range is its bias: bytes say nothing.
    fit.step.push_back(scale != 0 ? scale / kWholeByte : bias);
    fit.bias.push_back(scale != 0 ? -bias * kWholeByte / scale : -1);
  }
  fit.bytes.resize(static_cast<size_t>(fit.points) * kColors * terms);
  const char* from = content.data() + scales;
  for (int64_t point = 0; point < fit.points; ++point) {
    for (int c = 0; c < kColors; ++c) {
      uint8_t* to = fit.bytes.data() + (c * fit.points + point) * terms;
      for (int t = 0; t < terms; ++t) {
        to[t] = numbers[t] != 0 ? static_cast<uint8_t>(*from) : 0;
        ++from;
      }
    }
  }
  return picture;
}

void WriteRti(const FitPicture& picture, const std::filesystem::path& file) {
  WriteFileAtomically(file, EncodeRti(picture));
}

FitPicture ReadRti(const std::filesystem::path& file) {
  return DecodeRti(ReadFile(file), file.string());
}

}  // namespace lfm
