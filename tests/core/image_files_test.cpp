// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/image.h"
#include "test_files.h"

namespace lfm {
namespace {

/// A smooth picture with all levels, different in every channel and along both axes.
Image Pattern(int width, int height, int channels, PixelType type, ColorEncoding encoding) {
  Image image(width, height, channels, type, encoding);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const double v = 0.5 + 0.5 * std::sin(0.11 * x * (c + 1) + 0.07 * y + c);
        switch (type) {
          case PixelType::kUint8:
            image.At<uint8_t>(x, y, c) = static_cast<uint8_t>(255 * v);
            break;
          case PixelType::kUint16:
            image.At<uint16_t>(x, y, c) = static_cast<uint16_t>(65535 * v);
            break;
          case PixelType::kFloat32:
            image.At<float>(x, y, c) = static_cast<float>(v * std::pow(10, 6 * v - 3));
            break;
        }
      }
    }
  }
  return image;
}

void ExpectSame(const Image& a, const Image& b) {
  EXPECT_EQ(a.width(), b.width());
  EXPECT_EQ(a.height(), b.height());
  EXPECT_EQ(a.channels(), b.channels());
  EXPECT_EQ(a.type(), b.type());
  EXPECT_EQ(a.encoding(), b.encoding());
  EXPECT_TRUE(a.Bytes() == b.Bytes());
}

TEST(ImageFiles, PngKeepsEveryBit) {
  const TestFolder folder;
  for (int channels = 1; channels <= 4; ++channels) {
    for (const int compression : {0, 1, 3, 9}) {
      const Image image = Pattern(37, 23, channels, PixelType::kUint8, ColorEncoding::kSrgb);
      WriteImage(image, folder / "a.png", {compression, 92});
      ExpectSame(ReadImage(folder / "a.png"), image);
    }
    for (const ColorEncoding encoding : {ColorEncoding::kLinear, ColorEncoding::kSrgb}) {
      const Image image = Pattern(37, 23, channels, PixelType::kUint16, encoding);
      WriteImage(image, folder / "b.PNG");
      ExpectSame(ReadImage(folder / "b.PNG", encoding), image);
    }
  }
  EXPECT_EQ(folder.FileCount(), 2) << "temporary files are left";
}

TEST(ImageFiles, SixteenBitPngMustStateItsEncoding) {
  const TestFolder folder;
  WriteImage(Pattern(4, 4, 1, PixelType::kUint16, ColorEncoding::kLinear), folder / "a.png");
  ExpectError([&] { ReadImage(folder / "a.png"); }, "a.png");
  ExpectError([&] { ReadImage(folder / "a.png"); }, "state its encoding");
}

TEST(ImageFiles, ExrKeepsEveryBitEvenOfExtremes) {
  const TestFolder folder;
  for (int channels = 1; channels <= 4; ++channels) {
    Image image = Pattern(33, 40, channels, PixelType::kFloat32, ColorEncoding::kLinear);
    image.Data<float>()[0] = -1e30f;
    image.Data<float>()[channels] = std::numeric_limits<float>::infinity();
    image.Data<float>()[2 * channels] = 1e-40f;
    WriteImage(image, folder / "a.exr");
    ExpectSame(ReadImage(folder / "a.exr"), image);
  }
}

TEST(ImageFiles, HdrKeepsTheLargestChannelToOnePart256) {
  const TestFolder folder;
  for (const int width : {3, 7, 8, 200}) {  // plain rows below 8 pixels, runs from there on
    const Image image = Pattern(width, 9, 3, PixelType::kFloat32, ColorEncoding::kLinear);
    WriteImage(image, folder / "a.hdr");
    const Image back = ReadImage(folder / "a.hdr");
    ASSERT_EQ(back.width(), width);
    ASSERT_EQ(back.height(), 9);
    EXPECT_EQ(back.encoding(), ColorEncoding::kLinear);
    for (size_t i = 0; i < image.size(); i += 3) {
      const float* in = image.Data<float>() + i;
      const float largest = std::max({in[0], in[1], in[2]});
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(back.Data<float>()[i + c], in[c], largest / 255.5) << i << " " << c;
      }
    }
    // What the format can hold it keeps exactly.
    WriteImage(back, folder / "b.hdr");
    ExpectSame(ReadImage(folder / "b.hdr"), back);
  }
}

TEST(ImageFiles, HdrHoldsExtremesAsDocumented) {
  const TestFolder folder;
  Image image(9, 1, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  image.At<float>(0, 0, 0) = -5;
  image.At<float>(1, 0, 1) = std::numeric_limits<float>::quiet_NaN();
  image.At<float>(2, 0, 2) = std::numeric_limits<float>::infinity();
  image.At<float>(3, 0, 0) = 1e-45f;
  image.At<float>(4, 0, 0) = 255.9f;  // rounds up to a mantissa of 256
  image.At<float>(5, 0, 0) = 1e-37f;
  WriteImage(image, folder / "a.hdr");
  const Image back = ReadImage(folder / "a.hdr");
  EXPECT_EQ(back.At<float>(0, 0, 0), 0);
  EXPECT_EQ(back.At<float>(1, 0, 1), 0);
  EXPECT_GT(back.At<float>(2, 0, 2), 1e38f);
  EXPECT_TRUE(std::isfinite(back.At<float>(2, 0, 2)));
  EXPECT_EQ(back.At<float>(3, 0, 0), 0);
  EXPECT_NEAR(back.At<float>(4, 0, 0), 255.9, 1);
  EXPECT_NEAR(back.At<float>(5, 0, 0), 1e-37, 1e-39);
}

TEST(ImageFiles, JpegIsCloseAndKeepsColour) {
  const TestFolder folder;
  for (const int channels : {1, 3}) {
    const Image image = Pattern(64, 48, channels, PixelType::kUint8, ColorEncoding::kSrgb);
    WriteImage(image, folder / "a.jpg", {3, 98});
    const Image back = ReadImage(folder / "a.jpg");
    ASSERT_EQ(back.channels(), channels);
    ASSERT_EQ(back.size(), image.size());
    double squares = 0;
    for (size_t i = 0; i < image.size(); ++i) {
      squares += std::pow(image.Data<uint8_t>()[i] - back.Data<uint8_t>()[i], 2);
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(image.size())), 2);
  }
}

// A tag that says "turn me by 90 degrees" (6) changes nothing: lenses are calibrated in the axes of
// the sensor.
TEST(ImageFiles, IgnoreExifOrientation) {
  const TestFolder folder;
  WriteImage(Pattern(32, 16, 3, PixelType::kUint8, ColorEncoding::kSrgb), folder / "a.jpg");
  const Image plain = ReadImage(folder / "a.jpg");
  const std::string exif(
      "\xff\xe1\x00\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  std::string bytes = Get(folder / "a.jpg");
  bytes.insert(2, exif);
  Put(folder / "a.jpg", bytes);
  ExpectSame(ReadImage(folder / "a.jpg"), plain);
}

TEST(ImageFiles, AreDetectedByContentNotByName) {
  const TestFolder folder;
  const Image image = Pattern(8, 8, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  WriteImage(image, folder / "a.png");
  std::filesystem::rename(folder / "a.png", folder / "a.jpg");
  ExpectSame(ReadImage(folder / "a.jpg"), image);
}

TEST(ImageFiles, RefuseTypesThatTheEndingCannotHold) {
  const TestFolder folder;
  const Image bytes = Pattern(8, 8, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const Image linear_bytes = Pattern(8, 8, 3, PixelType::kUint8, ColorEncoding::kLinear);
  const Image floats = Pattern(8, 8, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  const Image gray = Pattern(8, 8, 1, PixelType::kFloat32, ColorEncoding::kLinear);
  const auto write = [&](const Image& image, const char* name) {
    return [&, name] { WriteImage(image, folder / name); };
  };
  ExpectError(write(floats, "a.png"), "a.png");
  ExpectError(write(floats, "a.jpg"), "a.jpg");
  ExpectError(write(bytes, "a.exr"), "ToLinearFloat");
  ExpectError(write(bytes, "a.hdr"), "ToLinearFloat");
  ExpectError(write(linear_bytes, "a.png"), "sRGB");
  ExpectError(write(gray, "a.hdr"), "3 channels");
  ExpectError(write(bytes, "a.gif"), "unknown ending");
  ExpectError(write(Image(), "a.png"), "empty");
  EXPECT_EQ(folder.FileCount(), 0);
}

TEST(ImageFiles, MissingEmptyAndForeignFilesAreErrors) {
  const TestFolder folder;
  ExpectError([&] { ReadImage(folder / "none.png"); }, "none.png");
  Put(folder / "empty.png", "");
  ExpectError([&] { ReadImage(folder / "empty.png"); }, "empty");
  Put(folder / "text.jpg", "hello, this is text");
  ExpectError([&] { ReadImage(folder / "text.jpg"); }, "text.jpg: not a picture");
  ExpectError([&] { ReadImage(folder.path()); }, folder.path().string());
}

/// A small picture file of every format, and a reader of its bytes: in memory where that exists,
/// since thousands of files take long.
struct FormatCase {
  const char* name;
  PixelType type;
  bool in_memory;
};

class PictureFile : public testing::TestWithParam<FormatCase> {
 protected:
  std::string Whole() const {
    const ColorEncoding encoding =
        GetParam().type == PixelType::kUint8 ? ColorEncoding::kSrgb : ColorEncoding::kLinear;
    WriteImage(Pattern(11, 9, 3, GetParam().type, encoding), folder_ / GetParam().name);
    return Get(folder_ / GetParam().name);
  }
  Image Read(const std::string& bytes) const {
    if (GetParam().in_memory) {
      // A block of exactly this size, so that a sanitizer sees any read beyond it.
      const std::vector<std::byte> exact(
          reinterpret_cast<const std::byte*>(bytes.data()),
          reinterpret_cast<const std::byte*>(bytes.data()) + bytes.size());
      return DecodeImage(exact.data(), exact.size(), "picture in memory");
    }
    Put(folder_ / "picture", bytes);
    return ReadImage(folder_ / "picture");
  }

 private:
  TestFolder folder_;
};

TEST_P(PictureFile, CutAtAnyLengthIsAnError) {
  const std::string whole = Whole();
  ASSERT_NO_THROW(Read(whole));
  for (size_t length = 0; length < whole.size(); ++length) {
    ASSERT_THROW(Read(whole.substr(0, length)), Error) << "cut to " << length;
  }
}

TEST_P(PictureFile, WithAFlippedByteIsAPictureOrAnError) {
  const std::string whole = Whole();
  int errors = 0;
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string bytes = whole;
    bytes[i] = static_cast<char>(bytes[i] ^ (i % 3 == 0 ? 0xff : i % 3 == 1 ? 0x80 : 0x01));
    try {
      EXPECT_FALSE(Read(bytes).empty());
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, PictureFile,
                         testing::Values(FormatCase{"a.png", PixelType::kUint8, true},
                                         FormatCase{"a.jpg", PixelType::kUint8, true},
                                         FormatCase{"a.exr", PixelType::kFloat32, false},
                                         FormatCase{"a.hdr", PixelType::kFloat32, false}),
                         [](const auto& test) { return std::string(test.param.name + 2); });

void PutBigEndian(std::string& bytes, size_t at, uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (24 - 8 * i));
}

uint32_t Crc(const std::string& bytes) {
  uint32_t crc = ~0u;
  for (const unsigned char byte : bytes) {
    crc ^= byte;
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
  }
  return ~crc;
}

/// A valid PNG whose header promises another size, with a right check sum.
std::string PngWithForgedSize(uint32_t width, uint32_t height) {
  const TestFolder folder;
  WriteImage(Image(4, 4, 3, PixelType::kUint8, ColorEncoding::kSrgb), folder / "a.png");
  std::string bytes = Get(folder / "a.png");
  PutBigEndian(bytes, 16, width);
  PutBigEndian(bytes, 20, height);
  PutBigEndian(bytes, 29, Crc(bytes.substr(12, 17)));
  return bytes;
}

TEST(ImageFiles, HugeHeadersFailBeforeMemoryIsTaken) {
  const TestFolder folder;
  Put(folder / "a.png", PngWithForgedSize(70000, 10));
  ExpectError([&] { ReadImage(folder / "a.png"); }, "70000 x 10");
  Put(folder / "b.png", PngWithForgedSize(65536, 65536));  // 12 GB
  ExpectError([&] { ReadImage(folder / "b.png"); }, "b.png: the file is truncated");
  Put(folder / "c.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 65000 +X 65000\nabc");
  ExpectError([&] { ReadImage(folder / "c.hdr"); }, "truncated");
  Put(folder / "d.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 99999999999\nabc");
  ExpectError([&] { ReadImage(folder / "d.hdr"); }, "sides must be in [1, 65536]");

  WriteImage(Pattern(16, 16, 3, PixelType::kUint8, ColorEncoding::kSrgb), folder / "e.jpg");
  std::string jpeg = Get(folder / "e.jpg");
  const size_t frame = jpeg.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  for (int i = 0; i < 4; ++i) jpeg[frame + 5 + i] = static_cast<char>(0xfd);  // 65021 x 65021
  Put(folder / "e.jpg", jpeg);
  ExpectError([&] { ReadImage(folder / "e.jpg"); }, "e.jpg");

  WriteImage(Pattern(16, 16, 3, PixelType::kFloat32, ColorEncoding::kLinear), folder / "f.exr");
  std::string exr = Get(folder / "f.exr");
  const size_t window = exr.find("dataWindow") + std::strlen("dataWindow") + 1 + 6 + 4;
  const int32_t far = 60000;
  std::memcpy(exr.data() + window + 8, &far, 4);
  std::memcpy(exr.data() + window + 12, &far, 4);
  Put(folder / "f.exr", exr);
  ExpectError([&] { ReadImage(folder / "f.exr"); }, "60001 x 60001");
}

TEST(ImageBytes, PngRoundTripsInMemory) {
  for (int channels = 1; channels <= 4; ++channels) {
    const Image image = Pattern(21, 13, channels, PixelType::kUint8, ColorEncoding::kSrgb);
    const std::vector<std::byte> bytes = EncodePng(image);
    ExpectSame(DecodeImage(bytes.data(), bytes.size(), "texture 3"), image);
    ExpectError([&] { DecodeImage(bytes.data(), bytes.size() - 1, "texture 3"); }, "texture 3");
  }
  ExpectError([&] { DecodeImage(nullptr, 0, "texture 4"); }, "texture 4: the file is empty");
  ExpectError([&] { EncodePng(Image(1, 1, 1, PixelType::kFloat32, ColorEncoding::kLinear)); },
              "PNG");
}

TEST(ImageBytes, OutputIsDeterministic) {
  const Image image = Pattern(50, 50, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  EXPECT_EQ(EncodePng(image, 3), EncodePng(image, 3));
}

}  // namespace
}  // namespace lfm
