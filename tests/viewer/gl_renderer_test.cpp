// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/image_metrics.h"
#include "synthetic_model.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/orbit_camera.h"
#include "viewer/reference_renderer.h"

namespace lfm {
namespace {

constexpr double kMinPsnrDb = 45;
constexpr int kWidth = 200, kHeight = 160;

/// Full pixels of `coverage` whose neighbours within `margin` are full, too.
Image Interior(const Image& coverage, int margin) {
  Image mask(coverage.width(), coverage.height(), 1, PixelType::kUint8, ColorEncoding::kLinear);
  for (int y = margin; y < coverage.height() - margin; ++y) {
    for (int x = margin; x < coverage.width() - margin; ++x) {
      bool full = true;
      for (int dy = -margin; dy <= margin; ++dy) {
        for (int dx = -margin; dx <= margin; ++dx) {
          full = full && coverage.At<uint8_t>(x + dx, y + dy) == 255;
        }
      }
      mask.At<uint8_t>(x, y) = full ? 255 : 0;
    }
  }
  return mask;
}

Image DrawWithGl(const GlRenderer& renderer, const Camera& camera, const Pose& pose,
                 const GlRenderOptions& options) {
  const GlFramebuffer framebuffer(camera.width, camera.height, 1);
  framebuffer.Bind();
  renderer.Draw(camera, pose, options);
  return framebuffer.Read();
}

OrbitCamera View(const LightFieldModel& model, double azimuth_deg, double elevation_deg,
                 double zoom) {
  OrbitCamera orbit = FrameMesh(model.mesh, 0.5, static_cast<double>(kWidth) / kHeight);
  orbit.azimuth = azimuth_deg * std::numbers::pi / 180;
  orbit.elevation = elevation_deg * std::numbers::pi / 180;
  return Zoom(orbit, zoom);
}

class GlRendererTest : public testing::Test {
 protected:
  EglContext context_;
};

TEST_F(GlRendererTest, AgreesWithTheReferenceForEveryTermAndCamera) {
  for (const DirectionMap map : {DirectionMap::kHemiOctahedral, DirectionMap::kOrthographic,
                                 DirectionMap::kHemiOctahedralSkirt}) {
    const LightFieldModel model = MakeSmoothRandomModel(1, map);
    ASSERT_GT(model.mean_pages.size(), 1u);
    ASSERT_GT(model.view_pages[0].size(), 1u);
    const GlRenderer gl(model);
    const ReferenceRenderer reference(model);
    for (const auto& [azimuth, elevation, zoom] : {std::tuple{10.0, 20.0, 1.0},
                                                   {130.0, -50.0, 1.0},
                                                   {255.0, 85.0, 1.3},
                                                   {300.0, 5.0, 0.5}}) {
      const OrbitCamera orbit = View(model, azimuth, elevation, zoom);
      Camera camera = PinholeCamera(orbit, kWidth, kHeight);
      camera.cx += 7.4;  // off centre: a picture mirrored or half a pixel off would show
      camera.cy -= 4.3;
      const Pose pose = CameraFromWorld(orbit);
      for (int terms = 0; terms <= model.terms; ++terms) {
        GlRenderOptions gl_options;
        gl_options.evaluation.terms = terms;
        RenderOptions options;
        options.evaluation.terms = terms;
        const Rendering expected = reference.Render(camera, pose, options, SilentProgress());
        const Image drawn = DrawWithGl(gl, camera, pose, gl_options);
        const ImageDifference difference =
            CompareImages(drawn, expected.color, Interior(expected.coverage, 1));
        EXPECT_GT(difference.pixels, 4000);
        EXPECT_GE(difference.psnr_db, kMinPsnrDb)
            << terms << " terms, azimuth " << azimuth << ", map " << static_cast<int>(map);
      }
    }
  }
}

// Nonnegative terms hold the mean view; vertices without any show it themselves.
TEST_F(GlRendererTest, AgreesWithTheReferenceWhereTermsHoldTheMeanView) {
  LightFieldModel model = MakeSmoothRandomModel(4, DirectionMap::kHemiOctahedral);
  model.mean_in_terms = true;
  ASSERT_GT(std::count(model.vertex_terms.begin(), model.vertex_terms.end(), 0), 3);
  const GlRenderer gl(model);
  const ReferenceRenderer reference(model);
  const OrbitCamera orbit = View(model, 130, 20, 1);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  for (const int terms : {0, 1, 3}) {
    GlRenderOptions gl_options;
    gl_options.evaluation.terms = terms;
    RenderOptions options;
    options.evaluation.terms = terms;
    const Rendering expected = reference.Render(camera, pose, options, SilentProgress());
    EXPECT_GE(CompareImages(DrawWithGl(gl, camera, pose, gl_options), expected.color,
                            Interior(expected.coverage, 1))
                  .psnr_db,
              kMinPsnrDb)
        << terms;
  }
}

TEST_F(GlRendererTest, TermsChangeThePicture) {
  const LightFieldModel model = MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral);
  const GlRenderer gl(model);
  const OrbitCamera orbit = View(model, 10, 20, 1);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  const Rendering reference = ReferenceRenderer(model).Render(camera, pose, {}, SilentProgress());
  const Image interior = Interior(reference.coverage, 1);
  for (int terms = 0; terms < model.terms; ++terms) {
    GlRenderOptions fewer, more;
    fewer.evaluation.terms = terms;
    more.evaluation.terms = terms + 1;
    EXPECT_LT(CompareImages(DrawWithGl(gl, camera, pose, fewer), DrawWithGl(gl, camera, pose, more),
                            interior)
                  .psnr_db,
              40);
  }
}

TEST_F(GlRendererTest, SilhouetteAgreesWithinAPixel) {
  const LightFieldModel model = MakeSmoothRandomModel(2, DirectionMap::kHemiOctahedral);
  const OrbitCamera orbit = View(model, 40, 30, 1);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  GlRenderOptions options;
  options.evaluation.terms = 0;
  options.background = {1, 0, 1};
  const Image drawn = DrawWithGl(GlRenderer(model), camera, pose, options);
  const Image mask = RenderSilhouette(model.mesh, camera, pose);
  int differ = 0, inside = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool background = drawn.At<uint8_t>(x, y, 0) == 255 &&
                              drawn.At<uint8_t>(x, y, 1) == 0 && drawn.At<uint8_t>(x, y, 2) == 255;
      const bool hit = mask.At<uint8_t>(x, y) != 0;
      inside += hit;
      differ += background == hit;
    }
  }
  EXPECT_GT(inside, 4000);
  // Both decide by the pixel's centre: only ties of rounding may differ.
  EXPECT_LE(differ, 3);
}

// From far away the direction of view is the same all over a triangle.
TEST_F(GlRendererTest, WhatIsReadAtCornersAgreesFromFarAway) {
  const LightFieldModel model = MakeSmoothRandomModel(5, DirectionMap::kHemiOctahedral);
  const GlRenderer gl(model);
  OrbitCamera orbit = View(model, 200, 25, 1);
  ASSERT_LE(model.terms, GlRenderer::kMostCornerTerms);
  const auto psnr = [&](const OrbitCamera& from, ViewCoordinates where, int terms) {
    const Camera camera = PinholeCamera(from, kWidth, kHeight);
    const Pose pose = CameraFromWorld(from);
    const Rendering reference = ReferenceRenderer(model).Render(camera, pose, {}, SilentProgress());
    GlRenderOptions per_pixel;
    per_pixel.evaluation.terms = terms;
    GlRenderOptions other = per_pixel;
    other.view_coordinates = where;
    return CompareImages(DrawWithGl(gl, camera, pose, other),
                         DrawWithGl(gl, camera, pose, per_pixel), Interior(reference.coverage, 1))
        .psnr_db;
  };
  OrbitCamera far = orbit;
  far.vertical_fov /= 40;  // a telephoto lens: the same picture from forty times as far
  far.distance *= 40;
  for (const ViewCoordinates where :
       {ViewCoordinates::kPerVertex, ViewCoordinates::kMapsAtCorners}) {
    EXPECT_EQ(psnr(orbit, where, 0), 99) << "the mean view alone has no directions";
    for (const int terms : {1, 3}) {
      const double near_db = psnr(orbit, where, terms), far_db = psnr(far, where, terms);
      EXPECT_GT(far_db, 50);
      EXPECT_LT(near_db, far_db);
      EXPECT_GT(near_db, 20);
    }
  }
}

TEST_F(GlRendererTest, FarFromTheOriginNothingIsLost) {
  LightFieldModel model = MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral);
  const Eigen::Vector3d shift(4e6, -7e6, 2e6);
  const OrbitCamera orbit = View(model, 10, 20, 1);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  const Image near = DrawWithGl(GlRenderer(model), camera, pose, {});
  for (Eigen::Vector3d& vertex : model.mesh.vertices) vertex += shift;
  Pose moved = pose;
  moved.translation -= pose.rotation * shift;
  const Image far = DrawWithGl(GlRenderer(model), camera, moved, {});
  const Rendering reference = ReferenceRenderer(model).Render(camera, moved, {}, SilentProgress());
  EXPECT_GT(CompareImages(far, near, Interior(reference.coverage, 1)).psnr_db, 60);
}

TEST_F(GlRendererTest, WireframeDrawsEdgesOnly) {
  const LightFieldModel model = MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral);
  const GlRenderer gl(model);
  const OrbitCamera orbit = View(model, 10, 20, 0.6);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  GlRenderOptions plain, edges;
  edges.edges = EdgeOverlay::kWireframe;
  const Image without = DrawWithGl(gl, camera, pose, plain);
  const Image with = DrawWithGl(gl, camera, pose, edges);
  // The middle of a near triangle keeps its colour, the middle of its edge does not.
  int kept = 0, changed = 0;
  const Eigen::Vector3d eye = pose.Center();
  for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& corners = model.mesh.triangles[t];
    const Eigen::Vector3d a = model.mesh.vertices[corners[0]], b = model.mesh.vertices[corners[1]],
                          c = model.mesh.vertices[corners[2]];
    if (TriangleNormal(model.mesh, static_cast<int>(t)).dot((eye - a).normalized()) < 0.7) continue;
    const auto differs = [&](const Eigen::Vector3d& point) {
      const Eigen::Vector2d pixel = Project(camera, pose * point).value();
      if (!camera.Contains(pixel)) return -1;
      const int x = static_cast<int>(std::lround(pixel.x()));
      const int y = static_cast<int>(std::lround(pixel.y()));
      return std::abs(with.At<uint8_t>(x, y, 0) - without.At<uint8_t>(x, y, 0)) +
             std::abs(with.At<uint8_t>(x, y, 2) - without.At<uint8_t>(x, y, 2));
    };
    kept += differs((a + b + c) / 3) == 0;
    changed += differs((a + b) / 2) > 10;
  }
  EXPECT_GT(kept, 15);
  EXPECT_GT(changed, 15);
}

TEST_F(GlRendererTest, SmoothedEdgesLieBetweenObjectAndBackground) {
  const LightFieldModel model = MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral);
  const GlRenderer gl(model);
  const OrbitCamera orbit = View(model, 10, 20, 1);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  const GlFramebuffer drawn(kWidth, kHeight, 4), smooth(kWidth, kHeight, 1);
  drawn.Bind();
  gl.Draw(camera, pose, {});
  drawn.ResolveInto(smooth);
  const Image resolved = smooth.Read();
  const Rendering reference = ReferenceRenderer(model).Render(camera, pose, {}, SilentProgress());
  const Image interior = Interior(reference.coverage, 2);
  EXPECT_GE(CompareImages(resolved, reference.color, interior).psnr_db, kMinPsnrDb);
  EXPECT_FALSE(resolved.Bytes() == DrawWithGl(gl, camera, pose, {}).Bytes());
}

TEST_F(GlRendererTest, RefusesLensesPagesAndSizesItCannotDraw) {
  const LightFieldModel model = MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral);
  const GlRenderer gl(model);
  const OrbitCamera orbit = View(model, 10, 20, 1);
  Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  camera.k1 = 0.1;
  EXPECT_THROW(gl.Draw(camera, CameraFromWorld(orbit), {}), Error);
  EXPECT_THROW(GlFramebuffer(0, 10, 1), Error);
  EXPECT_THROW(GlFramebuffer(1 << 20, 10, 1), Error);

  LightFieldModel wide = model;
  wide.mean_pages[0] = Image(40000, 1, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  EXPECT_THROW(GlRenderer{wide}, Error);
  LightFieldModel many = model;
  many.view_pages[2].resize(5000, many.view_pages[2][0]);
  many.view_pages[1] = many.view_pages[0] = many.view_pages[2];
  EXPECT_THROW(GlRenderer{many}, Error);
  LightFieldModel uneven = model;
  uneven.view_pages[1].clear();
  EXPECT_THROW(GlRenderer{uneven}, Error);
  LightFieldModel gray = model;
  gray.mean_pages[0] = Image(8, 8, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  EXPECT_THROW(GlRenderer{gray}, Error);
}

TEST_F(GlRendererTest, DrawsAModelWithoutTerms) {
  ModelRecipe recipe;
  recipe.mean = [](const Eigen::Vector3d&) { return Eigen::Vector3d(0.2, 0.4, 0.6); };
  const LightFieldModel model = MakeModel(MakeSphere(60, {0, 0, 0}, 1), recipe);
  const OrbitCamera orbit = View(model, 10, 20, 1);
  const Image drawn = DrawWithGl(GlRenderer(model), PinholeCamera(orbit, kWidth, kHeight),
                                 CameraFromWorld(orbit), {});
  EXPECT_EQ(drawn.At<uint8_t>(kWidth / 2, kHeight / 2, 0), 51);
  EXPECT_EQ(drawn.At<uint8_t>(kWidth / 2, kHeight / 2, 2), 153);
}

}  // namespace
}  // namespace lfm
