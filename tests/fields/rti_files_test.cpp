// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "core/error.h"
#include "fields/ptm_file.h"
#include "fields/rti_file.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

FitPicture RandomPicture(LightBasis basis, int channels, int width, int height) {
  std::mt19937 random(3);
  const int terms = LightBasisTerms(basis);
  FitPicture picture{width, height, {}};
  QuantizedFit& fit = picture.fit;
  fit.basis = basis;
  fit.points = static_cast<int64_t>(width) * height;
  fit.channels = channels;
  for (int t = 0; t < terms; ++t) {
    fit.step.push_back(0.001 * (t + 1));
    fit.bias.push_back(10.0 * t - 20);
  }
  fit.bytes.resize(static_cast<size_t>(fit.points) * channels * terms);
  for (uint8_t& byte : fit.bytes) byte = static_cast<uint8_t>(random());
  if (basis == LightBasis::kPolynomial && channels == 1) {
    fit.chroma.resize(static_cast<size_t>(fit.points) * 3);
    for (uint8_t& byte : fit.chroma) byte = static_cast<uint8_t>(random());
  }
  return picture;
}

void ExpectSame(const FitPicture& a, const FitPicture& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.fit.basis, b.fit.basis);
  EXPECT_EQ(a.fit.space, b.fit.space);
  EXPECT_EQ(a.fit.points, b.fit.points);
  EXPECT_EQ(a.fit.bytes, b.fit.bytes);
  EXPECT_EQ(a.fit.chroma, b.fit.chroma);
  ASSERT_EQ(a.fit.step.size(), b.fit.step.size());
  for (size_t t = 0; t < a.fit.step.size(); ++t) {
    EXPECT_NEAR(a.fit.step[t], b.fit.step[t], 1e-7 * std::abs(a.fit.step[t]));
    EXPECT_NEAR(a.fit.bias[t], b.fit.bias[t], 1e-5 * std::abs(a.fit.bias[t]) + 1e-9);
  }
}

// Every truncated prefix of the content, and of the header, is refused.
template <typename Decode>
void ExpectHostileBytesAreRefused(const std::string& bytes, const Decode& decode) {
  for (size_t size = 0; size < bytes.size(); ++size) {
    const std::string cut = bytes.substr(0, size);
    EXPECT_THROW(decode(cut), Error) << size;
  }
  EXPECT_THROW(decode(bytes + "x"), Error);
  std::mt19937 random(11);
  for (int i = 0; i < 3000; ++i) {  // whatever comes out: no crash, no NaN
    std::string damaged = bytes;
    const size_t head = std::min<size_t>(damaged.size(), 110);
    for (int k = 0; k < 3; ++k) damaged[random() % head] = static_cast<char>(random());
    try {
      const FitPicture picture = decode(damaged);
      const LightFit fit = DequantizeFit(picture.fit);
      for (float shown : EvaluateFit(fit, {0.3, 0.4, 0.86})) EXPECT_GE(shown, 0);
    } catch (const Error&) {
    }
  }
}

TEST(PtmFile, HasTheBytesOfTheFormat) {
  FitPicture picture = RandomPicture(LightBasis::kPolynomial, 3, 1, 2);
  for (size_t i = 0; i < picture.fit.bytes.size(); ++i) {
    picture.fit.bytes[i] = static_cast<uint8_t>(i);
  }
  const std::string header =
      "PTM_1.2\nPTM_FORMAT_RGB\n1\n2\n0.255 0.51 0.765 1.02 1.275 1.53\n-20 -10 0 10 20 30\n";
  std::string content;
  for (int byte : {6, 0, 18, 12, 30, 24}) {  // the lower row first, in each channel
    for (int t = 0; t < 6; ++t) content += static_cast<char>(byte + t);
  }
  EXPECT_EQ(EncodePtm(picture), header + content);
}

TEST(PtmFile, ComesBack) {
  const ScratchFolder folder;
  for (int channels : {1, 3}) {
    const FitPicture picture = RandomPicture(LightBasis::kPolynomial, channels, 5, 3);
    WritePtm(picture, folder.folder / "a.ptm");
    ExpectSame(ReadPtm(folder.folder / "a.ptm"), picture);
  }
}

TEST(PtmFile, OneChannelWithoutChromaIsWhite) {
  FitPicture gray = RandomPicture(LightBasis::kPolynomial, 1, 2, 2);
  gray.fit.chroma.clear();
  const FitPicture back = DecodePtm(EncodePtm(gray), "a.ptm");
  EXPECT_EQ(back.fit.bytes, gray.fit.bytes);
  EXPECT_EQ(back.fit.chroma, std::vector<uint8_t>(12, 255));
}

TEST(PtmFile, IsReadWithWindowsLineEndsAndNumbersOnTheirLines) {
  const std::string bytes =
      "PTM_1.2\r\nPTM_FORMAT_LRGB\r\n1 1\r\n1 2 3 4 5 6 0 0 0 0 0 128\r\nabcdefxyz";
  const FitPicture picture = DecodePtm(bytes, "a.ptm");
  EXPECT_EQ(picture.fit.bytes[0], 'a');
  EXPECT_EQ(picture.fit.chroma[2], 'z');
  EXPECT_EQ(picture.fit.bias[5], 128);
  EXPECT_NEAR(picture.fit.step[1], 2 / 255.0, 1e-15);
}

TEST(PtmFile, RefusesOtherFormatsByName) {
  try {
    DecodePtm("PTM_1.2\nPTM_FORMAT_JPEG_LRGB\n1\n1\n", "a.ptm");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("a.ptm: is of the format 'PTM_FORMAT_JPEG_LRGB'"),
              std::string::npos);
  }
  for (const char* bytes :
       {"", "PTM_1.1\nPTM_FORMAT_RGB\n", "PTM_1.2\nPTM_FORMAT_RGB\n0\n1\n",
        "PTM_1.2\nPTM_FORMAT_RGB\n70000\n1\n",
        "PTM_1.2\nPTM_FORMAT_RGB\n65536\n65536\n1 1 1 1 1 1\n0 0 0 0 0 0\nabc",
        "PTM_1.2\nPTM_FORMAT_RGB\n1\n1\nnan 1 1 1 1 1\n0 0 0 0 0 0\n012345012345012345",
        "PTM_1.2\nPTM_FORMAT_RGB\n1\n1\n1 1 1 1 1 1\n0 inf 0 0 0 0\n012345012345012345"}) {
    EXPECT_THROW(DecodePtm(bytes, "a.ptm"), Error) << bytes;
  }
  FitPicture harmonics = RandomPicture(LightBasis::kHarmonics4, 3, 1, 1);
  EXPECT_THROW(EncodePtm(harmonics), Error);
  FitPicture linear = RandomPicture(LightBasis::kPolynomial, 3, 1, 1);
  linear.fit.space = FitSpace::kLinear;
  EXPECT_THROW(EncodePtm(linear), Error);
}

TEST(PtmFile, HostileBytesAreRefused) {
  ExpectHostileBytesAreRefused(EncodePtm(RandomPicture(LightBasis::kPolynomial, 1, 3, 2)),
                               [](const std::string& b) { return DecodePtm(b, "a.ptm"); });
}

TEST(RtiFile, HasTheBytesOfTheFormat) {
  FitPicture picture = RandomPicture(LightBasis::kHarmonics4, 3, 2, 1);
  for (size_t i = 0; i < picture.fit.bytes.size(); ++i) {
    picture.fit.bytes[i] = static_cast<uint8_t>(i);
  }
  const std::string bytes = EncodeRti(picture), header = "#HSH1.2\r\n3\r\n2 1 3\r\n4 2 1\r\n";
  ASSERT_EQ(bytes.size(), header.size() + 8 * 4 + 24);
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  float scale, bias;
  std::memcpy(&scale, bytes.data() + header.size() + 4, 4);
  std::memcpy(&bias, bytes.data() + header.size() + 5 * 4, 4);
  EXPECT_FLOAT_EQ(scale, 0.002f * 255);
  EXPECT_FLOAT_EQ(bias, 10 * 0.002f);
  std::string content;
  for (int byte : {0, 8, 16, 4, 12, 20}) {  // red, green, blue of the first pixel, then the next
    for (int t = 0; t < 4; ++t) content += static_cast<char>(byte + t);
  }
  EXPECT_EQ(bytes.substr(header.size() + 32), content);
}

TEST(RtiFile, ComesBack) {
  const ScratchFolder folder;
  for (LightBasis basis :
       {LightBasis::kHarmonics4, LightBasis::kHarmonics9, LightBasis::kHarmonics16}) {
    const FitPicture picture = RandomPicture(basis, 3, 5, 3);
    WriteRti(picture, folder.folder / "a.rti");
    ExpectSame(ReadRti(folder.folder / "a.rti"), picture);
  }
  const FitPicture gray = RandomPicture(LightBasis::kHarmonics4, 1, 2, 1);
  const FitPicture back = DecodeRti(EncodeRti(gray), "a.rti");
  EXPECT_EQ(back.fit.channels, 3);
  EXPECT_TRUE(std::equal(gray.fit.bytes.begin(), gray.fit.bytes.end(), back.fit.bytes.begin() + 8));
}

TEST(RtiFile, TermWithoutRangeIsItsBias) {
  std::string bytes = "#HSH1.2\n3\n1 1 3\n4 2 1\n";
  const float numbers[8] = {255, 0, 0, 0, 1, -0.5f, 0, 2};
  bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
  bytes += std::string(12, '\x80');
  const LightFit fit = DequantizeFit(DecodeRti(bytes, "a.rti").fit);
  EXPECT_FLOAT_EQ(fit.coefficients.Row(0)[0], 129);
  EXPECT_FLOAT_EQ(fit.coefficients.Row(1)[1], -0.5f);
  EXPECT_FLOAT_EQ(fit.coefficients.Row(2)[2], 0);
  EXPECT_FLOAT_EQ(fit.coefficients.Row(2)[3], 2);
}

TEST(RtiFile, RefusesOtherKinds) {
  for (const char* bytes : {"", "3\n1 1 3\n4 2 1\n", "#PTM1.2\n1\n1 1 3\n6 1 1\n",
                            "#HSH1.2\n3\n1 1 3\n5 2 1\n", "#HSH1.2\n3\n1 1 3\n4 2 4\n", "#"}) {
    EXPECT_THROW(DecodeRti(bytes, "a.rti"), Error) << bytes;
  }
  EXPECT_THROW(EncodeRti(RandomPicture(LightBasis::kPolynomial, 3, 1, 1)), Error);
}

TEST(RtiFile, HostileBytesAreRefused) {
  ExpectHostileBytesAreRefused(EncodeRti(RandomPicture(LightBasis::kHarmonics4, 3, 3, 2)),
                               [](const std::string& b) { return DecodeRti(b, "a.rti"); });
}

}  // namespace
}  // namespace lfm
