// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/pixel_footprint.h"

#include <gtest/gtest.h>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

double Footprint(const TriangleMesh& mesh, const CalibResult& calib) {
  return MedianPixelFootprint(mesh, RayScene(mesh), calib);
}

TEST(PixelFootprint, SmallSphereFromAfar) {
  const TriangleMesh sphere = test::MakeSphere(2, 3, {0, 0, 50});
  EXPECT_NEAR(Footprint(sphere, test::MakeCalib(20, 400, 50)), 399.0 / 1700, 1.0 / 1700);
}

TEST(PixelFootprint, OnlySeenSurfaceCounts) {
  // Of a small sphere inside a large one nothing is seen.
  TriangleMesh nested = test::MakeSphere(40, 4);
  const TriangleMesh inner = test::MakeSphere(39, 4);
  const Eigen::Vector3i offset =
      Eigen::Vector3i::Constant(static_cast<int>(nested.vertices.size()));
  for (const auto& v : inner.vertices) nested.vertices.push_back(v);
  for (const auto& t : inner.triangles) nested.triangles.push_back(t + offset);
  const CalibResult calib = test::MakeCalib(30, 300, 0);
  EXPECT_NEAR(Footprint(nested, calib), Footprint(test::MakeSphere(40, 4), calib), 0.003);
}

TEST(PixelFootprint, TestPhotographsDoNotCount) {
  CalibResult calib = test::MakeCalib(10, 400, 0);
  CalibResult near = test::MakeCalib(30, 200, 0);
  for (PosedImage photo : near.photos) {
    photo.split = PhotoSplit::kTest;
    calib.photos.push_back(photo);
  }
  EXPECT_NEAR(Footprint(test::MakeSphere(2, 3), calib), 399.0 / 1700, 1.0 / 1700);
}

TEST(PixelFootprint, Errors) {
  const TriangleMesh sphere = test::MakeSphere(10, 3);
  EXPECT_NE(test::ErrorOf([&] { Footprint(sphere, {}); }).find("no calibrated photograph"),
            std::string::npos);
  CalibResult only_tests = test::MakeCalib(2, 400, 0);
  for (PosedImage& photo : only_tests.photos) photo.split = PhotoSplit::kTest;
  EXPECT_NE(test::ErrorOf([&] { Footprint(sphere, only_tests); }).find("for training"),
            std::string::npos);
  EXPECT_NE(test::ErrorOf([&] {
              Footprint(test::MakeSphere(10, 3, {5000, 0, 0}), test::MakeCalib(10, 400, 0));
            }).find("sees"),
            std::string::npos);
  CalibResult unknown = test::MakeCalib(2, 400, 0);
  unknown.cameras.clear();
  EXPECT_NE(test::ErrorOf([&] { Footprint(sphere, unknown); }).find("unknown camera"),
            std::string::npos);
}

}  // namespace
}  // namespace lfm
