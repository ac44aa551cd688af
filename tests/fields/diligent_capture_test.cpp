// SPDX-License-Identifier: BSD-3-Clause
#include "fields/diligent_capture.h"

#include <gtest/gtest.h>

#include "fields/field_reading.h"
#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

class DiligentCapture : public ::testing::Test {
 protected:
  void SetUp() override {
    PutText(At("filenames.txt"), "001.png\r\n002.png\r\n003.png\r\n");
    PutText(At("light_directions.txt"), "0 0 1\n 0.6 0 0.8 \n0 -0.6 0.8\n");
    PutText(At("light_intensities.txt"), "1 1 1\n2 4 0.5\n4e0 4 4\n");
    for (int i = 1; i <= 3; ++i) {
      Image image(2, 1, 3, PixelType::kUint16, ColorEncoding::kLinear);
      for (int x = 0; x < 2; ++x) {
        for (int c = 0; c < 3; ++c) image.At<uint16_t>(x, 0, c) = static_cast<uint16_t>(i * 1000);
      }
      WriteImage(image, At("00" + std::to_string(i) + ".png"));
    }
    Image mask(2, 1, 3, PixelType::kUint8, ColorEncoding::kSrgb);
    for (int c = 0; c < 3; ++c) mask.At<uint8_t>(1, 0, c) = 255;
    WriteImage(mask, At("mask.png"));
  }
  std::filesystem::path At(const std::string& file) { return scratch_.folder / file; }
  Capture Open(const FieldCaptureOptions& options = {}) {
    return OpenDiligentCapture(scratch_.folder, options, progress_);
  }

  ScratchFolder scratch_;
  NotedProgress progress_;
};

TEST_F(DiligentCapture, PicturesAreDividedByTheirLightsIntensities) {
  ASSERT_TRUE(IsDiligentFolder(scratch_.folder));
  const Capture capture = Open({.held_out_lights = 3});
  EXPECT_EQ(capture.name, scratch_.folder.filename().string());
  const ReflectanceFieldData data = ReadReflectanceField(capture, {}, progress_);
  ASSERT_EQ(data.train.functions.columns, 2);
  ASSERT_EQ(data.held_out.functions.columns, 1);
  EXPECT_EQ(data.train.channels, 3);
  EXPECT_EQ(data.train_files, (std::vector<std::string>{"001.png", "002.png"}));
  const double kValue_rel = 1e-6;
  const double intensity[3] = {2, 4, 0.5};
  for (int c = 0; c < 3; ++c) {
    const float* row = data.train.functions.Row(data.train.RowOf(1, c));
    EXPECT_NEAR(row[0], 1000.0 / 65535, kValue_rel);
    EXPECT_NEAR(row[1], 2000.0 / 65535 / intensity[c], kValue_rel);
    EXPECT_NEAR(data.held_out.functions.Row(data.held_out.RowOf(1, c))[0], 3000.0 / 65535 / 4,
                kValue_rel);
    EXPECT_EQ(data.train.functions.Row(data.train.RowOf(0, c))[1], 0);  // not in the mask
  }
  EXPECT_EQ(data.train.mask, (std::vector<uint8_t>{0, 1}));
  EXPECT_LT((data.train.directions[1] - Eigen::Vector3d(0.6, 0, 0.8)).norm(), 1e-15);
  EXPECT_LT((data.held_out.directions[0] - Eigen::Vector3d(0, -0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(progress_.notes(), "");
}

TEST_F(DiligentCapture, IntensitiesAndMaskMayBeMissing) {
  std::filesystem::remove(At("light_intensities.txt"));
  std::filesystem::remove(At("mask.png"));
  const Capture capture = Open();
  EXPECT_NE(progress_.notes().find("equally strong"), std::string::npos);
  EXPECT_FALSE(capture.reflectance_field->pictures[1].intensity.has_value());
  EXPECT_EQ(capture.reflectance_field->mask, "");
}

TEST_F(DiligentCapture, OneIntensityALineIsOfAllColours) {
  PutText(At("light_intensities.txt"), "1\n2\n3\n");
  EXPECT_EQ(Open().reflectance_field->pictures[2].intensity, Eigen::Vector3d(3, 3, 3));
}

TEST_F(DiligentCapture, SurvivesTheManifest) {
  const Capture capture = Open();
  SaveCapture(capture);
  const ReflectanceFieldData a = ReadReflectanceField(capture, {}, SilentProgress());
  const ReflectanceFieldData b =
      ReadReflectanceField(LoadCapture(scratch_.folder), {}, SilentProgress());
  EXPECT_EQ(a.train.functions.values, b.train.functions.values);
}

TEST_F(DiligentCapture, WhatDoesNotFitTogetherIsNamed) {
  struct Case {
    const char* file;
    std::string text;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases = {
      {"filenames.txt", "", {"filenames.txt", "no picture"}},
      {"filenames.txt", "001.png\n002.png\n", {"light_directions.txt", "3 lines", "2 pictures"}},
      {"filenames.txt", "001.png\n002.png\n001.png\n", {"filenames.txt: line 3", "line 1"}},
      {"filenames.txt", "001.png\n002.png\n004.png\n", {"missing", "'004.png'"}},
      {"filenames.txt", "001.png\n../x/002.png\n003.png\n", {"line 2", "leaves"}},
      {"filenames.txt", "/etc/passwd\n002.png\n003.png\n", {"line 1", "absolute"}},
      {"light_directions.txt", "0 0 1\n", {"light_directions.txt", "1 lines", "3 pictures"}},
      {"light_directions.txt", "0 0 1\n0 1\n0 0 1\n", {"line 2", "three numbers"}},
      {"light_directions.txt", "0 0 1\n0 nan 1\n0 0 1\n", {"line 2", "'nan'", "finite"}},
      {"light_directions.txt", "0 0 1\n0 0 1\n0 0 0\n", {"line 3", "no direction"}},
      {"light_directions.txt", "1\n1\n1\n", {"line 1", "three numbers"}},
      {"light_intensities.txt", "1 1 1\n1 1 1\n", {"light_intensities.txt", "2 lines"}},
      {"light_intensities.txt", "1 1 1\n1 0 1\n1 1 1\n", {"line 2", "not positive"}},
      {"light_intensities.txt", "1 1 1\n1 1 1\n1 1 1e999\n", {"line 3", "'1e999'"}},
  };
  for (const Case& c : cases) {
    SetUp();
    PutText(At(c.file), c.text);
    ExpectErrorWith(c.parts, [&] { Open(); });
  }
}

TEST_F(DiligentCapture, AMaskOfAnotherSizeIsNamed) {
  PutGray(At("mask.png"), 3, 1, 255);
  ExpectErrorWith({"mask.png", "3 x 1", "2 x 1"},
                  [&] { ReadReflectanceField(Open(), {}, progress_); });
}

}  // namespace
}  // namespace lfm::testing
