// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

bool IsBackground(const Image& picture, int x, int y) {
  return picture.At<uint8_t>(x, y, 0) == 255 && picture.At<uint8_t>(x, y, 1) == 255;
}

TEST(MeshPictures, SphereIsADiscOfTheRightSize) {
  const TriangleMesh sphere = test::MakeSphere(30, 5, {0, 0, 30});
  const MeshView view = ViewMeshFrom(sphere, 0.3, 0.4, 200, 160);
  const Image picture = DrawMesh(sphere, view.camera, view.camera_from_world);
  ASSERT_EQ(picture.width(), 200);
  ASSERT_EQ(picture.height(), 160);
  int covered = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) covered += !IsBackground(picture, x, y);
  }
  const double distance = (view.camera_from_world.Center() - Eigen::Vector3d(0, 0, 30)).norm();
  const double radius_px = view.camera.fx * std::tan(std::asin(30 / distance));
  EXPECT_NEAR(covered, M_PI * radius_px * radius_px, 0.06 * M_PI * radius_px * radius_px);
  EXPECT_TRUE(IsBackground(picture, 0, 0));
  // Lit from the camera: brightest in the middle.
  EXPECT_GT(picture.At<uint8_t>(100, 80),
            picture.At<uint8_t>(100 + static_cast<int>(0.8 * radius_px), 80));
}

TEST(MeshPictures, AllOfTheMeshIsInView) {
  const TriangleMesh box = test::MakeBox({-50, -5, 0}, {50, 5, 100}, 2);
  for (const double elevation : {-std::numbers::pi / 2, -0.5, 0.0, 0.9, std::numbers::pi / 2}) {
    const MeshView view = ViewMeshFrom(box, 1, elevation, 100, 100);
    for (const auto& v : box.vertices) {
      const auto pixel = Project(view.camera, view.camera_from_world * v);
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(view.camera.Contains(*pixel));
    }
  }
}

TEST(MeshPictures, ValuesAndWiresShow) {
  TriangleMesh square = test::MakeSquare(20, 0, 4);
  const MeshView view = ViewMeshFrom(square, 0, std::numbers::pi / 2, 100, 100);
  MeshPictureOptions options;
  for (const auto& v : square.vertices) options.values.push_back(static_cast<float>(v.x()));
  options.value_low = -10;
  options.value_high = 10;
  const Image colored = DrawMesh(square, view.camera, view.camera_from_world, options);
  // Low values are dark blue, high ones yellow: red grows along +x, to the right seen from above.
  EXPECT_GT(colored.At<uint8_t>(78, 50, 0), colored.At<uint8_t>(22, 50, 0) + 60);
  options.values[0] = std::nanf("");
  const Image with_nan = DrawMesh(square, view.camera, view.camera_from_world, options);
  EXPECT_NE(with_nan.Bytes(), colored.Bytes());

  const auto brightness = [](const Image& picture) {
    double sum = 0;
    for (size_t i = 0; i < picture.size(); ++i) sum += picture.Data<uint8_t>()[i];
    return sum;
  };
  MeshPictureOptions wires;
  wires.wires = MeshWires::kDrawn;
  EXPECT_LT(brightness(DrawMesh(square, view.camera, view.camera_from_world, wires)),
            brightness(DrawMesh(square, view.camera, view.camera_from_world)) - 1000);
}

TEST(MeshPictures, BadInput) {
  const TriangleMesh sphere = test::MakeSphere(30, 1);
  const MeshView view = ViewMeshFrom(sphere, 0, 0, 20, 20);
  EXPECT_NE(test::ErrorOf([&] { DrawMesh({}, view.camera, view.camera_from_world); }), "");
  EXPECT_NE(test::ErrorOf([&] { DrawMesh(sphere, {}, view.camera_from_world); }), "");
  MeshPictureOptions options;
  options.values = {1, 2};
  EXPECT_NE(test::ErrorOf([&] { DrawMesh(sphere, view.camera, view.camera_from_world, options); }),
            "");
  options.values.assign(sphere.vertices.size(), 1);
  options.value_low = options.value_high = 3;
  EXPECT_NE(test::ErrorOf([&] { DrawMesh(sphere, view.camera, view.camera_from_world, options); }),
            "");
}

}  // namespace
}  // namespace lfm
