// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/traced_photo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/parallel.h"
#include "sample_data/camera_path.h"
#include "sample_data/photo_renderer.h"
#include "tests/sample_data/test_shapes.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

Material Diffuse(float albedo) {
  Material m;
  m.diffuse = Eigen::Vector3f::Constant(albedo);
  return m;
}

Material ClearGlass() {
  Material m;
  m.kind = MaterialKind::kGlass;
  m.alpha_u = m.alpha_v = 0;
  return m;
}

// A small still life: glass, gloss, shadow, bounce.
struct StillLife {
  Board board = DefaultBoard();
  SetReflectance reflectance{board};
  std::vector<SceneObject> objects;
  SceneLights lights;
  std::unique_ptr<TracedScene> scene;
  std::unique_ptr<PathTracer> tracer;
  Camera camera = MakePhotoCamera(48, 36);
  Pose pose = LookAt(V3(30, -160, 110), V3(0, 0, 15), V3(0, 0, 1));

  StillLife() {
    Material metal;
    metal.kind = MaterialKind::kConductor;
    metal.specular = {0.9f, 0.7f, 0.4f};
    metal.alpha_u = metal.alpha_v = 0.2f;
    objects = {TestObject(TestSphere(24, {-25, 0, 20.2}, 20), ClearGlass()),
               TestObject(TestSphere(24, {25, 0, 20.2}, 20), metal),
               TestObject(TestBox({-8, -38, 0.2}, {8, -22, 16}), Diffuse(0.6f))};
    lights.studio = MakeStudioLighting();
    scene = std::make_unique<TracedScene>(
        objects, MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}), &reflectance);
    tracer = std::make_unique<PathTracer>(*scene, lights, 1);
  }
  TracedPhoto Photo(int samples, uint64_t seed) const {
    return TracePhoto(*tracer, PixelRays(camera), pose, {samples, seed, 0});
  }
};

TEST(TracedPhoto, DoesNotDependOnTheNumberOfThreads) {
  const StillLife life;
  SetThreadCount(1);
  const TracedPhoto one = life.Photo(8, 3);
  SetThreadCount(5);
  const TracedPhoto five = life.Photo(8, 3);
  SetThreadCount(0);
  EXPECT_EQ(one.radiance.Bytes(), five.radiance.Bytes());
  EXPECT_EQ(one.standard_error.Bytes(), five.standard_error.Bytes());
  EXPECT_EQ(one.mask.Bytes(), five.mask.Bytes());
  EXPECT_EQ(one.rays.Total(), five.rays.Total());
  EXPECT_EQ(one.rays.camera, 48 * 36 * 8);
  EXPECT_NE(life.Photo(8, 4).radiance.Bytes(), one.radiance.Bytes());
}

// Root of the mean squared difference, over what a converged picture calls smooth pixels: the
// heaviest 2 % of pixels (caustics) would need far more samples for a stable second moment.
struct Spread {
  double measured, reported;
};
Spread Measure(const TracedPhoto& photo, const TracedPhoto& truth) {
  std::vector<float> limits(truth.standard_error.Data<float>(),
                            truth.standard_error.Data<float>() + truth.standard_error.size());
  std::nth_element(limits.begin(), limits.begin() + static_cast<int64_t>(limits.size() * 98 / 100),
                   limits.end());
  const float limit = limits[limits.size() * 98 / 100];
  double measured = 0, reported = 0;
  for (size_t i = 0; i < photo.radiance.size(); ++i) {
    if (truth.standard_error.Data<float>()[i] > limit) continue;
    measured += std::pow(photo.radiance.Data<float>()[i] - truth.radiance.Data<float>()[i], 2);
    reported += std::pow(photo.standard_error.Data<float>()[i], 2);
  }
  return {std::sqrt(measured), std::sqrt(reported)};
}

TEST(TracedPhoto, DoublingTheSamplesLowersTheErrorByRootTwoAndTheErrorIsReportedRight) {
  const StillLife life;
  const TracedPhoto truth = life.Photo(1024, 99);
  Spread sums[3];
  for (int level = 0; level < 3; ++level) {
    double measured = 0, reported = 0;
    for (uint64_t seed : {1, 2, 3}) {
      const Spread s = Measure(life.Photo(16 << level, seed), truth);
      measured += s.measured * s.measured;
      reported += s.reported * s.reported;
    }
    // The truth's own error is part of the difference: 1 / 1024 against 1 / 16.
    sums[level] = {std::sqrt(measured / (1 + (16 << level) / 1024.0)), std::sqrt(reported)};
  }
  for (int level = 0; level < 2; ++level) {
    EXPECT_NEAR(sums[level].measured / sums[level + 1].measured, std::sqrt(2.0), 0.14) << level;
  }
  for (int level = 0; level < 3; ++level) {
    EXPECT_NEAR(sums[level].reported / sums[level].measured, 1, 0.1) << level;
  }
}

TEST(TracedPhoto, MaskIsWhereAnObjectIsSeen) {
  const StillLife life;
  const TracedPhoto photo = life.Photo(1, 1);
  const auto marked = [&](const V3& point) {
    const Eigen::Vector2d pixel = *Project(life.camera, life.pose * point);
    return photo.mask.At<uint8_t>(static_cast<int>(std::lround(pixel.x())),
                                  static_cast<int>(std::lround(pixel.y())));
  };
  EXPECT_EQ(marked({-25, 0, 20}), 255);
  EXPECT_EQ(marked({25, 0, 20}), 255);
  EXPECT_EQ(marked({-60, -50, 0}), 0);
  EXPECT_THROW(life.Photo(0, 1), Error);
}

// The baked renderer and the path tracer share nothing but Embree. The baked one spreads the coat's
// share of bounced light as if it were diffuse, and reflects surroundings in harmonics of band 4.
TEST(TracedPhoto, AgreesWithTheBakedRendererOnACoarseBust) {
  const Board board = DefaultBoard();
  const SetReflectance reflectance(board);
  const Subject bust = MakeBust(3.5, 1);
  const std::vector<Patch> patches =
      MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}});
  const Camera camera = MakePhotoCamera(64, 48);
  const PixelRays rays(camera);
  const Pose pose = LookAt(V3(40, -330, 150), V3(0, 0, 55), V3(0, 0, 1));
  SceneLights lights;
  lights.studio = MakeStudioLighting();

  const StudioScene studio(&bust.mesh, patches);
  BakeOptions bake;
  bake.plate_spacing_mm = 4;
  const BakedLight light =
      BakeLight(studio, bust, lights.studio, reflectance, bake, SilentProgress());
  const CoatShading shading(bust, lights.studio, light);
  const RenderedPhoto baked = RenderPhoto(studio, shading, reflectance, rays, pose);

  SceneObject object = TestObject(bust.mesh, Material());
  object.paint = bust.paint;
  const std::vector<SceneObject> objects = {object};
  const TracedScene scene(objects, patches, &reflectance);
  const PathTracer tracer(scene, lights, 1);
  const TracedPhoto traced = TracePhoto(tracer, rays, pose, {64, 1, 0});

  double baked_sum = 0, traced_sum = 0, difference = 0;
  int pixels = 0, same_mask = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      same_mask += baked.mask.At<uint8_t>(x, y) == traced.mask.At<uint8_t>(x, y);
      if (baked.mask.At<uint8_t>(x, y) == 0) continue;
      ++pixels;
      for (int c = 0; c < 3; ++c) {
        const double b = baked.radiance.At<float>(x, y, c), t = traced.radiance.At<float>(x, y, c);
        baked_sum += b;
        traced_sum += t;
        difference += std::abs(b - t);
      }
    }
  }
  ASSERT_GT(pixels, 250);
  EXPECT_GE(same_mask, 64 * 48 - 2);
  EXPECT_NEAR(traced_sum / baked_sum, 1, 0.03);
  EXPECT_LT(difference / baked_sum, 0.10);
}

}  // namespace
}  // namespace lfm
