// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/photographs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>

#include "calib/calib_files.h"
#include "core/capture.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

/// Sizes that no factor divides, a principal point off the middle: half a pixel cannot hide.
Camera Pinhole() {
  Camera camera;
  camera.width = 121;
  camera.height = 91;
  camera.fx = 150;
  camera.fy = 142;
  camera.cx = 57.3;
  camera.cy = 47.8;
  return camera;
}

Camera Lens() {
  Camera camera = Pinhole();
  camera.k1 = -0.21;
  camera.k2 = 0.05;
  camera.p1 = 0.004;
  camera.p2 = -0.003;
  return camera;
}

Camera WithRadialTerm(double k1) {
  Camera camera = Pinhole();
  camera.k1 = k1;
  return camera;
}

/// (X/Z, Y/Z) through a pixel of a camera without distortion.
Eigen::Vector2d Normalized(const Camera& pinhole, double x, double y) {
  return {(x - pinhole.cx) / pinhole.fx, (y - pinhole.cy) / pinhole.fy};
}

void ExpectError(const std::function<void()>& body, const std::string& part) {
  try {
    body();
    ADD_FAILURE() << "no Error; expected one with '" << part << "'";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

/// A capture of one photograph, "p".
class ReadPinholePictureTest : public testing::Test {
 protected:
  PinholePicture Read(const Image& picture, const Camera& lens, int max_side,
                      std::optional<ColorEncoding> encoding = std::nullopt) {
    Capture capture;
    capture.folder = scratch_.folder;
    capture.cameras["hand"] = {lens.width, lens.height, std::nullopt, encoding};
    capture.photos = {{"p", "photos/p.png", "hand", PhotoSplit::kTrain, std::nullopt, ""}};
    SaveCapture(capture);
    fs::create_directories(scratch_.folder / "photos");
    WriteImage(picture, scratch_.folder / "photos/p.png");
    return ReadPinholePicture({"p", "photos/p.png", {lens, {}}, false}, scratch_.folder, max_side);
  }

  const ScratchFolder scratch_;
};

constexpr std::array<double, 3> kPhase = {0.3, 1.7, 4};

/// What is seen in a direction, linear; steep, for a pixel's step to be some levels.
double Waves(const Eigen::Vector2d& at, int channel) {
  return 0.5 + 0.35 * std::sin(8 * at.x() + kPhase[channel]) * std::cos(7 * at.y() - 1);
}

/// The mean of neighbours is what lies between them.
double Slopes(const Eigen::Vector2d& at, int channel) {
  return 0.5 + (channel == 0 ? 0.6 : -0.5) * at.x() + (channel == 1 ? 0.6 : 0.4) * at.y();
}

/// 16 bits, linear, as the lens takes it.
Image TakePhotograph(const Camera& lens, double (*seen)(const Eigen::Vector2d&, int)) {
  Image picture(lens.width, lens.height, 3, PixelType::kUint16, ColorEncoding::kLinear);
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x) {
      const Eigen::Vector3d ray = Unproject(lens, {x, static_cast<double>(y)});
      for (int c = 0; c < 3; ++c) {
        const double value = seen(ray.head<2>() / ray.z(), c);
        picture.At<uint16_t>(x, y, c) = static_cast<uint16_t>(std::lround(65535 * value));
      }
    }
  }
  return picture;
}

/// Every seen pixel shows what its direction has; returns how many are.
int ExpectShows(const PinholePicture& picture, double (*seen)(const Eigen::Vector2d&, int)) {
  // Rounding to levels, and what bilinear interpolation loses of a curve.
  constexpr double kLevels_abs = 0.5 + 0.15;
  EXPECT_FALSE(picture.camera.HasDistortion());
  EXPECT_EQ(picture.color.width(), picture.camera.width);
  EXPECT_EQ(picture.color.height(), picture.camera.height);
  int pixels = 0;
  for (int y = 0; y < picture.camera.height; ++y) {
    for (int x = 0; x < picture.camera.width; ++x) {
      if (picture.seen.At<uint8_t>(x, y) == 0) continue;
      ++pixels;
      for (int c = 0; c < 3; ++c) {
        const double linear = seen(Normalized(picture.camera, x, y), c);
        EXPECT_NEAR(picture.color.At<uint8_t>(x, y, c),
                    255 * SrgbFromLinear(static_cast<float>(linear)), kLevels_abs)
            << x << " " << y << " " << c;
      }
    }
  }
  return pixels;
}

TEST_F(ReadPinholePictureTest, ShowsEachDirectionWhereAPinholeHasIt) {
  const Camera lens = Lens();
  const PinholePicture picture =
      Read(TakePhotograph(lens, Waves), lens, 4000, ColorEncoding::kLinear);
  for (double Camera::*same : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy}) {
    EXPECT_EQ(picture.camera.*same, lens.*same);
  }
  // A barrel lens shows more than the pinhole does.
  EXPECT_EQ(ExpectShows(picture, Waves), lens.width * lens.height);
}

TEST_F(ReadPinholePictureTest, ShrinksByTheLeastWholeFactorAndKeepsDirections) {
  struct Case {
    int max_side, factor;
  };
  for (const Camera& lens : {Pinhole(), Lens()}) {
    const Image photograph = TakePhotograph(lens, Slopes);
    for (const Case& c : {Case{121, 1}, {120, 2}, {60, 2}, {59, 3}, {30, 4}, {29, 5}, {2, 41}}) {
      const PinholePicture picture = Read(photograph, lens, c.max_side, ColorEncoding::kLinear);
      EXPECT_EQ(picture.camera.width, lens.width / c.factor) << c.max_side;
      EXPECT_EQ(picture.camera.height, lens.height / c.factor) << c.max_side;
      EXPECT_EQ(ExpectShows(picture, Slopes), picture.camera.width * picture.camera.height);
      // Block (0, 0) has its centre at pixel ((f - 1) / 2, (f - 1) / 2).
      const double middle = 0.5 * (c.factor - 1);
      constexpr double kRounding_abs = 1e-12;
      EXPECT_LT((Normalized(picture.camera, 0, 0) - Normalized(lens, middle, middle)).norm(),
                kRounding_abs);
      EXPECT_LT((Normalized(picture.camera, 3, 2) -
                 Normalized(lens, middle + 3 * c.factor, middle + 2 * c.factor))
                    .norm(),
                kRounding_abs);
    }
  }
}

TEST_F(ReadPinholePictureTest, AveragesBlocksInLinearLight) {
  Camera camera = Pinhole();
  camera.width = 5;
  camera.height = 4;
  Image picture(5, 4, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  // The fifth column belongs to no block.
  for (int y = 0; y < 4; ++y) picture.At<uint8_t>(4, y, 0) = 255;
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 1}, {2, 2}}) picture.At<uint8_t>(x, y, 1) = 255;
  const PinholePicture small = Read(picture, camera, 3);
  ASSERT_EQ(small.camera.width, 2);
  ASSERT_EQ(small.camera.height, 2);
  // sRGB codes of a half and a quarter.
  EXPECT_EQ(small.color.At<uint8_t>(0, 0, 1), 188);
  EXPECT_EQ(small.color.At<uint8_t>(1, 1, 1), 137);
  EXPECT_EQ(small.color.At<uint8_t>(1, 0, 0), 0);
}

TEST_F(ReadPinholePictureTest, WithoutDistortionTheBytesStay) {
  struct Case {
    int channels;
    PixelType type;
    std::optional<ColorEncoding> encoding;
  };
  std::mt19937 random(5);
  for (const Case& c : {Case{3, PixelType::kUint8, std::nullopt},
                        {1, PixelType::kUint8, std::nullopt},
                        {2, PixelType::kUint8, std::nullopt},
                        {4, PixelType::kUint8, std::nullopt},
                        {3, PixelType::kUint16, ColorEncoding::kSrgb},
                        {3, PixelType::kUint16, ColorEncoding::kLinear}}) {
    Image picture(121, 91, c.channels, c.type, c.encoding.value_or(ColorEncoding::kSrgb));
    for (size_t i = 0; i < picture.size(); ++i) {
      if (c.type == PixelType::kUint8) {
        picture.Data<uint8_t>()[i] = static_cast<uint8_t>(random());
      } else {
        picture.Data<uint16_t>()[i] = static_cast<uint16_t>(random());
      }
    }
    const PinholePicture read = Read(picture, Pinhole(), 121, c.encoding);
    EXPECT_TRUE(read.color.Bytes() == ToRgb8(picture).Bytes()) << c.channels;
    for (size_t i = 0; i < read.seen.size(); ++i) EXPECT_EQ(read.seen.Data<uint8_t>()[i], 255);
    if (c.type != PixelType::kUint8) continue;
    // A lens that moves nothing by more than rounding does not change them either.
    const PinholePicture resampled = Read(picture, WithRadialTerm(1e-13), 121);
    EXPECT_TRUE(resampled.color.Bytes() == read.color.Bytes()) << c.channels;
  }
}

/// Radii r are moved to r (1 + k1 r^2): a cushion off the sensor, a strong barrel back over itself.
bool IsSeen(const Camera& lens, int x, int y) {
  const Eigen::Vector2d at = Normalized(lens, x, y);
  const double r2 = at.squaredNorm(), scale = 1 + lens.k1 * r2;
  if (!(1 + 3 * lens.k1 * r2 > 0)) return false;
  const double u = lens.fx * scale * at.x() + lens.cx, v = lens.fy * scale * at.y() + lens.cy;
  return u >= -0.5 && v >= -0.5 && u < lens.width - 0.5 && v < lens.height - 0.5;
}

TEST_F(ReadPinholePictureTest, SaysWhatThePhotographDoesNotShow) {
  for (const double k1 : {0.4, -1.8}) {
    const Camera lens = WithRadialTerm(k1);
    Image white(lens.width, lens.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
    std::fill_n(white.Data<uint8_t>(), white.size(), uint8_t{255});
    for (const int factor : {1, 3}) {
      const PinholePicture picture = Read(white, lens, lens.width / factor);
      ASSERT_EQ(picture.seen.width(), lens.width / factor);
      ASSERT_EQ(picture.seen.channels(), 1);
      int unseen = 0;
      for (int y = 0; y < picture.seen.height(); ++y) {
        for (int x = 0; x < picture.seen.width(); ++x) {
          bool seen = true;
          for (int i = 0; i < factor * factor; ++i) {
            seen &= IsSeen(lens, factor * x + i % factor, factor * y + i / factor);
          }
          const int expected = seen ? 255 : 0;
          unseen += seen ? 0 : 1;
          EXPECT_EQ(picture.seen.At<uint8_t>(x, y), expected) << k1 << " " << x << " " << y;
          EXPECT_EQ(picture.color.At<uint8_t>(x, y, 1), expected) << k1 << " " << x << " " << y;
        }
      }
      const int pixels = picture.seen.width() * picture.seen.height();
      EXPECT_GT(unseen, pixels / 50) << k1;
      EXPECT_LT(unseen, pixels / 2) << k1;
    }
  }
}

TEST_F(ReadPinholePictureTest, RefusesWhatIsNotThePhotograph) {
  const Image picture(121, 91, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  ASSERT_EQ(Read(picture, Lens(), 121).camera.width, 121);
  const auto read = [&](const char* file, const Camera& lens, int max_side) {
    ReadPinholePicture({"p", file, {lens, {}}, false}, scratch_.folder, max_side);
  };
  ExpectError([&] { read("photos/absent.png", Lens(), 121); }, "photos/absent.png");
  ExpectError([&] { read("../p.png", Lens(), 121); }, "../p.png");
  ExpectError([&] { read("photos/p.png", Lens(), 0); }, "1 pixel");
  Camera other = Lens();
  other.height = 90;
  ExpectError([&] { read("photos/p.png", other, 121); }, "photos/p.png: is 121 x 91");
  const Image deep(121, 91, 3, PixelType::kUint16, ColorEncoding::kLinear);
  ExpectError([&] { Read(deep, Lens(), 121); }, "photos/p.png");
  fs::remove(scratch_.folder / "capture.json");
  ExpectError([&] { read("photos/p.png", Lens(), 121); }, "capture.json");
}

class FindPhotographsTest : public testing::Test {
 protected:
  FindPhotographsTest() {
    Capture capture;
    capture.folder = capture_;
    fs::create_directories(capture_);
    capture.cameras["hand"] = {121, 91, std::nullopt, std::nullopt};
    for (const char* id : {"late", "early", "unposed"}) {
      const auto split = id == std::string("early") ? PhotoSplit::kTest : PhotoSplit::kTrain;
      capture.photos.push_back(
          {id, std::string("photos/") + id + ".jpg", "hand", split, std::nullopt, ""});
    }
    SaveCapture(capture);
  }

  void SaveWork(const std::vector<std::string>& ids) {
    CalibResult calib;
    calib.cameras["hand"] = Lens();
    for (const std::string& id : ids) {
      PosedImage image;
      image.id = id;
      image.camera = "hand";
      image.file = "elsewhere.png";
      image.camera_from_world.translation = {static_cast<double>(id.size()), 2, 3};
      calib.photos.push_back(image);
    }
    SaveCalib(calib, work_ / "calib");
  }

  const ScratchFolder scratch_;
  const fs::path capture_ = scratch_.folder / "capture", work_ = scratch_.folder / "work";
};

TEST_F(FindPhotographsTest, ListsThoseWithAPoseByTheirIds) {
  SaveWork({"late", "stranger", "early"});
  const std::vector<PosedPhotograph> found = FindPhotographs(work_, capture_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].id + " " + found[1].id, "early late");
  EXPECT_TRUE(found[0].held_out && !found[1].held_out);
  EXPECT_EQ(found[0].file, "photos/early.jpg");
  EXPECT_EQ(found[0].camera.camera.k1, Lens().k1);
  EXPECT_EQ(found[0].camera.camera_from_world.translation, Eigen::Vector3d(5, 2, 3));
  EXPECT_EQ(found[1].camera.camera_from_world.translation, Eigen::Vector3d(4, 2, 3));
}

TEST_F(FindPhotographsTest, RefusesFoldersThatDoNotGoTogether) {
  ExpectError([&] { FindPhotographs(work_, capture_); }, "work/calib");
  SaveWork({"stranger"});
  ExpectError([&] { FindPhotographs(work_, capture_); }, "poses.json");
  SaveWork({"late"});
  ExpectError([&] { FindPhotographs(work_, scratch_.folder / "absent"); }, "absent/capture.json");
  EXPECT_EQ(FindPhotographs(work_, capture_).size(), 1u);
}

Image Filled(int channels, const std::array<uint8_t, 3>& value) {
  Image image(4, 3, channels, PixelType::kUint8, ColorEncoding::kSrgb);
  for (size_t i = 0; i < image.size(); ++i) image.Data<uint8_t>()[i] = value[i % channels];
  return image;
}

PinholePicture Gray() { return {Filled(3, {100, 100, 100}), Filled(1, {255}), {}}; }

TEST(ComparePhotograph, MeasuresWhereBothAreSeen) {
  PinholePicture photograph = Gray();
  Image rendering = Filled(3, {110, 96, 100}), coverage = Filled(1, {255});
  // Three pixels that differ wholly, and do not count.
  photograph.seen.At<uint8_t>(1, 0) = 254;
  coverage.At<uint8_t>(3, 2) = 254;
  photograph.seen.At<uint8_t>(0, 1) = coverage.At<uint8_t>(0, 1) = 0;
  for (const auto& [x, y] : {std::pair{1, 0}, {3, 2}, {0, 1}}) {
    for (int c = 0; c < 3; ++c) rendering.At<uint8_t>(x, y, c) = 255;
  }
  const PhotographDifference result = ComparePhotograph(photograph, rendering, coverage, 12);
  EXPECT_EQ(result.pixels, 9);
  EXPECT_NEAR(result.psnr_db, 10 * std::log10(255.0 * 255 * 3 / (100 + 16)), 1e-9);
  EXPECT_NEAR(result.ape, 14.0 / 3, 1e-12);
  const auto at = [&](int x, int y) {
    const uint8_t* rgb = &result.picture.At<uint8_t>(x, y);
    return std::array<int, 3>{rgb[0], rgb[1], rgb[2]};
  };
  EXPECT_EQ(at(0, 0), (std::array<int, 3>{120, 48, 0}));
  EXPECT_EQ(at(2, 2), (std::array<int, 3>{120, 48, 0}));
  for (const auto& [x, y] : {std::pair{1, 0}, {3, 2}, {0, 1}}) {
    EXPECT_EQ(at(x, y), (std::array<int, 3>{0, 0, 0}));
  }
}

TEST(ComparePhotograph, HoldsItsExtremes) {
  const PinholePicture photograph = Gray();
  const Image all = Filled(1, {255});
  const PhotographDifference same = ComparePhotograph(photograph, photograph.color, all, 1);
  EXPECT_EQ(same.psnr_db, 99);
  EXPECT_EQ(same.ape, 0);
  EXPECT_EQ(same.pixels, 12);
  const PhotographDifference none =
      ComparePhotograph(photograph, Filled(3, {0, 0, 0}), Filled(1, {254}), 1);
  EXPECT_EQ(none.pixels, 0);
  EXPECT_EQ(none.psnr_db, 0);
  EXPECT_EQ(none.ape, 0);
  // A large gain stops at white.
  const PhotographDifference most =
      ComparePhotograph(photograph, Filled(3, {101, 100, 0}), all, 2147483647);
  EXPECT_EQ(most.picture.At<uint8_t>(3, 1, 0), 255);
  EXPECT_EQ(most.picture.At<uint8_t>(3, 1, 1), 0);
  EXPECT_EQ(most.picture.At<uint8_t>(3, 1, 2), 255);
}

TEST(ComparePhotograph, RefusesPicturesThatDoNotFit) {
  const PinholePicture photograph = Gray();
  const Image rgb = photograph.color, all = photograph.seen;
  const Image wide(5, 3, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const Image high(4, 4, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  ExpectError([&] { ComparePhotograph(photograph, wide, all, 1); }, "rendering");
  ExpectError([&] { ComparePhotograph(photograph, all, all, 1); }, "rendering");
  ExpectError([&] { ComparePhotograph(photograph, ToLinearFloat(rgb), all, 1); }, "rendering");
  ExpectError([&] { ComparePhotograph(photograph, rgb, high, 1); }, "coverage");
  ExpectError([&] { ComparePhotograph(photograph, rgb, rgb, 1); }, "coverage");
  ExpectError([&] { ComparePhotograph(photograph, rgb, all, 0); }, "gain");
}

}  // namespace
}  // namespace lfm
