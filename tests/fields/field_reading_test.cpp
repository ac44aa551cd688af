// SPDX-License-Identifier: BSD-3-Clause
#include "fields/field_reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "core/parallel.h"
#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A capture whose pictures lie in memory.
struct MemoryField {
  Capture capture;
  std::map<std::string, Image> pictures;

  MemoryField(int width, int height) {
    capture.folder = "memory";
    capture.name = "made";
    capture.cameras["view"] = {width, height, std::nullopt, std::nullopt};
    capture.reflectance_field = ReflectanceField{};
    capture.reflectance_field->camera = "view";
  }
  LitPicture& Add(Image image, const Eigen::Vector3d& to_light = {0, 0, 1},
                  PhotoSplit split = PhotoSplit::kTrain) {
    std::vector<LitPicture>& list = capture.reflectance_field->pictures;
    const std::string file = std::to_string(list.size()) + ".exr";
    pictures[file] = std::move(image);
    list.push_back({file, to_light, split});
    return list.back();
  }
  ReflectanceFieldData Read(const FieldReadOptions& options = {},
                            Progress& progress = SilentProgress()) const {
    return ReadReflectanceField(
        capture, [this](const std::string& file) { return pictures.at(file); }, options, progress);
  }
};

float Coded(int light, int x, int y, int c) {
  return static_cast<float>(light * 1000 + y * 100 + x * 10 + c);
}

Image CodedPicture(int light, int width, int height, int channels) {
  return FloatPicture(width, height, channels,
                      [&](int x, int y, int c) { return Coded(light, x, y, c); });
}

TEST(FieldReading, EveryNumberStandsInItsRowAndColumn) {
  for (const int channels : {1, 2, 3, 4}) {  // 2 and 4 with alpha
    MemoryField made(5, 3);
    for (int light = 0; light < 40; ++light) {
      made.Add(CodedPicture(light, 5, 3, channels),
               Eigen::Vector3d(std::cos(light), std::sin(light), 1).normalized(),
               light % 4 == 3 ? PhotoSplit::kTest : PhotoSplit::kTrain);
    }
    NotedProgress progress;
    const ReflectanceFieldData data = made.Read({}, progress);
    EXPECT_TRUE(progress.Finished());
    EXPECT_EQ(progress.notes(), "");
    const int colours = channels < 3 ? 1 : 3;
    for (const Field* field : {&data.train, &data.held_out}) {
      const bool held_out = field == &data.held_out;
      EXPECT_EQ(field->kind, FieldColumns::kLights);
      EXPECT_EQ(field->points, 15);
      EXPECT_EQ(field->channels, colours);
      EXPECT_EQ(field->width, 5);
      EXPECT_EQ(field->height, 3);
      EXPECT_TRUE(field->mask.empty());
      ASSERT_EQ(field->functions.rows, 15 * colours);
      ASSERT_EQ(field->functions.columns, held_out ? 10 : 30);
      int column = 0;
      for (int light = 0; light < 40; ++light) {
        if ((light % 4 == 3) != held_out) continue;
        EXPECT_LT((field->directions[column] -
                   Eigen::Vector3d(std::cos(light), std::sin(light), 1).normalized())
                      .norm(),
                  1e-15);
        EXPECT_EQ((held_out ? data.held_out_files : data.train_files)[column],
                  std::to_string(light) + ".exr");
        for (int c = 0; c < colours; ++c) {
          for (int p = 0; p < 15; ++p) {
            ASSERT_EQ(field->functions.Row(field->RowOf(p, c))[column],
                      Coded(light, p % 5, p / 5, c));
          }
        }
        ++column;
      }
      for (int64_t r = 0; r < field->functions.rows; ++r) {  // padding
        for (int c = field->functions.columns; c < field->functions.stride; ++c) {
          ASSERT_EQ(field->functions.Row(r)[c], 0);
        }
      }
    }
  }
}

TEST(FieldReading, DoesNotDependOnTheNumberOfThreads) {
  MemoryField made(33, 70);
  for (int light = 0; light < 21; ++light) made.Add(CodedPicture(light, 33, 70, 3));
  SetThreadCount(1);
  const ReflectanceFieldData one = made.Read({.reduce = 3});
  SetThreadCount(4);
  const ReflectanceFieldData four = made.Read({.reduce = 3});
  SetThreadCount(0);
  EXPECT_EQ(one.train.functions.values, four.train.functions.values);
}

TEST(FieldReading, FilesOfEveryKindBecomeLinear) {
  const ScratchFolder scratch;
  Image coded8(1, 1, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  Image linear16(1, 1, 3, PixelType::kUint16, ColorEncoding::kLinear);
  for (int c = 0; c < 3; ++c) {
    coded8.At<uint8_t>(0, 0, c) = static_cast<uint8_t>(100 + c);
    linear16.At<uint16_t>(0, 0, c) = static_cast<uint16_t>(5000 + c);
  }
  const Image linear = FloatPicture(1, 1, 3, [](int, int, int c) { return 2.5F + c; });
  WriteImage(coded8, scratch.folder / "a.png");
  WriteImage(linear16, scratch.folder / "b.png");
  WriteImage(linear, scratch.folder / "c.exr");
  WriteImage(linear, scratch.folder / "d.hdr");
  Capture capture;
  capture.folder = scratch.folder;
  capture.cameras["view"] = {1, 1, std::nullopt, std::nullopt};
  ReflectanceField field;
  field.camera = "view";
  field.encoding = ColorEncoding::kLinear;
  for (const char* file : {"a.png", "b.png", "c.exr", "d.hdr"}) {
    field.pictures.push_back({file, {0, 0, 1}, PhotoSplit::kTrain});
  }
  capture.reflectance_field = field;
  const ReflectanceFieldData data = ReadReflectanceField(capture, {}, SilentProgress());
  for (int c = 0; c < 3; ++c) {
    const float* row = data.train.functions.Row(c);
    EXPECT_NEAR(row[0], LinearFromSrgb(static_cast<float>(100 + c) / 255), 1e-6);
    EXPECT_NEAR(row[1], (5000 + c) / 65535.0, 1e-7);
    EXPECT_EQ(row[2], 2.5F + static_cast<float>(c));
    EXPECT_NEAR(row[3], 2.5 + c, 0.02);  // 8 bits of mantissa
  }
  capture.reflectance_field->encoding = ColorEncoding::kSrgb;
  const ReflectanceFieldData srgb = ReadReflectanceField(capture, {}, SilentProgress());
  EXPECT_NEAR(srgb.train.functions.Row(0)[1], LinearFromSrgb(5000.0F / 65535), 1e-6);
  std::filesystem::remove(scratch.folder / "b.png");
  ExpectErrorWith({"b.png"}, [&] { ReadReflectanceField(capture, {}, SilentProgress()); });
}

TEST(FieldReading, IntensitiesDivide) {
  MemoryField made(1, 1);
  made.Add(FloatPicture(1, 1, 3, [](int, int, int) { return 1.0F; })).intensity =
      Eigen::Vector3d(2, 4, 0.25);
  const ReflectanceFieldData rgb = made.Read();
  EXPECT_EQ(rgb.train.functions.Row(0)[0], 0.5F);
  EXPECT_EQ(rgb.train.functions.Row(1)[0], 0.25F);
  EXPECT_EQ(rgb.train.functions.Row(2)[0], 4.0F);
  MemoryField gray(1, 1);
  gray.Add(FloatPicture(1, 1, 1, [](int, int, int) { return 1.0F; })).intensity =
      Eigen::Vector3d(2, 4, 0.25);
  EXPECT_NEAR(gray.Read().train.functions.Row(0)[0], 1 / (0.2126 * 2 + 0.7152 * 4 + 0.0722 * 0.25),
              1e-6);
  for (const double bad : {0.0, -1.0, static_cast<double>(kNan), static_cast<double>(kInfinity)}) {
    made.capture.reflectance_field->pictures[0].intensity = Eigen::Vector3d(1, bad, 1);
    ExpectErrorWith({"0.exr", "intensity"}, [&] { made.Read(); });
  }
}

TEST(FieldReading, NegativeValuesBecomeZeroAndAreCounted) {
  MemoryField made(2, 1);
  made.Add(FloatPicture(2, 1, 1, [](int x, int, int) { return x == 0 ? -0.5F : 1.0F; }));
  made.Add(FloatPicture(2, 1, 1, [](int, int, int) { return -1e-30F; }), {1, 0, 0},
           PhotoSplit::kTest);
  NotedProgress progress;
  const ReflectanceFieldData data = made.Read({}, progress);
  EXPECT_EQ(data.train.functions.Row(0)[0], 0);
  EXPECT_EQ(data.train.functions.Row(1)[0], 1);
  EXPECT_EQ(data.held_out.functions.Row(1)[0], 0);
  EXPECT_NE(progress.notes().find("3 negative values"), std::string::npos) << progress.notes();
}

TEST(FieldReading, PixelsThatAreNotFiniteAreNamed) {
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    MemoryField made(4, 3);
    made.Add(CodedPicture(0, 4, 3, 3));
    made.Add(FloatPicture(
        4, 3, 3, [&](int x, int y, int c) { return x == 3 && y == 1 && c == 2 ? bad : 1.0F; }));
    ExpectErrorWith({"1.exr", "pixel (3, 1)", "mask"}, [&] { made.Read(); });
    EXPECT_NO_THROW(made.Read({.crop_width = 3}));
    ExpectErrorWith({"1.exr", "pixel (3, 1)"}, [&] { made.Read({.crop_left = 2, .crop_top = 1}); });
    // What a mask leaves out may be anything.
    made.capture.reflectance_field->mask = "mask";
    made.pictures["mask"] =
        FloatPicture(4, 3, 1, [](int x, int y, int) { return x == 3 && y == 1 ? 0.0F : 1.0F; });
    const ReflectanceFieldData data = made.Read();
    EXPECT_EQ(data.train.functions.Row(data.train.RowOf(7, 2))[1], 0);
    EXPECT_EQ(data.train.functions.Row(data.train.RowOf(6, 2))[1], 1);
  }
}

TEST(FieldReading, ExtremeSizesOfNumbersAreKept) {
  MemoryField made(2, 1);
  made.Add(FloatPicture(2, 1, 1, [](int x, int, int) { return x == 0 ? 3e38F : 1e-38F; }));
  const ReflectanceFieldData data = made.Read({.crop_width = 2});
  EXPECT_EQ(data.train.functions.Row(0)[0], 3e38F);
  EXPECT_EQ(data.train.functions.Row(1)[0], 1e-38F);
  made.capture.reflectance_field->pictures[0].intensity = Eigen::Vector3d(0.1, 0.1, 0.1);
  ExpectErrorWith({"0.exr", "pixel (0, 0)"}, [&] { made.Read(); });
}

TEST(FieldReading, OneLightOnePixelAndBlackFieldsAreRead) {
  MemoryField made(1, 1);
  made.Add(FloatPicture(1, 1, 1, [](int, int, int) { return 0.0F; }));
  NotedProgress progress;
  const ReflectanceFieldData data = made.Read({}, progress);
  EXPECT_EQ(data.train.functions.rows, 1);
  EXPECT_EQ(data.train.functions.columns, 1);
  EXPECT_EQ(data.held_out.functions.rows, 0);
  EXPECT_EQ(data.held_out.points, 1);
  EXPECT_TRUE(data.held_out.directions.empty());
  EXPECT_NE(progress.notes().find("every picture is black"), std::string::npos);
}

TEST(FieldReading, RepeatedAndLowLightsAreNotedAndKept) {
  MemoryField made(1, 1);
  const Image one = FloatPicture(1, 1, 1, [](int, int, int) { return 1.0F; });
  const Eigen::Vector3d d = Eigen::Vector3d(1, 2, -3).normalized();
  made.Add(one, d);
  made.Add(one, {0, 1, 0});
  made.Add(one, d);
  made.Add(one, {0, 0, 1});
  made.Add(one, d);
  NotedProgress progress;
  EXPECT_EQ(made.Read({}, progress).train.functions.columns, 5);
  EXPECT_NE(progress.notes().find("2 of 5 lights have the direction of another"), std::string::npos)
      << progress.notes();
  EXPECT_NE(progress.notes().find("3 of 5 lights lie below the horizon"), std::string::npos);
}

TEST(FieldReading, MatricesThatCannotBeHeldAreRefusedBeforePicturesAreRead) {
  MemoryField made(65536, 65536);
  for (int light = 0; light < 10000; ++light) {
    made.capture.reflectance_field->pictures.push_back({"none.exr", {0, 0, 1}, PhotoSplit::kTrain});
  }
  ExpectErrorWith({"made", "MiB", "field-reduce"}, [&] { made.Read(); });
}

TEST(FieldReading, WhatDoesNotFitTogetherIsNamed) {
  MemoryField made(2, 2);
  const Image gray = CodedPicture(0, 2, 2, 1);
  ExpectErrorWith({"memory", "no training picture"}, [&] { made.Read(); });
  made.Add(gray, {0, 0, 1}, PhotoSplit::kTest);
  ExpectErrorWith({"memory", "no training picture"}, [&] { made.Read(); });
  made.Add(gray);
  made.Add(CodedPicture(0, 2, 2, 3));
  ExpectErrorWith({"2.exr", "3 colour", "1.exr", "has 1"}, [&] { made.Read(); });
  made.pictures["2.exr"] = CodedPicture(0, 2, 3, 1);
  ExpectErrorWith({"2.exr", "2 x 3", "2 x 2"}, [&] { made.Read(); });
  made.pictures["2.exr"] = gray;
  made.pictures["0.exr"] = CodedPicture(0, 2, 2, 4);
  ExpectErrorWith({"0.exr", "3 colour"}, [&] { made.Read(); });
  made.pictures["0.exr"] = gray;
  EXPECT_NO_THROW(made.Read());
  for (const Eigen::Vector3d& bad :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, 1.1), Eigen::Vector3d(0, kNan, 1)}) {
    made.capture.reflectance_field->pictures[1].to_light = bad;
    ExpectErrorWith({"1.exr", "unit vector"}, [&] { made.Read(); });
  }
  made.capture.reflectance_field->camera = "other";
  ExpectErrorWith({"'other'"}, [&] { made.Read(); });
  made.capture.reflectance_field.reset();
  ExpectErrorWith({"no reflectance field"}, [&] { made.Read(); });
}

}  // namespace
}  // namespace lfm::testing
