// SPDX-License-Identifier: BSD-3-Clause
#include "calib/camera_groups.h"

#include <gtest/gtest.h>

namespace lfm {
namespace {

struct Shot {
  const char* make;
  double focal_mm;
  int width, height;
};

CameraGroups Group(const std::vector<Shot>& shots, Capture capture = {}) {
  if (capture.cameras.empty()) capture.cameras["photo"] = {640, 480, {}};
  std::vector<CalibPicture> pictures;
  for (size_t i = 0; i < shots.size(); ++i) {
    CalibPicture picture;
    picture.id = picture.file = std::to_string(i);
    picture.camera = "photo";
    picture.width = shots[i].width, picture.height = shots[i].height;
    pictures.push_back(picture);
  }
  return GroupByExif(pictures, capture, [&](const std::string& file) -> std::optional<ExifCamera> {
    const Shot& shot = shots[static_cast<size_t>(std::stoi(file))];
    if (!shot.make) return std::nullopt;
    return ExifCamera{shot.make, "X", shot.focal_mm};
  });
}

constexpr Shot kPhone{"Phone", 4.2, 640, 480}, kDslr{"Dslr", 50, 640, 480};
constexpr Shot kWide{"Dslr", 24, 640, 480}, kLarge{"Dslr", 50, 800, 600};
constexpr Shot kSilent{nullptr, 0, 640, 480}, kSilentLarge{nullptr, 0, 800, 600};

TEST(GroupByExif, OneCameraOrNoExifStaysOne) {
  for (const Shot& shot : {kPhone, kSilent}) {
    const CameraGroups groups = Group({shot, shot, shot, shot});
    EXPECT_EQ(groups.cameras.size(), 1u);
    for (const CalibPicture& p : groups.pictures) EXPECT_EQ(p.camera, "photo");
  }
}

TEST(GroupByExif, PartsByMakeFocalLengthAndSize) {
  const CameraGroups groups =
      Group({kDslr, kPhone, kPhone, kPhone, kPhone, kDslr, kDslr, kLarge, kLarge, kLarge, kSilent});
  ASSERT_EQ(groups.cameras.size(), 3u);
  EXPECT_EQ(groups.pictures[1].camera, "photo");
  EXPECT_EQ(groups.pictures[10].camera, "photo");
  EXPECT_EQ(groups.pictures[0].camera, "photo-2");
  EXPECT_EQ(groups.pictures[7].camera, "photo-3");
  EXPECT_EQ(groups.cameras.at("photo-3").width, 800);
  for (const CalibPicture& p : groups.pictures) EXPECT_TRUE(p.InUse()) << p.rejected;
}

TEST(GroupByExif, TooFewOfACameraAreSetAsideWithTheReason) {
  const CameraGroups groups = Group({kPhone, kPhone, kPhone, kWide, kWide, kSilentLarge});
  EXPECT_EQ(groups.cameras.size(), 1u);
  EXPECT_NE(groups.pictures[3].rejected.find("Dslr X, 24 mm"), std::string::npos);
  EXPECT_NE(groups.pictures[5].rejected.find("800x600"), std::string::npos);
  EXPECT_TRUE(groups.pictures[0].InUse());
}

TEST(GroupByExif, GivenIntrinsicsAreTheManifestsWord) {
  Capture capture;
  capture.cameras["photo"] = {640, 480, Camera{640, 480, 500, 500, 320, 240}};
  const CameraGroups groups = Group({kPhone, kDslr, kDslr, kDslr}, capture);
  EXPECT_EQ(groups.cameras.size(), 1u);
  for (const CalibPicture& p : groups.pictures) EXPECT_EQ(p.camera, "photo");
}

}  // namespace
}  // namespace lfm
