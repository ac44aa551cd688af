// SPDX-License-Identifier: BSD-3-Clause
// The window of lfm-viewer, driven by scripts under a virtual X server.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "compressed_models.h"
#include "core/ray_scene.h"
#include "viewer_script_fixture.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

constexpr double kPointerMm = 1e-4;  // pointers are in single precision

TEST_F(ViewerScriptCommand, HandsTurnMoveAndZoomAsTheReferenceHasIt) {
  const CommandOutcome outcome = Play(R"(
key P
loaded
state {}/home.json
drag left 220 60 260 90
screenshot {}/turned.png
state {}/turned.json
hold shift
drag left 220 60 200 80
let-go shift
state {}/moved.json
screenshot {}/moved.png
move 180 60
scroll 0 3
screenshot {}/near.png
state {}/near.json
key right
key home
state {}/back.json
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const LightFieldModel model = ReadGlb(model_);
  const Scene scene = SceneOf(model);
  const nlohmann::json home = State("home.json"), turned = State("turned.json");
  EXPECT_NEAR(turned.at("azimuth").get<double>(), home.at("azimuth").get<double>() - 36, 1e-6)
      << "40 of 200 pixels are a fifth of half a turn";
  EXPECT_NEAR(turned.at("elevation").get<double>(), home.at("elevation").get<double>() + 27, 1e-6);
  EXPECT_NE(State("moved.json").at("target"), turned.at("target"));
  EXPECT_LT(State("near.json").at("distance"), turned.at("distance"));
  for (const char* name : {"turned", "moved", "near"}) {
    EXPECT_GE(Psnr(Picture(std::string(name) + ".png"), scene,
                   CameraOf(State(std::string(name) + ".json"))),
              kMinPsnrDb)
        << name;
  }
  for (const char* key : {"azimuth", "elevation", "distance", "target"}) {
    EXPECT_EQ(State("back.json").at(key), home.at(key)) << key;
  }
}

TEST_F(ViewerScriptCommand, KeysShowTermsMeanViewEdgesAndOverlays) {
  const CommandOutcome outcome = Play(R"(
loaded
screenshot {}/all.png
key [
screenshot {}/two.png
key M
screenshot {}/mean.png
key M
key T
screenshot {}/alone.png
key T
key W
screenshot {}/edges.png
key W
set exposure 1
set tone soft
screenshot {}/bright.png
set exposure 0
set tone clip
set passes paper
screenshot {}/passes.png
state {}/passes.json
set passes one
key O
screenshot {}/normals.png
set overlay terms
screenshot {}/terms.png
state {}/terms.json
set overlay photographs
state {}/photographs.json
key P
windowshot {}/bare.png
screenshot {}/bare_scene.png
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const LightFieldModel model = ReadGlb(model_);
  const Scene scene = SceneOf(model);
  const OrbitCamera orbit = MakeOrbitCamera(model.mesh, view_);
  const auto psnr = [&](const char* name, const RenderOptions& options) {
    return Psnr(Picture(name), scene, orbit, options);
  };
  RenderOptions options;
  EXPECT_GE(psnr("all.png", options), kMinPsnrDb);
  options.evaluation.terms = 2;
  EXPECT_GE(psnr("two.png", options), kMinPsnrDb);
  EXPECT_LT(psnr("edges.png", options), 35);
  options.evaluation.terms = 0;
  EXPECT_GE(psnr("mean.png", options), kMinPsnrDb);
  EXPECT_LT(psnr("all.png", options), 35);
  options = {};
  options.evaluation.term_alone = 1;  // the second of two
  EXPECT_GE(psnr("alone.png", options), kMinPsnrDb);
  options = {};
  options.evaluation.terms = 2;
  options.tone = {1, ToneCurve::kSoft};
  EXPECT_GE(psnr("bright.png", options), kMinPsnrDb);
  EXPECT_EQ(State("passes.json").at("passes"), 1 + 2 * 6);
  EXPECT_FALSE(Picture("passes.png").Bytes() == Picture("two.png").Bytes());
  EXPECT_FALSE(Picture("normals.png").Bytes() == Picture("terms.png").Bytes());
  EXPECT_EQ(State("terms.json").at("legend").size(), 4u) << "vertices have 0 to 3 terms";
  EXPECT_NE(State("photographs.json").at("legend")[0].get<std::string>().find("--work"),
            std::string::npos);
  EXPECT_EQ(Picture("bare.png").Bytes(), Picture("bare_scene.png").Bytes()) << "no panel";
}

TEST_F(ViewerScriptCommand, DoubleClicksAndTheTapeFindTheSurface) {
  const CommandOutcome outcome = Play(R"(
key P
loaded
state {}/before.json
set measure on
click left 100 90
click left 150 110
state {}/tape.json
screenshot {}/tape.png
click left 2 2
state {}/beside.json
set measure off
double-click left 140 80
state {}/focus.json
screenshot {}/focus.png
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const LightFieldModel model = ReadGlb(model_);
  const OrbitCamera before = CameraOf(State("before.json"));
  const Camera camera = PinholeCamera(before, 240, 200);
  const Pose pose = CameraFromWorld(before);
  const RayScene rays(model.mesh);
  const auto on_surface = [&](double x, double y) {
    const Eigen::Vector3d direction =
        pose.rotation.transpose() * Unproject(camera, {x - 0.5, y - 0.5});
    const auto hit = rays.Intersect(pose.Center(), direction);
    EXPECT_TRUE(hit);
    return Eigen::Vector3d(pose.Center() + hit.value_or(RayHit()).distance * direction);
  };
  const Eigen::Vector3d a = on_surface(100, 90), b = on_surface(150, 110);
  EXPECT_NEAR(State("tape.json").at("tape_mm").get<double>(), (b - a).norm(), kPointerMm);
  EXPECT_FALSE(State("before.json").contains("tape_mm"));
  EXPECT_EQ(State("beside.json").at("tape").size(), 2u) << "nothing was hit";
  EXPECT_NE(State("beside.json").at("message"), "");
  // The tape is seen at its ends: red crosses.
  const Image tape = Picture("tape.png");
  int red = 0;
  for (int y = 84; y < 96; ++y) {
    for (int x = 94; x < 106; ++x) {
      red += tape.At<uint8_t>(x, y, 0) == 255 && tape.At<uint8_t>(x, y, 1) == 89;
    }
  }
  EXPECT_GE(red, 6);
  // What was clicked twice is in the middle now.
  const Eigen::Vector3d focused = on_surface(140, 80);
  const OrbitCamera after = CameraOf(State("focus.json"));
  EXPECT_LT((after.target - focused).norm(), kPointerMm);
  EXPECT_NEAR(after.distance, before.distance, 1e-9);
}

TEST_F(ViewerScriptCommand, WindowsMayShrinkToNothing) {
  const CommandOutcome outcome = Play(R"(
loaded
resize 1 1
wait 3
resize 0 0
wait 3
resize 300 120
wait 3
screenshot {}/after.png
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(Picture("after.png").width(), 300);
  EXPECT_EQ(Picture("after.png").height(), 120);
}

TEST_F(ViewerScriptCommand, FilmsAreWrittenFrameByFrame) {
  const CommandOutcome outcome = Play(R"(
loaded
set turntable 4
loaded
key P
key K
drag left 220 60 260 60
key K
set film path
loaded
state {}/films.json
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const LightFieldModel model = ReadGlb(model_);
  const std::vector<OrbitCamera> turn = TurntablePath(MakeOrbitCamera(model.mesh, view_), 4);
  for (int frame = 0; frame < 4; ++frame) {
    const fs::path file =
        here_ / "lfm-viewer-film-0001" / ("frame_000" + std::to_string(frame) + ".png");
    EXPECT_GE(Psnr(ReadImage(file), SceneOf(model), turn[frame]), kMinPsnrDb) << frame;
  }
  EXPECT_FALSE(fs::exists(here_ / "lfm-viewer-film-0001" / "frame_0004.png"));
  // Two seconds at 25 frames a second, both ends included.
  EXPECT_TRUE(fs::exists(here_ / "lfm-viewer-film-0002" / "frame_0050.png"));
  EXPECT_FALSE(fs::exists(here_ / "lfm-viewer-film-0002" / "frame_0051.png"));
  EXPECT_NE(State("films.json").at("message").get<std::string>().find("51 frames"),
            std::string::npos);
}

TEST_F(ViewerScriptCommand, DriversWithoutS3tcAndDenseScreensShowTheSame) {
  const std::string blocks = scratch_.folder / "blocks.glb";
  WriteGlb(InBlocks(MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral), BlockFormat::kBc1),
           blocks);
  const std::string lines = "loaded\nscreenshot {}/picture.png\nwindowshot {}/window.png\n";
  ASSERT_EQ(PlayOn(blocks, lines).status, 0);
  const Image plain = Picture("picture.png"), window = Picture("window.png");
  CommandSettings without;
  without.environment = {"MESA_EXTENSION_OVERRIDE=-GL_EXT_texture_compression_s3tc"};
  ASSERT_EQ(PlayOn(blocks, lines, {}, without).status, 0);
  const LightFieldModel model = ReadGlb(blocks);
  EXPECT_GE(Psnr(Picture("picture.png"), SceneOf(model), MakeOrbitCamera(model.mesh, view_)),
            kMinPsnrDb);
  EXPECT_GE(Psnr(plain, SceneOf(model), MakeOrbitCamera(model.mesh, view_)), kMinPsnrDb);

  // Letters twice as large: the panel reaches farther.
  view_.size = "900x900";
  ASSERT_EQ(PlayOn(blocks, lines, {"--ui-scale", "2"}).status, 0);
  const Image large = Picture("window.png"), large_plain = Picture("picture.png");
  ASSERT_EQ(PlayOn(blocks, lines, {"--ui-scale", "1"}).status, 0);
  const auto panel_width = [](const Image& with, const Image& bare) {
    int width = 0;
    for (int x = 0; x < with.width(); ++x) {
      if (with.At<uint8_t>(x, 20, 2) != bare.At<uint8_t>(x, 20, 2)) width = x;
    }
    return width;
  };
  const double usual_width = panel_width(Picture("window.png"), Picture("picture.png"));
  const double large_width = panel_width(large, large_plain);
  EXPECT_GT(usual_width, 100);
  EXPECT_NEAR(large_width / usual_width, 2, 0.25);
}

TEST_F(ViewerScriptCommand, FaultsOfScriptsNameTheLine) {
  const auto expect_refusal = [&](const std::string& lines, const std::vector<std::string>& parts) {
    const CommandOutcome outcome = Play(lines);
    EXPECT_EQ(outcome.status, 2) << lines;
    EXPECT_TRUE(IsOneLineWith(outcome.err, parts)) << outcome.err;
  };
  expect_refusal("loaded\nset terms many\n", {"script.txt:2", "terms", "many"});
  expect_refusal("loaded\nset colour 3\n", {"script.txt:2", "colour", "background"});
  expect_refusal("jump\n", {"script.txt", "1", "jump"});
  expect_refusal("loaded\nscreenshot picture.gif\n", {"script.txt", "2", ".png"});
  // A model that cannot be read is the script's fault as well: nobody reads the window.
  WriteFileAtomically(scratch_.folder / "broken.glb", ReadFile(model_).substr(0, 5000));
  const CommandOutcome broken = PlayOn(scratch_.folder / "broken.glb", "loaded\n");
  EXPECT_EQ(broken.status, 2);
  EXPECT_TRUE(IsOneLineWith(broken.err, {"broken.glb"})) << broken.err;
}

}  // namespace
}  // namespace lfm
