// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/exports.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "core/image.h"
#include "sample_data/camera_path.h"

namespace lfm {
namespace {

using V2 = Eigen::Vector2d;
using V3 = Eigen::Vector3d;
namespace fs = std::filesystem;

constexpr double kReprojection_abs_px = 1e-6;

class ExportsTest : public testing::Test {
 protected:
  ExportsTest() : root_(fs::temp_directory_path() / ("lfm_exports_" + std::to_string(getpid()))) {
    fs::create_directories(root_);
    capture_.folder = root_ / "capture";
    truth_.folder = capture_.folder / "ground_truth";
    Camera wide = MakePhotoCamera(64, 48);
    Camera plain = wide;
    plain.k3 = 0;
    plain.fx += 3;
    capture_.cameras["photo"] = capture_.cameras["phone"] = {64, 48, {}, {}};
    truth_.cameras["photo"] = {64, 48, wide, {}};
    truth_.cameras["phone"] = {64, 48, plain, {}};
    for (int i = 0; i < 4; ++i) {
      Photo photo;
      photo.id = "photo_" + std::to_string(i);
      photo.file = "photos/" + photo.id + ".jpg";
      photo.camera = i % 2 == 0 ? "photo" : "phone";
      photo.split = i == 3 ? PhotoSplit::kTest : PhotoSplit::kTrain;
      capture_.photos.push_back(photo);
      photo.file = "photos/" + photo.id + ".png";
      photo.mask = i == 2 ? "" : "masks/" + photo.id + ".png";
      photo.camera_from_world = LookAt(V3(150.0 - 90 * i, 40.0 * i - 170, 120.0 + 35 * i),
                                       V3(4, -3, 40 + i), V3(0.1 * i, 0.1, 1));
      truth_.photos.push_back(photo);
      if (photo.mask.empty()) continue;
      Image mask(64, 48, 1, PixelType::kUint8, ColorEncoding::kSrgb);
      mask.At<uint8_t>(10 + i, 7) = 255;
      WriteImage(mask, truth_.folder / photo.mask);
    }
  }
  ~ExportsTest() override {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }

  // Where the point is in the picture, by this project's conventions.
  V2 Expected(int photo, const V3& point) const {
    const Photo& p = truth_.photos[photo];
    return *Project(*truth_.cameras.at(p.camera).intrinsics, *p.camera_from_world * point);
  }

  const std::vector<V3> points_ = {V3(0, 0, 0), V3(30, -20, 55), V3(-25, 31, 90), V3(12, 40, 20)};
  fs::path root_;
  Capture capture_, truth_;
};

// Readers of the tests' own, after the formats' documentation.

V2 BrownPixel(double x, double y, double fx, double fy, double cx, double cy, double k1, double k2,
              double k3, double p1, double p2) {
  const double r2 = x * x + y * y;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double v = y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y);
  return {fx * u + cx, fy * v + cy};
}

struct ColmapCamera {
  std::string model;
  std::vector<double> params;
};

std::vector<std::string> DataLines(const fs::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] != '#') lines.push_back(line);
  }
  return lines;
}

std::map<int, ColmapCamera> ReadColmapCameras(const fs::path& file) {
  std::map<int, ColmapCamera> cameras;
  for (const std::string& line : DataLines(file)) {
    std::istringstream in(line);
    int id = 0, width = 0, height = 0;
    ColmapCamera camera;
    in >> id >> camera.model >> width >> height;
    EXPECT_EQ(width, 64);
    EXPECT_EQ(height, 48);
    for (double value; in >> value;) camera.params.push_back(value);
    EXPECT_TRUE(cameras.emplace(id, camera).second);
  }
  return cameras;
}

// COLMAP: (0, 0) is the corner of the first pixel, so that its centre is (0.5, 0.5).
V2 ColmapPixel(const ColmapCamera& camera, const V3& p) {
  const std::vector<double>& a = camera.params;
  const double x = p.x() / p.z(), y = p.y() / p.z();
  if (camera.model == "OPENCV") {
    EXPECT_EQ(a.size(), 8u);
    return BrownPixel(x, y, a[0], a[1], a[2], a[3], a[4], a[5], 0, a[6], a[7]);
  }
  EXPECT_EQ(camera.model, "FULL_OPENCV");
  EXPECT_EQ(a.size(), 12u);
  for (int i = 9; i < 12; ++i) EXPECT_EQ(a[i], 0);  // k4 k5 k6: the denominator is 1
  return BrownPixel(x, y, a[0], a[1], a[2], a[3], a[4], a[5], a[8], a[6], a[7]);
}

TEST_F(ExportsTest, PointsReprojectThroughTheColmapModel) {
  WriteColmapModel(capture_, truth_, root_ / "colmap");
  const std::map<int, ColmapCamera> cameras = ReadColmapCameras(root_ / "colmap" / "cameras.txt");
  EXPECT_EQ(cameras.size(), 2u);
  const std::vector<std::string> lines = DataLines(root_ / "colmap" / "images.txt");
  ASSERT_EQ(lines.size(), 8u);  // two an image
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(lines[2 * i + 1].empty());
    std::istringstream in(lines[2 * i]);
    int id = 0, camera = 0;
    double qw = 0, qx = 0, qy = 0, qz = 0;
    V3 t;
    std::string name;
    in >> id >> qw >> qx >> qy >> qz >> t.x() >> t.y() >> t.z() >> camera >> name;
    EXPECT_EQ(id, i + 1);
    EXPECT_EQ(name, "photos/photo_" + std::to_string(i) + ".jpg");
    EXPECT_EQ(cameras.at(camera).model, i % 2 == 0 ? "FULL_OPENCV" : "OPENCV");
    const Eigen::Matrix3d rotation = Eigen::Quaterniond(qw, qx, qy, qz).toRotationMatrix();
    for (const V3& point : points_) {
      const V2 pixel = ColmapPixel(cameras.at(camera), rotation * point + t);
      EXPECT_LT((pixel - V2(0.5, 0.5) - Expected(i, point)).norm(), kReprojection_abs_px);
    }
  }
  EXPECT_TRUE(DataLines(root_ / "colmap" / "points3D.txt").empty());
  EXPECT_EQ(DataLines(root_ / "colmap" / "train.txt").size(), 3u);
  EXPECT_EQ(DataLines(root_ / "colmap" / "test.txt"),
            std::vector<std::string>{"photos/photo_3.jpg"});
}

// nerfstudio and instant-ngp: OpenGL axes, camera to world, ray through pixel (x + 0.5, y + 0.5).
TEST_F(ExportsTest, PointsReprojectThroughTransformsJson) {
  const fs::path file = truth_.folder / "exports" / "nerf" / "transforms.json";
  WriteNerfTransforms(capture_, truth_, file);
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream);
  EXPECT_EQ(json.at("camera_model"), "OPENCV");
  // Millimetres survive: nothing was applied.
  EXPECT_EQ(json.at("applied_scale"), 1);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) EXPECT_EQ(json.at("applied_transform")[r][c], r == c ? 1 : 0);
  }
  ASSERT_EQ(json.at("frames").size(), 4u);
  for (int i = 0; i < 4; ++i) {
    const nlohmann::json& f = json.at("frames")[i];
    Eigen::Matrix4d world_from_gl;
    for (int r = 0; r < 4; ++r) {
      for (int c = 0; c < 4; ++c) world_from_gl(r, c) = f.at("transform_matrix")[r][c];
    }
    EXPECT_NEAR((world_from_gl.topLeftCorner<3, 3>().determinant()), 1, 1e-12);
    for (const V3& point : points_) {
      const Eigen::Vector4d gl = world_from_gl.inverse() * point.homogeneous();
      ASSERT_LT(gl.z(), 0);  // looks along -z
      const V2 pixel =
          BrownPixel(gl.x() / -gl.z(), -gl.y() / -gl.z(), f.at("fl_x"), f.at("fl_y"), f.at("cx"),
                     f.at("cy"), f.at("k1"), f.at("k2"), f.at("k3"), f.at("p1"), f.at("p2"));
      EXPECT_LT((pixel - V2(0.5, 0.5) - Expected(i, point)).norm(), kReprojection_abs_px);
    }
    const fs::path picture = file.parent_path() / std::string(f.at("file_path"));
    EXPECT_EQ(picture.lexically_normal(), (capture_.folder / capture_.photos[i].file));
    EXPECT_EQ(f.contains("mask_path"), i != 2);
    if (i != 2) {
      EXPECT_TRUE(fs::exists(file.parent_path() / std::string(f.at("mask_path"))));
    }
  }
  EXPECT_EQ(json.at("train_filenames").size(), 3u);
  EXPECT_EQ(json.at("test_filenames")[0], json.at("frames")[3].at("file_path"));
  // instant-ngp's cube: p scale + offset.
  const V3 top = V3(0, 0, 150) * double(json.at("scale"));
  EXPECT_NEAR(top.z() + double(json.at("offset")[2]), 0.8, 1e-12);
}

TEST_F(ExportsTest, MasksHaveTheNamesThatToolsLookFor) {
  WriteToolMasks(capture_, truth_, root_ / "masks");
  const Image colmap = ReadImage(root_ / "masks/colmap/photos/photo_1.jpg.png");
  const Image ngp = ReadImage(root_ / "masks/instant-ngp/dynamic_mask_photo_1.png");
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool object = x == 11 && y == 7;
      ASSERT_EQ(colmap.At<uint8_t>(x, y), object ? 255 : 0);
      ASSERT_EQ(ngp.At<uint8_t>(x, y), object ? 0 : 255);
    }
  }
  EXPECT_FALSE(fs::exists(root_ / "masks/colmap/photos/photo_2.jpg.png"));
}

struct ReadLights {
  std::vector<std::string> files;
  std::vector<V3> directions;
};

ReadLights ReadLp(const fs::path& file) {
  std::ifstream in(file);
  size_t count = 0;
  in >> count;
  ReadLights lights;
  std::string name;
  for (V3 d; in >> name >> d.x() >> d.y() >> d.z();) {
    lights.files.push_back(name);
    lights.directions.push_back(d);
  }
  EXPECT_EQ(lights.files.size(), count);
  return lights;
}

TEST_F(ExportsTest, LightPositionsRoundTrip) {
  std::vector<LightPosition> lights;
  for (int i = 0; i < 50; ++i) {
    lights.push_back({"lit_" + std::to_string(i) + ".png",
                      V3(std::cos(i), std::sin(i), 0.1 + 0.05 * i).normalized()});
  }
  WriteLightPositions(lights, root_ / "lights.lp");
  const ReadLights read = ReadLp(root_ / "lights.lp");
  ASSERT_EQ(read.files.size(), 50u);
  for (size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(read.files[i], lights[i].file);
    EXPECT_EQ(read.directions[i], lights[i].to_light);
  }
}

TEST_F(ExportsTest, FieldLightsAreInThePicturesFrame) {
  ReflectanceField field;
  field.camera = "photo";
  // Looks down the world's y axis: right is x, up is z, to the viewer is -y.
  field.camera_from_world = LookAt(V3(0, -500, 0), V3(0, 0, 0), V3(0, 0, 1));
  field.pictures = {{"lit/a.png", V3(1, 0, 0), PhotoSplit::kTrain},
                    {"lit/b.png", V3(0, 0, 1), PhotoSplit::kTrain},
                    {"lit/c.png", V3(0, -1, 0), PhotoSplit::kTrain},
                    {"lit/d.png", V3(0, 1, 0), PhotoSplit::kTest}};
  capture_.reflectance_field = field;
  WriteExports(capture_, truth_);
  const fs::path folder = truth_.folder / "exports" / "rti";
  const ReadLights read = ReadLp(folder / "lights.lp");
  ASSERT_EQ(read.files.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((read.directions[i] - V3::Unit(i)).norm(), 1e-12) << i;
    EXPECT_EQ((folder / read.files[i]).lexically_normal(),
              capture_.folder / field.pictures[i].file);
  }
  EXPECT_TRUE(fs::exists(truth_.folder / "exports/colmap/cameras.txt"));
  EXPECT_TRUE(fs::exists(truth_.folder / "exports/masks/colmap/photos/photo_0.jpg.png"));
}

TEST_F(ExportsTest, WhatCannotBeExportedIsAnError) {
  EXPECT_THROW(WriteLightPositions({}, root_ / "x.lp"), Error);
  EXPECT_THROW(WriteLightPositions({{"a b.png", V3(0, 0, 1)}}, root_ / "x.lp"), Error);
  EXPECT_THROW(WriteLightPositions({{"", V3(0, 0, 1)}}, root_ / "x.lp"), Error);
  EXPECT_THROW(WriteLightPositions({{"a.png", V3(0, 0, 2)}}, root_ / "x.lp"), Error);
  EXPECT_THROW(WriteLightPositions({{"a.png", V3(0, 0, std::nan(""))}}, root_ / "x.lp"), Error);
  EXPECT_FALSE(fs::exists(root_ / "x.lp"));
  EXPECT_THROW(FieldLightPositions(capture_, root_), Error);
  Capture unposed = truth_;
  unposed.photos[1].camera_from_world.reset();
  EXPECT_THROW(WriteColmapModel(capture_, unposed, root_ / "c"), Error);
  unposed = truth_;
  unposed.cameras["phone"].intrinsics.reset();
  EXPECT_THROW(WriteNerfTransforms(capture_, unposed, root_ / "t.json"), Error);
  unposed = truth_;
  unposed.photos.pop_back();
  EXPECT_THROW(WriteNerfTransforms(capture_, unposed, root_ / "t.json"), Error);
  capture_.photos[0].file = "photos/my photo.jpg";
  EXPECT_THROW(WriteColmapModel(capture_, truth_, root_ / "c"), Error);
}

}  // namespace
}  // namespace lfm
