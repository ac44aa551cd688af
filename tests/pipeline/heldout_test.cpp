// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/heldout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace lfm {
namespace {

Image Flat(int width, int height, int channels, int level) {
  Image image(width, height, channels, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(image.Data<uint8_t>(), image.size(), static_cast<uint8_t>(level));
  return image;
}

CalibResult TwoTestPhotos() {
  CalibResult calib;
  for (const char* id : {"a", "train", "b"}) {
    PosedImage photo;
    photo.id = id;
    photo.file = photo.id + ".png";
    photo.split = std::string(id) == "train" ? PhotoSplit::kTrain : PhotoSplit::kTest;
    calib.photos.push_back(photo);
  }
  return calib;
}

PictureOf Always(const Image& image) {
  return [image](const PosedImage&) { return image; };
}

TEST(ScorePictures, PoolsSquaredErrorsOverForegroundPixels) {
  // Photograph a: 64 x 64 foreground pixels off by 2 levels; b: half as many, off by 8.
  const HeldoutPictures pictures{{Always(Flat(64, 64, 3, 100))}, [](const PosedImage& photo) {
                                   Image mask = Flat(64, 64, 1, 255);
                                   if (photo.id == "b")
                                     std::fill_n(mask.Data<uint8_t>(), mask.size() / 2, uint8_t{0});
                                   return mask;
                                 }};
  const PictureOf rendering = [](const PosedImage& photo) {
    return Flat(64, 64, 3, photo.id == "a" ? 102 : 108);
  };
  const HeldoutScores scores =
      ScorePictures(rendering, TwoTestPhotos(), pictures, SilentProgress()).at(0);
  ASSERT_EQ(scores.photos.size(), 2u);
  const double mse = (4.0 * 2 + 64.0) / 3;
  constexpr double kTolerance_abs = 1e-9;
  EXPECT_NEAR(scores.psnr_db, 10 * std::log10(255 * 255 / mse), kTolerance_abs);
  EXPECT_NEAR(scores.ape, (2.0 * 2 + 8) / 3, kTolerance_abs);
  const double mean_of_photos = 5 * (std::log10(255 * 255 / 4.0) + std::log10(255 * 255 / 64.0));
  EXPECT_NEAR(scores.psnr_mean_of_photos_db, mean_of_photos, kTolerance_abs);
}

TEST(ScorePictures, RendersOnceForEveryReference) {
  int rendered = 0;
  const PictureOf rendering = [&rendered](const PosedImage&) {
    ++rendered;
    return Flat(16, 16, 3, 100);
  };
  const HeldoutPictures pictures{{Always(Flat(16, 16, 3, 100)), Always(Flat(16, 16, 3, 104))},
                                 Always(Flat(16, 16, 1, 255))};
  const auto scores = ScorePictures(rendering, TwoTestPhotos(), pictures, SilentProgress());
  EXPECT_EQ(rendered, 2);
  ASSERT_EQ(scores.size(), 2u);
  EXPECT_EQ(scores[0].ape, 0);
  EXPECT_EQ(scores[1].ape, 4);
}

TEST(ScorePictures, WithoutTestPhotographsThereIsANoteAndNoFigure) {
  CalibResult calib = TwoTestPhotos();
  for (PosedImage& photo : calib.photos) photo.split = PhotoSplit::kTrain;
  const PictureOf flat = Always(Flat(16, 16, 3, 0));
  const auto scores = ScorePictures(flat, calib, {{flat}, flat}, SilentProgress());
  const nlohmann::json json = ScoresToJson(scores.at(0));
  EXPECT_EQ(json["photos_scored"], 0);
  EXPECT_EQ(json["photos_missing"], 0);
  EXPECT_FALSE(json.contains("heldout_psnr_db"));
  EXPECT_NE(json["note"].get<std::string>().find("\"split\": \"test\""), std::string::npos);
}

TEST(ScorePictures, APhotographWithoutForegroundIsSkippedAndListed) {
  const PictureOf flat = Always(Flat(16, 16, 3, 100));
  const PictureOf masks = [](const PosedImage& photo) {
    return Flat(16, 16, 1, photo.id == "a" ? 0 : 255);
  };
  const HeldoutScores scores =
      ScorePictures(flat, TwoTestPhotos(), {{flat}, masks}, SilentProgress()).at(0);
  ASSERT_EQ(scores.photos.size(), 1u);
  EXPECT_EQ(scores.photos[0].id, "b");
  EXPECT_EQ(scores.psnr_db, 99);
  ASSERT_EQ(scores.missing.size(), 1u);
  EXPECT_EQ(scores.missing[0].id, "a");
  EXPECT_NE(scores.missing[0].reason.find("a.png"), std::string::npos);
}

TEST(ScorePictures, AnErrorNamesPhotographAndFile) {
  const HeldoutPictures pictures{{Always(Flat(8, 16, 3, 100))}, Always(Flat(16, 16, 1, 255))};
  try {
    ScorePictures(Always(Flat(16, 16, 3, 100)), TwoTestPhotos(), pictures, SilentProgress());
    FAIL() << "no error";
  } catch (const Error& e) {
    for (const char* part : {"photograph 'a'", "a.png", "differ in size"}) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  }
}

TEST(AddUnposedPhotos, ListsTestPhotographsThatCalibrationRejected) {
  Capture capture;
  for (const char* id : {"a", "b", "lost", "train", "lost-train"}) {
    const bool is_train = std::string(id).find("train") != std::string::npos;
    capture.photos.push_back({id, std::string(id) + ".png", "camera",
                              is_train ? PhotoSplit::kTrain : PhotoSplit::kTest, std::nullopt, ""});
  }
  CalibResult calib = TwoTestPhotos();
  calib.rejected = {{"lost-train", "lost-train.png", "no tag"}, {"lost", "lost.png", "blurred"}};
  const PictureOf flat = Always(Flat(16, 16, 3, 100));
  HeldoutScores scores =
      ScorePictures(flat, calib, {{flat}, Always(Flat(16, 16, 1, 255))}, SilentProgress()).at(0);
  AddUnposedPhotos(capture, calib, scores);
  const nlohmann::json json = ScoresToJson(scores);
  EXPECT_EQ(json["photos_scored"], 2);
  EXPECT_EQ(json["photos_missing"], 1);
  EXPECT_EQ(json["missing"][0]["id"], "lost");
  EXPECT_NE(json["missing"][0]["reason"].get<std::string>().find("blurred"), std::string::npos);
  EXPECT_TRUE(json.contains("note"));
  EXPECT_EQ(json["heldout_psnr_db"], 99);
}

}  // namespace
}  // namespace lfm
