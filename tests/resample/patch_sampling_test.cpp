// SPDX-License-Identifier: BSD-3-Clause
#include "resample/patch_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "resample/light_field.h"
#include "test_scenes.h"

namespace lfm {
namespace {

PhotoPixels PixelsOf(const Image& picture, const Camera& camera) {
  return MakePhotoPixels(
      picture,
      std::vector<PixelUse>(static_cast<size_t>(camera.width) * camera.height, PixelUse::kData),
      camera, "photo.png");
}

Camera PlainCamera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 100;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

/// A picture whose red is 10 x and whose green is 10 y.
Image Ramp(int width, int height) {
  Image picture(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.At<uint8_t>(x, y, 0) = static_cast<uint8_t>(10 * x);
      picture.At<uint8_t>(x, y, 1) = static_cast<uint8_t>(10 * y);
    }
  }
  return picture;
}

double Stored(double eight_bit) { return eight_bit / 255 * LightField::kOne; }

TEST(SampleView, PutsPixelCentresAtIntegers) {
  const Camera camera = PlainCamera(20, 16);
  const PhotoPixels photo = PixelsOf(Ramp(20, 16), camera);
  // A ramp tells where it was read: half a pixel off would show as 5 levels.
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(4, 7), Eigen::Vector2d(4.25, 7.5), Eigen::Vector2d(0.01, 0.02),
        Eigen::Vector2d(18.99, 14.98), Eigen::Vector2d(18.9, 14.2)}) {
    const Eigen::Vector3d point = 300 * Unproject(camera, pixel);
    const auto view = SampleView(photo, camera, Pose{}, {point});
    ASSERT_EQ(view.data_samples, 1) << pixel.transpose();
    EXPECT_NEAR(view.values[0], Stored(10 * pixel.x()), 1) << pixel.transpose();
    EXPECT_NEAR(view.values[1], Stored(10 * pixel.y()), 1);
    EXPECT_EQ(view.values[2], 0);
  }
}

TEST(SampleView, HidesWhatIsOutsideOrForbidden) {
  const Camera camera = PlainCamera(20, 16);
  PhotoPixels photo = PixelsOf(Ramp(20, 16), camera);
  const auto see = [&](const Eigen::Vector3d& point) {
    return SampleView(photo, camera, Pose{}, {300 * Unproject(camera, {5, 5}), point});
  };
  const auto at = [&](double x, double y) { return see(300 * Unproject(camera, {x, y})); };
  const auto is_hidden = [](const SampledView& view) {
    EXPECT_EQ(view.data_samples + view.hidden_samples, 2);
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(view.knowledge[c], Knowledge::kData);
      const auto kept = view.hidden_samples == 0 ? Knowledge::kData : Knowledge::kMissing;
      EXPECT_EQ(view.knowledge[3 + c], kept);
    }
    return view.hidden_samples == 1;
  };
  EXPECT_FALSE(is_hidden(at(10, 10)));
  EXPECT_TRUE(is_hidden(at(-0.01, 5)));
  EXPECT_TRUE(is_hidden(at(5, 15.01)));
  EXPECT_TRUE(is_hidden(see({0, 0, -300})));
  uint8_t& use = photo.rgbu[4 * (10 * 20 + 10) + 3];  // of pixel (10, 10)
  use = static_cast<uint8_t>(PixelUse::kForbidden);
  EXPECT_TRUE(is_hidden(at(10, 10)));
  EXPECT_TRUE(is_hidden(at(9.5, 10.5)));
  EXPECT_FALSE(is_hidden(at(9, 10)));  // its neighbour is not read at weight zero
  EXPECT_TRUE(is_hidden(at(9.01, 10)));
  use = static_cast<uint8_t>(PixelUse::kNearEdge);
  const SampledView view = at(9.5, 10.5);
  EXPECT_EQ(view.data_samples, 1);
  EXPECT_EQ(view.hidden_samples, 0);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(view.knowledge[c], Knowledge::kData);
    EXPECT_EQ(view.knowledge[3 + c], Knowledge::kMissing);
  }
}

TEST(SampleView, MarksSaturatedChannels) {
  const Camera camera = PlainCamera(20, 16);
  Image picture = Ramp(20, 16);
  picture.At<uint8_t>(8, 8, 1) = 255;
  const auto view = SampleView(PixelsOf(picture, camera), camera, Pose{},
                               {300 * Unproject(camera, {7.5, 8}), 300 * Unproject(camera, {6, 8}),
                                300 * Unproject(camera, {8, 8})});
  const auto data = Knowledge::kData, bound = Knowledge::kLowerBound;
  EXPECT_EQ(view.knowledge,
            (std::vector<Knowledge>{data, bound, data, data, data, data, data, bound, data}));
  EXPECT_NEAR(view.values[1], Stored((80 + 255) / 2.0), 1);
}

TEST(SampleView, ReadsAKnownFunctionOfWorldPosition) {
  // Smooth colour over a sphere: what the patch says must be the colour of its own points.
  const TriangleMesh sphere = test::Sphere({0, 0, 0}, 40, 5);
  const auto color = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(0.5 + p.x() / 100, 0.5 + p.y() / 100, 0.5 + 0.3 * std::sin(p.z() / 10));
  };
  const Camera camera = test::TestCamera(320, 240, 600);
  const Pose pose = LookAt({150, -220, 120}, {0, 0, 0}, {0, 0, 1});
  const PhotoPixels photo =
      PixelsOf(test::RenderPhoto(sphere, camera, pose, color, {0, 0, 0}, 1), camera);
  const RayScene scene(sphere);
  int checked = 0;
  for (int t = 0; t < static_cast<int>(sphere.triangles.size()); t += 37) {
    const Eigen::Vector3d to_eye = (pose.Center() - sphere.vertices[sphere.triangles[t][0]]);
    if (TriangleNormal(sphere, t).dot(to_eye.normalized()) < 0.5) continue;
    const auto points = PatchPoints(sphere, t, 5, SampleOn::kMesh, scene, 1);
    const auto view = SampleView(photo, camera, pose, points);
    ASSERT_EQ(view.data_samples, static_cast<int>(points.size()));
    for (size_t s = 0; s < points.size(); ++s) {
      for (int c = 0; c < 3; ++c) {
        // One level of rounding, and a little for the curvature between two pixels.
        EXPECT_NEAR(view.values[3 * s + c], Stored(255 * color(points[s])[c]), Stored(0.8));
      }
    }
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST(PatchPoints, FollowTheSampleOrderAndShareEdges) {
  const TriangleMesh mesh = test::Sphere({0, 0, 0}, 40, 1);
  const TriangleMesh surface = test::Sphere({0, 0, 0}, 40, 4);
  const RayScene scene(surface);
  const auto neighbors = ComputeTriangleNeighbors(mesh);
  for (const SampleOn sample_on : {SampleOn::kMesh, SampleOn::kSurface}) {
    const auto points = PatchPoints(mesh, 7, 9, sample_on, scene, 10);
    ASSERT_EQ(points.size(), 45u);
    const Eigen::Vector3i& corners = mesh.triangles[7];
    EXPECT_LT((points[PatchSampleIndex(9, 8, 0)] - mesh.vertices[corners[1]]).norm(), 0.05);
    EXPECT_LT((points[PatchSampleIndex(9, 0, 8)] - mesh.vertices[corners[2]]).norm(), 0.05);
    // Edge 0 (corners 0 and 1) has the same points in the neighbour.
    const auto others = PatchPoints(mesh, neighbors[7][0], 9, sample_on, scene, 10);
    for (int i = 0; i < 9; ++i) {
      double nearest = HUGE_VAL;
      for (const auto& other : others) {
        nearest = std::min(nearest, (points[PatchSampleIndex(9, i, 0)] - other).norm());
      }
      EXPECT_LT(nearest, 1e-9);
    }
  }
}

TEST(PatchPoints, LieOnTheDenseSurfaceWhenAsked) {
  const TriangleMesh mesh = test::Sphere({0, 0, 0}, 40, 1);  // facets up to 4 mm inside
  const RayScene scene(test::Sphere({0, 0, 0}, 40, 5));
  double deepest = 40;
  for (const auto& point : PatchPoints(mesh, 3, 9, SampleOn::kMesh, scene, 10)) {
    deepest = std::min(deepest, point.norm());
  }
  EXPECT_LT(deepest, 37.5);
  for (const auto& point : PatchPoints(mesh, 3, 9, SampleOn::kSurface, scene, 10)) {
    EXPECT_NEAR(point.norm(), 40, 0.05);
  }
  // Out of reach: the sample stays on the mesh.
  const auto stayed = PatchPoints(mesh, 3, 9, SampleOn::kSurface, scene, 0.5);
  deepest = 40;
  for (const auto& point : stayed) deepest = std::min(deepest, point.norm());
  EXPECT_LT(deepest, 37.5);
}

TEST(TapAt, KeepsInsideTheFrame) {
  EXPECT_FALSE(TapAt(1, 10, {0, 0}));
  EXPECT_FALSE(TapAt(10, 10, {std::nan(""), 0}));
  const auto corner = TapAt(10, 8, {9, 7});
  ASSERT_TRUE(corner);
  EXPECT_EQ(corner->x, 8);
  EXPECT_EQ(corner->y, 6);
  EXPECT_EQ(corner->fx, 1);
  EXPECT_EQ(corner->fy, 1);
}

TEST(MakePhotoPixels, RefusesAnotherSizeAndTakesGrayAndFloat) {
  const Camera camera = PlainCamera(4, 3);
  Image wrong(5, 3, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  EXPECT_THROW(PixelsOf(wrong, camera), Error);
  Image gray(4, 3, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  gray.At<uint8_t>(2, 1, 0) = 77;
  const PhotoPixels photo = PixelsOf(gray, camera);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(photo.At(2, 1)[c], 77);
  Image linear(4, 3, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  linear.At<float>(2, 1, 0) = 0.5F;
  EXPECT_EQ(PixelsOf(linear, camera).At(2, 1)[0], 188);
}

}  // namespace
}  // namespace lfm
