// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/error.h"
#include "tests/sample_data/test_shapes.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using V3f = Eigen::Vector3f;
using V2 = Eigen::Vector2d;

SceneObject TexturedBox(TextureKind kind, TextureMapping mapping) {
  SceneObject object = TestObject(TestBox({0, 0, 0}, {40, 20, 10}), Material());
  object.texture.kind = kind;
  object.texture.mapping = mapping;
  object.texture.scale_mm = 10;
  return object;
}

TEST(Texture, SolidCheckerChangesEveryScale) {
  const SceneObject box = TexturedBox(TextureKind::kChecker, TextureMapping::kSolid);
  const TextureFrame frame = MakeTextureFrame(box);
  const auto value = [&](double x, double y, double z) {
    return TextureValue(box.texture, frame, V3(x, y, z), V2::Zero()).x();
  };
  EXPECT_EQ(value(5, 5, 5), 1);
  EXPECT_EQ(value(15, 5, 5), 0);
  EXPECT_EQ(value(15, 15, 5), 1);
  EXPECT_EQ(value(-5, 5, 5), 0);
  EXPECT_EQ(value(-15, -25, 5), 0);
}

TEST(Texture, PlanarStripesHaveTheScaleInMillimetres) {
  const SceneObject box = TexturedBox(TextureKind::kStripes, TextureMapping::kPlanar);
  const TextureFrame frame = MakeTextureFrame(box);
  for (double x : {2.0, 12.0, 22.0, 32.0}) {
    const float expected = static_cast<int>(x / 10) % 2 == 0 ? 1.0f : 0.0f;
    EXPECT_EQ(TextureValue(box.texture, frame, V3(x, 7, 3), V2::Zero()).x(), expected) << x;
  }
}

TEST(Texture, CoordinatesStayInTheUnitSquare) {
  SceneObject ball = TestObject(TestSphere(12, {3, 4, 5}, 30), Material());
  for (TextureMapping mapping :
       {TextureMapping::kPlanar, TextureMapping::kCylinder, TextureMapping::kSphere}) {
    ball.texture.mapping = mapping;
    const TextureFrame frame = MakeTextureFrame(ball);
    for (const V3& p : ball.mesh.vertices) {
      const V2 uv = TextureCoordinates(mapping, frame, p, V2::Zero());
      EXPECT_TRUE((uv.array() >= 0).all() && (uv.array() <= 1).all());
    }
  }
  ball.texture.mapping = TextureMapping::kSphere;
  const TextureFrame frame = MakeTextureFrame(ball);
  EXPECT_NEAR(TextureCoordinates(TextureMapping::kSphere, frame, V3(3, 4, 35), V2::Zero()).y(), 1,
              1e-9);
  EXPECT_NEAR(TextureCoordinates(TextureMapping::kSphere, frame, V3(33, 4, 5), V2::Zero()).x(), 0.5,
              1e-9);
}

TEST(Texture, ImagesAreBilinearRepeatAndHaveTheirFirstRowAtTheTop) {
  Image image(2, 2, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  image.At<float>(0, 0, 0) = 1;  // top left red
  image.At<float>(1, 0, 1) = 1;  // top right green
  Texture texture;
  texture.kind = TextureKind::kImage;
  texture.mapping = TextureMapping::kUv;
  texture.image = std::make_shared<const Image>(image);
  const TextureFrame frame;
  const auto value = [&](double u, double v) {
    return TextureValue(texture, frame, V3::Zero(), V2(u, v));
  };
  EXPECT_LT((value(0.25, 0.75) - V3f(1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((value(0.75, 0.75) - V3f(0, 1, 0)).norm(), 1e-6);
  EXPECT_LT((value(0.5, 0.75) - V3f(0.5f, 0.5f, 0)).norm(), 1e-6);
  EXPECT_LT((value(1.25, -0.25) - V3f(1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((value(0, 0.75) - V3f(0.5f, 0.5f, 0)).norm(), 1e-6);
}

TEST(Texture, PaintOfVerticesReplacesTheMaterial) {
  SceneObject square = TestObject(TestSquare(10, 0), Material());
  square.paint.resize(4);
  square.paint[1].diffuse = {0.9f, 0, 0};
  square.paint[2].coat = {0, 0.6f, 0};
  square.paint[0].alpha = 0.2f;
  const Material m = ResolveMaterial(square, MakeTextureFrame(square), 0, 0.5f, 0.25f, V3f::Zero());
  EXPECT_EQ(m.kind, MaterialKind::kPaint);
  EXPECT_FLOAT_EQ(m.diffuse.x(), 0.45f);
  EXPECT_FLOAT_EQ(m.specular.y(), 0.15f);
  EXPECT_FLOAT_EQ(m.alpha_u, 0.25f * 0.2f + 0.75f * 0.3f);
}

TEST(Texture, ColoursTheSheenOfFuzzButNotTheCoatOfPlastic) {
  SceneObject box = TexturedBox(TextureKind::kStripes, TextureMapping::kSolid);
  box.texture.color_a = {0.5f, 0.5f, 0.5f};
  box.material.specular = {0.8f, 0.8f, 0.8f};
  const auto resolved = [&](MaterialKind kind) {
    box.material.kind = kind;
    return ResolveMaterial(box, MakeTextureFrame(box), 0, 0.2f, 0.2f, V3f(5, 5, 0));
  };
  EXPECT_FLOAT_EQ(resolved(MaterialKind::kFuzz).specular.x(), 0.4f);
  EXPECT_FLOAT_EQ(resolved(MaterialKind::kPlastic).specular.x(), 0.8f);
  EXPECT_FLOAT_EQ(resolved(MaterialKind::kPlastic).diffuse.x(), 0.25f);
}

TEST(Texture, UnusableSurfacesAreRefused) {
  SceneObject box = TexturedBox(TextureKind::kImage, TextureMapping::kUv);
  EXPECT_THROW(ValidateSurface(box), Error);
  box = TexturedBox(TextureKind::kChecker, TextureMapping::kUv);
  EXPECT_THROW(ValidateSurface(box), Error);
  box = TexturedBox(TextureKind::kChecker, TextureMapping::kSolid);
  ValidateSurface(box);
  box.texture.scale_mm = 0;
  EXPECT_THROW(ValidateSurface(box), Error);
  box.texture.scale_mm = 1;
  box.paint.resize(3);
  EXPECT_THROW(ValidateSurface(box), Error);
}

}  // namespace
}  // namespace lfm
