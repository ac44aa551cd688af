// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/image_metrics.h"
#include "core/ray_scene.h"
#include "synthetic_model.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_pictures.h"
#include "viewer/orbit_camera.h"
#include "viewer/reference_renderer.h"

namespace lfm {
namespace {

constexpr double kMinPsnrDb = 45;
constexpr int kWidth = 200, kHeight = 160;

std::shared_ptr<const LightFieldModel> SharedModel(uint32_t seed) {
  return std::make_shared<const LightFieldModel>(
      MakeSmoothRandomModel(seed, DirectionMap::kHemiOctahedral));
}

Placement PlaceAt(const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& translation,
                  double scale) {
  Placement placement;
  placement.world_from_model.rotation =
      Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  placement.world_from_model.translation = translation;
  placement.scale = scale;
  return placement;
}

/// Two models, one turned, shrunk and half behind the other.
Scene TwoModels() {
  return {{"first", SharedModel(1), {}},
          {"second", SharedModel(2), PlaceAt({1, 2, 3}, 1.1, {70, 40, 10}, 0.7)}};
}

OrbitCamera ViewOfScene(const Scene& scene, double azimuth_deg, double elevation_deg) {
  OrbitCamera orbit = FrameMesh(SceneMesh(scene), 0.5, static_cast<double>(kWidth) / kHeight);
  orbit.azimuth = azimuth_deg * std::numbers::pi / 180;
  orbit.elevation = elevation_deg * std::numbers::pi / 180;
  return orbit;
}

Image Draw(const GlScene& scene, const Camera& camera, const Pose& pose,
           const GlRenderOptions& options) {
  const GlFramebuffer framebuffer(camera.width, camera.height, 1);
  framebuffer.Bind();
  scene.Draw(camera, pose, options);
  return framebuffer.Read();
}

/// Where a pixel and its neighbours show the same model in four samples each: no silhouettes.
Image AwayFromEdges(const Scene& scene, const Camera& camera, const Pose& pose) {
  const RayScene rays(SceneMesh(scene));
  const auto first = static_cast<int>(scene[0].model->mesh.triangles.size());
  const auto seen = [&](int x, int y) {
    const auto hit = rays.Intersect(
        pose.Center(), pose.rotation.transpose() * Unproject(camera, Eigen::Vector2d(x, y)));
    return !hit ? 0 : hit->triangle < first ? 1 : 2;
  };
  Image mask(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kLinear);
  for (int y = 1; y < camera.height - 1; ++y) {
    for (int x = 1; x < camera.width - 1; ++x) {
      const int here = seen(x, y);
      const bool inside = here > 0 && here == seen(x - 1, y) && here == seen(x + 1, y) &&
                          here == seen(x, y - 1) && here == seen(x, y + 1);
      mask.At<uint8_t>(x, y) = inside ? 255 : 0;
    }
  }
  return mask;
}

class GlSceneTest : public testing::Test {
 protected:
  EglContext context_;
};

TEST_F(GlSceneTest, AgreesWithTheReferenceFromAllRound) {
  const Scene scene = TwoModels();
  const GlScene gl(scene);
  const ReferenceRenderer reference(scene);
  for (int turn = 0; turn < 5; ++turn) {
    const OrbitCamera orbit = ViewOfScene(scene, 72 * turn + 10, 60 - 25 * turn);
    const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
    const Pose pose = CameraFromWorld(orbit);
    const Rendering expected = reference.Render(camera, pose, {}, SilentProgress());
    const ImageDifference difference = CompareImages(Draw(gl, camera, pose, {}), expected.color,
                                                     AwayFromEdges(scene, camera, pose));
    EXPECT_GT(difference.pixels, 3000);
    EXPECT_GE(difference.psnr_db, kMinPsnrDb) << turn;
  }
}

// A model and its camera moved together show the same picture.
TEST_F(GlSceneTest, PlacementsMoveModelsAsCamerasMoveBack) {
  const Scene still = {{"model", SharedModel(3), {}}};
  const Placement placement = PlaceAt({-1, 0.5, 2}, 2.2, {300, -200, 80}, 2.5);
  const Scene moved = {{"model", still[0].model, placement}};
  const OrbitCamera orbit = ViewOfScene(still, 30, 20);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  Pose moved_pose = pose * placement.world_from_model.Inverse();
  moved_pose.translation = placement.scale * pose.translation -
                           pose.rotation * (placement.world_from_model.rotation.transpose() *
                                            placement.world_from_model.translation);
  const Rendering expected = ReferenceRenderer(still).Render(camera, pose, {}, SilentProgress());
  const Rendering same = ReferenceRenderer(moved).Render(camera, moved_pose, {}, SilentProgress());
  const Image mask = AwayFromEdges(still, camera, pose);
  EXPECT_GT(CompareImages(same.color, expected.color, mask).psnr_db, 70);
  EXPECT_GT(CompareImages(Draw(GlScene(moved), camera, moved_pose, {}),
                          Draw(GlScene(still), camera, pose, {}), mask)
                .psnr_db,
            60);
}

TEST_F(GlSceneTest, ModelsArriveInAnyOrder) {
  const Scene scene = TwoModels();
  GlScene gl;
  const OrbitCamera orbit = ViewOfScene(scene, 10, 30);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  EXPECT_EQ(gl.PassCount({}), 0);
  const Image empty = Draw(gl, camera, pose, {});
  EXPECT_EQ(*std::max_element(empty.Data<uint8_t>(), empty.Data<uint8_t>() + empty.size()), 0);
  gl.Put(0, scene[1], {});
  gl.Put(1, scene[1], {});
  gl.Put(0, scene[0], {});
  EXPECT_EQ(gl.size(), 2u);
  EXPECT_EQ(Draw(gl, camera, pose, {}).Bytes(), Draw(GlScene(scene), camera, pose, {}).Bytes());
}

/// Terms small enough that no pass leaves [0, 1].
LightFieldModel GentleModel(bool nonnegative) {
  LightFieldModel model = MakeSmoothRandomModel(8, DirectionMap::kHemiOctahedral);
  model.mean_in_terms = nonnegative;
  for (MapRange& range : model.surface_ranges) {
    range.scale = nonnegative ? 0.4f : 0.9f;
    range.bias = nonnegative ? 0 : -0.45f;
  }
  for (MapRange& range : model.view_ranges) {
    range.scale = nonnegative ? 0.6f : 0.8f;
    range.bias = nonnegative ? 0 : -0.4f;
  }
  return model;
}

TEST_F(GlSceneTest, TermsAloneAndTonesAgreeWithTheReference) {
  for (const bool nonnegative : {false, true}) {
    const LightFieldModel model = GentleModel(nonnegative);
    const Scene scene = SceneOf(model);
    const GlScene gl(scene);
    const ReferenceRenderer reference(scene);
    const OrbitCamera orbit = ViewOfScene(scene, 200, 15);
    const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
    const Pose pose = CameraFromWorld(orbit);
    const Image mask = AwayFromEdges(scene, camera, pose);
    std::vector<Image> seen;
    for (const int alone : {-1, 0, 2}) {
      for (const Tone tone : {Tone{}, Tone{2, ToneCurve::kClip}, Tone{2, ToneCurve::kSoft},
                              Tone{-2, ToneCurve::kClip}}) {
        RenderOptions options;
        options.evaluation.term_alone = alone;
        options.tone = tone;
        GlRenderOptions gl_options;
        gl_options.evaluation = options.evaluation;
        gl_options.tone = tone;
        const Image drawn = Draw(gl, camera, pose, gl_options);
        const Rendering expected = reference.Render(camera, pose, options, SilentProgress());
        EXPECT_GE(CompareImages(drawn, expected.color, mask).psnr_db, kMinPsnrDb)
            << alone << ", " << tone.exposure_stops << " stops";
        if (alone < 0) {
          for (const Image& before : seen) EXPECT_FALSE(before.Bytes() == drawn.Bytes());
        }
        seen.push_back(drawn);
      }
    }
    EXPECT_LT(CompareImages(seen[1], seen[0], mask).psnr_db, 20) << "two stops";
    EXPECT_LT(CompareImages(seen[4], seen[0], mask).psnr_db, 25) << "without the mean view";
    EXPECT_LT(CompareImages(seen[8], seen[4], mask).psnr_db, 45) << "another term";
  }
}

// What the mode shows has to be the same from everywhere: twenty cameras on a spiral, near and far.
TEST_F(GlSceneTest, AgreesWithTheReferenceOverTwentyCamerasInEveryMode) {
  struct Mode {
    const char* name;
    EvaluationOptions evaluation;
    Tone tone;
  };
  const Mode modes[] = {{"all", {}, {}},
                        {"mean view", {0}, {}},
                        {"one term", {1}, {}},
                        {"the second term alone", {.term_alone = 1}, {}},
                        {"bright and soft", {}, {1, ToneCurve::kSoft}}};
  for (const bool nonnegative : {false, true}) {
    const LightFieldModel model = GentleModel(nonnegative);
    const Scene scene = SceneOf(model);
    const GlScene gl(scene);
    const ReferenceRenderer reference(scene);
    for (int i = 0; i < 20; ++i) {
      OrbitCamera orbit = ViewOfScene(scene, 360 * 0.618 * i, 80 - 8 * i);
      orbit = Zoom(orbit, i % 3 == 0 ? 0.6 : i % 3 == 1 ? 1 : 1.3);
      const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
      const Pose pose = CameraFromWorld(orbit);
      const Image mask = AwayFromEdges(scene, camera, pose);
      for (const Mode& mode : modes) {
        RenderOptions options;
        options.evaluation = mode.evaluation;
        options.tone = mode.tone;
        GlRenderOptions gl_options;
        gl_options.evaluation = mode.evaluation;
        gl_options.tone = mode.tone;
        const Rendering expected = reference.Render(camera, pose, options, SilentProgress());
        EXPECT_GE(CompareImages(Draw(gl, camera, pose, gl_options), expected.color, mask).psnr_db,
                  kMinPsnrDb)
            << mode.name << ", camera " << i;
      }
    }
  }
}

// What a term alone shows is its part of the sum.
TEST_F(GlSceneTest, TermsAloneAddUp) {
  const LightFieldModel model = MakeSmoothRandomModel(7, DirectionMap::kHemiOctahedral);
  const Eigen::Vector3d weights(0.2, 0.5, 0.3);
  for (int t = 0; t < static_cast<int>(model.mesh.triangles.size()); t += 7) {
    const Eigen::Vector3d to_eye =
        (TriangleNormal(model.mesh, t) + Eigen::Vector3d(0.2, 0.1, -0.1)).normalized();
    Eigen::Vector3f sum = EvaluateUnclamped(model, t, weights, to_eye, {0});
    for (int k = 0; k < model.terms; ++k) {
      sum += EvaluateUnclamped(model, t, weights, to_eye, {.term_alone = k}) -
             Eigen::Vector3f::Constant(0.5f);
    }
    EXPECT_LT((sum - EvaluateUnclamped(model, t, weights, to_eye)).cwiseAbs().maxCoeff(), 1e-5f);
  }
}

TEST_F(GlSceneTest, ThePapersPassesAddUpToOne) {
  constexpr double kRoundingPsnrDb = 44;  // each pass rounds to 8 bits
  for (const bool nonnegative : {false, true}) {
    const LightFieldModel model = GentleModel(nonnegative);
    const Scene scene = SceneOf(model);
    const GlScene gl(scene);
    const OrbitCamera orbit = ViewOfScene(scene, 120, 25);
    const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
    const Pose pose = CameraFromWorld(orbit);
    const Image mask = AwayFromEdges(scene, camera, pose);
    const Image one = Draw(gl, camera, pose, {});
    for (const Passes passes : {Passes::kPaper, Passes::kPaperUnsigned}) {
      GlRenderOptions options;
      options.passes = passes;
      options.evaluation.terms = 0;
      EXPECT_EQ(gl.PassCount(options), 1);
      options.evaluation.terms = 3;
      const int products = nonnegative ? 1 : passes == Passes::kPaper ? 2 : 4;
      EXPECT_EQ(gl.PassCount(options), 1 + 3 * 3 * products);
      const Image many = Draw(gl, camera, pose, options);
      EXPECT_GE(CompareImages(many, one, mask).psnr_db, kRoundingPsnrDb)
          << (nonnegative ? "nonnegative" : "signed");
      EXPECT_FALSE(many.Bytes() == one.Bytes());
      // Fewer terms, other pictures: passes do draw.
      options.evaluation.terms = 1;
      EXPECT_LT(CompareImages(Draw(gl, camera, pose, options), one, mask).psnr_db, 40);
    }
  }
}

// Where a sum leaves [0, 1] on its way, 8 bits clamp it there: the paper's form is not exact.
TEST_F(GlSceneTest, ThePapersPassesClampOnTheWay) {
  ModelRecipe recipe;  // 0.9 + 0.6 - 0.6
  recipe.terms = 2;
  recipe.mean = [](const Eigen::Vector3d&) { return Eigen::Vector3d::Constant(0.9); };
  recipe.surface = [](int, const Eigen::Vector3d&) { return 1.0; };
  recipe.view = [](int k, int, const Eigen::Vector2d&) {
    return Eigen::Vector3d::Constant(k == 0 ? 0.6 : -0.6);
  };
  const LightFieldModel model = MakeModel(MakeSphere(60, {0, 0, 0}, 1), recipe);
  const Scene scene = SceneOf(model);
  const GlScene gl(scene);
  const OrbitCamera orbit = ViewOfScene(scene, 120, 25);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  GlRenderOptions options;
  constexpr int kTolerance = 8;  // levels: seven passes round, and maps are of 8 bits
  EXPECT_NEAR(Draw(gl, camera, pose, options).At<uint8_t>(100, 80), 0.9 * 255, kTolerance);
  options.passes = Passes::kPaper;
  EXPECT_NEAR(Draw(gl, camera, pose, options).At<uint8_t>(100, 80), 0.4 * 255, kTolerance);
}

TEST(GlPicturesOfScenes, AgreeWithTheReference) {
  const Scene scene = TwoModels();
  const OrbitCamera orbit = ViewOfScene(scene, 250, 20);
  const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
  const Pose pose = CameraFromWorld(orbit);
  RenderOptions options;
  options.samples_per_side = 2;
  options.tone = {0.5, ToneCurve::kSoft};
  const Rendering drawn = GlPictures(scene, ViewCoordinates::kPerPixel, 64)
                              .Render(camera, pose, options, SilentProgress());
  const Rendering expected =
      ReferenceRenderer(scene).Render(camera, pose, options, SilentProgress());
  EXPECT_GE(CompareImages(drawn.color, expected.color, AwayFromEdges(scene, camera, pose)).psnr_db,
            kMinPsnrDb);
}

TEST(ReferenceRendererOfScenes, ShowsTheNearestModel) {
  // Two plain balls, one before the other.
  const auto ball = [](const Eigen::Vector3d& color) {
    ModelRecipe recipe;
    recipe.mean = [color](const Eigen::Vector3d&) { return color; };
    return std::make_shared<const LightFieldModel>(MakeModel(MakeSphere(50, {0, 0, 0}, 2), recipe));
  };
  const Scene scene = {{"red", ball({0.8, 0.2, 0.2}), {}},
                       {"blue", ball({0.2, 0.2, 0.8}), PlaceAt({0, 0, 1}, 0, {0, -200, 0}, 0.5)}};
  Camera camera;
  camera.width = camera.height = 101;
  camera.fx = camera.fy = 200;
  camera.cx = camera.cy = 50;
  const ReferenceRenderer renderer(scene);
  const Pose front = LookAt({0, -600, 0}, {0, 0, 0}, Eigen::Vector3d::UnitZ());
  const Image from_front = renderer.Render(camera, front, {}, SilentProgress()).color;
  EXPECT_EQ(from_front.At<uint8_t>(50, 50, 2), 204);  // the blue one, half as large and nearer
  EXPECT_EQ(from_front.At<uint8_t>(64, 50, 0), 204);  // beside it the red one
  const Pose back = LookAt({0, 600, 0}, {0, 0, 0}, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(renderer.Render(camera, back, {}, SilentProgress()).color.At<uint8_t>(50, 50, 0), 204);
  EXPECT_THROW(ReferenceRenderer{Scene{}}, Error);
}

}  // namespace
}  // namespace lfm
