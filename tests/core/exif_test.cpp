// SPDX-License-Identifier: BSD-3-Clause
#include "core/exif.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "test_files.h"

namespace lfm {
namespace {

using Bytes = std::vector<uint8_t>;

void Append(Bytes& bytes, uint32_t value, int size, bool big) {
  for (int i = 0; i < size; ++i) {
    bytes.push_back(static_cast<uint8_t>(value >> 8 * (big ? size - 1 - i : i)));
  }
}

// A TIFF block: directory with make, model and the EXIF directory, which holds the focal length.
Bytes Tiff(bool big) {
  Bytes t;
  const auto entry = [&](uint32_t tag, uint32_t type, uint32_t count, uint32_t value) {
    Append(t, tag, 2, big), Append(t, type, 2, big), Append(t, count, 4, big);
    Append(t, value, 4, big);
  };
  t = big ? Bytes{'M', 'M'} : Bytes{'I', 'I'};
  Append(t, 42, 2, big), Append(t, 8, 4, big);
  Append(t, 3, 2, big);
  entry(0x010f, 2, 6, 68);
  entry(0x0110, 2, 7, 74);
  entry(0x8769, 4, 1, 50);
  Append(t, 0, 4, big);
  Append(t, 1, 2, big);
  entry(0x920a, 5, 1, 81);
  Append(t, 0, 4, big);
  for (const char c : std::string("Canon\0 EOS 5\0", 13)) t.push_back(static_cast<uint8_t>(c));
  Append(t, 105, 4, big), Append(t, 2, 4, big);
  return t;
}

Bytes Jpeg(const Bytes& tiff) {
  Bytes file = {0xff, 0xd8, 0xff, 0xe0, 0, 4, 1, 2, 0xff, 0xe1};
  Append(file, static_cast<uint32_t>(tiff.size() + 8), 2, true);
  for (const char c : std::string("Exif\0\0", 6)) file.push_back(static_cast<uint8_t>(c));
  file.insert(file.end(), tiff.begin(), tiff.end());
  file.insert(file.end(), {0xff, 0xda, 0, 2, 0xff, 0xd9});
  return file;
}

Bytes Png(const Bytes& tiff) {
  Bytes file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 1, 'I', 'H', 'D', 'R', 7};
  Append(file, 0, 4, true);
  Append(file, static_cast<uint32_t>(tiff.size()), 4, true);
  for (const char c : {'e', 'X', 'I', 'f'}) file.push_back(static_cast<uint8_t>(c));
  file.insert(file.end(), tiff.begin(), tiff.end());
  Append(file, 0, 4, true);
  return file;
}

TEST(Exif, ReadsMakeModelAndFocalLengthOfBothByteOrders) {
  for (const bool big : {false, true}) {
    for (const Bytes& file : {Jpeg(Tiff(big)), Png(Tiff(big))}) {
      const std::optional<ExifCamera> camera = ParseExifCamera(file);
      ASSERT_TRUE(camera);
      EXPECT_EQ(camera->make, "Canon");
      EXPECT_EQ(camera->model, "EOS 5");
      EXPECT_EQ(camera->focal_mm, 52.5);
    }
  }
}

TEST(Exif, OtherFilesSayNothing) {
  EXPECT_FALSE(ParseExifCamera({}));
  EXPECT_FALSE(ParseExifCamera(Bytes{0xff, 0xd8}));
  EXPECT_FALSE(ParseExifCamera(Bytes{'G', 'I', 'F', '8'}));
  EXPECT_FALSE(ParseExifCamera(Jpeg({})));
  EXPECT_FALSE(ReadExifCamera("no such file.jpg"));
  const TestFolder folder;
  Put(folder / "empty.jpg", "");
  EXPECT_FALSE(ReadExifCamera(folder / "empty.jpg"));
  const Bytes file = Jpeg(Tiff(true));
  Put(folder / "photo.jpg", std::string(file.begin(), file.end()));
  ASSERT_TRUE(ReadExifCamera(folder / "photo.jpg"));
  EXPECT_EQ(ReadExifCamera(folder / "photo.jpg")->model, "EOS 5");
}

// In exactly sized blocks, so that the address sanitizer sees every step outside.
TEST(Exif, TruncatedAndHostileFilesAreSafe) {
  for (const Bytes& whole : {Jpeg(Tiff(false)), Png(Tiff(true))}) {
    for (size_t size = 0; size < whole.size(); ++size) {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      ParseExifCamera(part);
    }
    std::mt19937 random(1);
    for (int i = 0; i < 20000; ++i) {
      Bytes changed = whole;
      for (int k = 0; k < 4; ++k) {
        changed[random() % changed.size()] = random() % 2 ? 0xff : static_cast<uint8_t>(random());
      }
      const std::optional<ExifCamera> camera = ParseExifCamera(changed);
      if (!camera) continue;
      EXPECT_LE(camera->make.size(), 64u);
      EXPECT_TRUE(camera->focal_mm >= 0 && camera->focal_mm < 1e6);
    }
  }
}

TEST(Exif, ADirectoryThatPointsAtItselfEnds) {
  Bytes tiff = Tiff(true);
  tiff[10 + 24 + 11] = 8;  // the EXIF directory's offset: the first directory's
  const std::optional<ExifCamera> camera = ParseExifCamera(Jpeg(tiff));
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->make, "Canon");
  EXPECT_EQ(camera->focal_mm, 0);
}

}  // namespace
}  // namespace lfm
