// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/photo_detail.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "core/error.h"
#include "core/progress.h"
#include "mesh/decimation_target.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

const Eigen::Vector3d kCenter(0, 0, 30);

// Stripes of two rows each, four times as strong in the upper half: the central difference over two
// rows is half a stripe's height at every pixel.
Image Striped(int width, int height) {
  Image image(width, height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < height; ++y) {
    const uint8_t high = y < height / 2 ? 160 : 40;
    for (int x = 0; x < width; ++x) image.At<uint8_t>(x, y) = y / 2 % 2 == 0 ? 0 : high;
  }
  return image;
}

CalibResult LevelCameras() {
  CalibResult calib = test::MakeCalib(12, 300, 30);
  for (size_t i = 0; i < calib.photos.size(); ++i) {
    PosedImage& photo = calib.photos[i];
    const double turn = 2 * M_PI * static_cast<double>(i) / 12;
    photo.file = "photo" + std::to_string(i);
    photo.camera_from_world =
        LookAt(kCenter + 300 * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0), kCenter,
               Eigen::Vector3d::UnitZ());
  }
  calib.photos.back().split = PhotoSplit::kTest;
  return calib;
}

std::vector<double> Measure(const TriangleMesh& ball, const ImageLoader& load) {
  return MeasurePhotoDetail(ball, RayScene(ball), LevelCameras(), load, SilentProgress());
}

TEST(PhotoDetail, IsTheMeanGradientOverTheMedian) {
  const TriangleMesh ball = test::MakeSphere(30, 4, kCenter);
  std::set<std::string> opened;
  const std::vector<double> detail = Measure(ball, [&](const std::string& file) {
    opened.insert(file);
    return Striped(960, 720);
  });
  EXPECT_EQ(opened.size(), 11u);  // not the test photograph
  double upper = 0, lower = 0;
  for (size_t v = 0; v < detail.size(); ++v) {
    const double z = ball.vertices[v].z() - kCenter.z();
    if (z > 5 && z < 20) upper = std::max(upper, detail[v]);
    if (z < -5 && z > -20) lower = std::max(lower, detail[v]);
    if (z < -29.5) {
      EXPECT_EQ(detail[v], 1);  // nobody sees it
    }
  }
  for (size_t v = 0; v < detail.size(); ++v) {
    const double z = ball.vertices[v].z() - kCenter.z();
    if (z > 5 && z < 20) {
      EXPECT_NEAR(detail[v], upper, 1e-9);
    }
    if (z < -5 && z > -20) {
      EXPECT_NEAR(detail[v], lower, 1e-9);
    }
  }
  EXPECT_NEAR(upper, 4 * lower, 1e-9);
}

TEST(PhotoDetail, TrianglesStaySmallWhereThereIsMore) {
  const TriangleMesh ball = test::MakeSphere(30, 5, kCenter);
  std::vector<double> prices = Measure(ball, [](const std::string&) { return Striped(960, 720); });
  for (double& price : prices) price = 1 + 10 * price;
  const auto share_above = [](const TriangleMesh& mesh) {
    int above = 0;
    for (const Eigen::Vector3i& t : mesh.triangles) {
      above += mesh.vertices[t[0]].z() > kCenter.z();
    }
    return above / static_cast<double>(mesh.triangles.size());
  };
  EXPECT_NEAR(share_above(DecimateToCount(ball, 1000).mesh), 0.5, 0.03);
  const DecimatedMesh priced = DecimateToCount({ball, prices}, 1000);
  EXPECT_GT(share_above(priced.mesh), 0.58);
  EXPECT_TRUE(test::IsClosedManifold(priced.mesh));
}

TEST(PhotoDetail, Extremes) {
  const TriangleMesh ball = test::MakeSphere(30, 2, kCenter);
  for (const double detail : Measure(ball, [](const std::string&) {
         return Image(960, 720, 3, PixelType::kUint8, ColorEncoding::kSrgb);
       })) {
    EXPECT_EQ(detail, 1);  // one colour only
  }
  EXPECT_NE(test::ErrorOf([&] {
              Measure(ball, [](const std::string&) { return Striped(480, 360); });
            }).find("size"),
            std::string::npos);
  CalibResult unknown = LevelCameras();
  unknown.photos[0].camera = "another";
  EXPECT_NE(test::ErrorOf([&] {
              MeasurePhotoDetail(
                  ball, RayScene(ball), unknown,
                  [](const std::string&) { return Striped(960, 720); }, SilentProgress());
            }).find("another"),
            std::string::npos);
}

}  // namespace
}  // namespace lfm
