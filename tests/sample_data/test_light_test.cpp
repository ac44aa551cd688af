// SPDX-License-Identifier: BSD-3-Clause
// --test-light: held-out photographs of more paths.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "core/error.h"
#include "sample_data/studio.h"

namespace lfm {
namespace {

class TestLight : public testing::Test {
 protected:
  // Photographs and their noise-free pictures, by file.
  std::map<std::string, Image> PicturesWith(int test_light) {
    StudioOptions options;
    options.scene = "matte";
    options.tiny = true;
    options.photos = 3;
    options.test_photos = 1;
    options.photo_width = 80;
    options.photo_height = 60;
    options.scans = options.placements = 0;
    options.test_light = test_light;
    std::map<std::string, Image> pictures;
    std::mutex mutex;
    capture_ = RenderStudio(
                   options,
                   [&](const std::string& file, const Image& picture) {
                     const std::lock_guard lock(mutex);
                     pictures.emplace(file, picture);
                   },
                   SilentProgress())
                   .capture;
    return pictures;
  }
  Capture capture_;
};

double SquaredDifference(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double difference = a.Data<uint8_t>()[i] - b.Data<uint8_t>()[i];
    sum += difference * difference;
  }
  return sum;
}

TEST_F(TestLight, BringsHeldOutPhotographsNearerToTheLimitAndNoOthers) {
  const auto usual = PicturesWith(1), more = PicturesWith(8), most = PicturesWith(128);
  int held_out = 0;
  for (const Photo& photo : capture_.photos) {
    if (photo.split != PhotoSplit::kTest) {
      EXPECT_EQ(more.at(photo.file).Bytes(), usual.at(photo.file).Bytes()) << photo.id;
      continue;
    }
    ++held_out;
    for (const std::string& file : {"ground_truth/photos/" + photo.id + ".png", photo.file}) {
      const double before = SquaredDifference(usual.at(file), most.at(file));
      EXPECT_GT(before, 0);
      EXPECT_LT(2 * SquaredDifference(more.at(file), most.at(file)), before) << file;
    }
  }
  EXPECT_EQ(held_out, 1);
}

TEST(TestLightRefusals, WhereNoPathsAreTraced) {
  StudioOptions options;
  options.tiny = true;
  options.test_light = 2;
  const auto nothing = [](const std::string&, const Image&) {};
  EXPECT_THROW(RenderStudio(options, nothing, SilentProgress()), Error);
  options.scene = "knight";
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "lfm_test_light";
  EXPECT_THROW(MakeCapture(options, folder, SilentProgress()), Error);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lfm
