// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/film_recorder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

constexpr double kShare_abs = 1e-12;

/// A picture that no other number has.
Image Frame(int number) {
  Image image(7, 5, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (size_t i = 0; i < image.size(); ++i) {
    image.Data<uint8_t>()[i] = static_cast<uint8_t>(31 * number + 7 * i);
  }
  return image;
}

std::set<std::string> NamesIn(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

void Touch(const std::filesystem::path& file) { std::ofstream(file) << "x"; }

TEST(FilmRecorder, WritesAFrameOfEachCamera) {
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch.folder / "films" / "first";
  const std::vector<OrbitCamera> cameras = TurntablePath(OrbitCamera(), 12);
  FilmRecorder film(cameras, folder);
  EXPECT_FALSE(std::filesystem::exists(folder)) << "made with the first frame";
  for (int i = 0; i < 12; ++i) {
    ASSERT_FALSE(film.Done());
    EXPECT_NEAR(film.Share(), i / 12.0, kShare_abs);
    EXPECT_EQ(film.Camera().azimuth, cameras[i].azimuth);
    film.Record(Frame(i));
  }
  EXPECT_TRUE(film.Done());
  EXPECT_EQ(film.Share(), 1);
  EXPECT_EQ(film.Summary(), "12 frames in " + folder.string());
  const std::set<std::string> names = NamesIn(folder);
  EXPECT_EQ(names.size(), 12u);
  EXPECT_EQ(*names.begin(), "frame_0000.png");
  EXPECT_EQ(*names.rbegin(), "frame_0011.png");
  for (const int i : {0, 5, 11}) {
    const Image read = ReadImage(folder / *std::next(names.begin(), i));
    EXPECT_EQ(read.Bytes(), Frame(i).Bytes()) << i;
  }
}

TEST(FilmRecorder, NothingToRecordIsDone) {
  const FilmRecorder film;
  EXPECT_TRUE(film.Done());
  EXPECT_EQ(film.Share(), 1);
}

TEST(FilmRecorder, StoppingLeavesTheRestOut) {
  const ScratchFolder scratch;
  FilmRecorder film(TurntablePath(OrbitCamera(), 9), scratch.folder / "film");
  film.Record(Frame(0));
  film.Record(Frame(1));
  film.Stop();
  EXPECT_TRUE(film.Done());
  EXPECT_EQ(film.Share(), 1);
  EXPECT_EQ(film.Summary(), "2 frames in " + (scratch.folder / "film").string());
  EXPECT_EQ(NamesIn(scratch.folder / "film"),
            (std::set<std::string>{"frame_0000.png", "frame_0001.png"}));
}

TEST(FilmRecorder, StoppedBeforeItsFirstFrameItMakesNoFolder) {
  const ScratchFolder scratch;
  FilmRecorder film(TurntablePath(OrbitCamera(), 9), scratch.folder / "film");
  film.Stop();
  EXPECT_TRUE(film.Done());
  EXPECT_FALSE(std::filesystem::exists(scratch.folder / "film"));
}

TEST(FilmRecorder, WhatCannotBeWrittenIsNoFrame) {
  const ScratchFolder scratch;
  Touch(scratch.folder / "file");
  for (const char* folder : {"file", "file/film"}) {
    FilmRecorder film(TurntablePath(OrbitCamera(), 3), scratch.folder / folder);
    EXPECT_THROW(film.Record(Frame(0)), Error) << folder;
    EXPECT_FALSE(film.Done());
    EXPECT_EQ(film.Share(), 0);
    EXPECT_EQ(film.Summary().substr(0, 9), "0 frames ");
  }
  // A folder in a frame's place, after some frames.
  FilmRecorder film(TurntablePath(OrbitCamera(), 3), scratch.folder / "film");
  film.Record(Frame(0));
  std::filesystem::create_directories(scratch.folder / "film" / "frame_0001.png" / "full");
  EXPECT_THROW(film.Record(Frame(1)), Error);
  EXPECT_EQ(film.Summary().substr(0, 10), "1 frame in");
  EXPECT_EQ(ReadImage(scratch.folder / "film" / "frame_0000.png").Bytes(), Frame(0).Bytes());
}

TEST(FreeName, IsTheFirstThatIsFree) {
  const ScratchFolder scratch;
  const std::string prefix = (scratch.folder / "shot-").string();
  EXPECT_EQ(FreeName(prefix, ".png"), prefix + "0001.png");
  Touch(prefix + "0001.png");
  EXPECT_EQ(FreeName(prefix, ".png"), prefix + "0002.png");
  EXPECT_EQ(FreeName(prefix, ".json"), prefix + "0001.json") << "of that ending";
  std::filesystem::create_directory(prefix + "0002.png");  // folders are in the way, too
  Touch(prefix + "0004.png");
  EXPECT_EQ(FreeName(prefix, ".png"), prefix + "0003.png") << "gaps are filled";
  std::filesystem::create_directory(prefix + "0001");
  EXPECT_EQ(FreeName(prefix, ""), prefix + "0002");
}

TEST(FreeName, IsInTheCurrentFolder) {
  const std::filesystem::path name = FreeName("lfm-no-file-is-named-so-", ".png");
  EXPECT_EQ(name, "lfm-no-file-is-named-so-0001.png");
  EXPECT_FALSE(std::filesystem::exists(name)) << "a name is no file yet";
}

TEST(FreeName, FailsWhenAllAreTaken) {
  const ScratchFolder scratch;
  const std::string prefix = (scratch.folder / "a").string();
  const std::filesystem::path first = prefix + "0001";
  Touch(first);
  for (int i = 2; i <= 9999; ++i) {
    const std::string digits = std::to_string(i);
    std::filesystem::create_hard_link(first, prefix + std::string(4 - digits.size(), '0') + digits);
  }
  EXPECT_THROW(FreeName(prefix, ""), Error);
  std::filesystem::remove(prefix + "9999");
  EXPECT_EQ(FreeName(prefix, ""), prefix + "9999");
}

}  // namespace
}  // namespace lfm
