// SPDX-License-Identifier: BSD-3-Clause
// Scenes and dropped files in lfm-viewer's window, under a virtual X server.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "viewer_script_fixture.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

TEST_F(ViewerScriptCommand, DroppedModelsReplaceOrJoinAndBrokenOnesAreSaid) {
  LightFieldModel other = MakeSmoothRandomModel(2, DirectionMap::kHemiOctahedral);
  WriteGlb(other, scratch_.folder / "other.glb");
  WriteFileAtomically(scratch_.folder / "broken.glb", ReadFile(model_).substr(0, 5000));
  WriteFileAtomically(scratch_.folder / "scene.json",
                      R"({"models": [{"file": "model.glb"}, {"file": "other.glb",
                          "translation": [150, 0, 0], "scale": 0.5}]})");
  const CommandOutcome outcome = Play(R"(
loaded
drop {}/broken.glb
loaded
wait 2
windowshot {}/broken.png
screenshot {}/broken_scene.png
state {}/broken.json
drop {}/absent.glb
loaded
state {}/absent.json
drop {}/other.glb
loaded
screenshot {}/other.png
state {}/other.json
set add-dropped on
drop {}/model.glb
loaded
screenshot {}/both.png
state {}/both.json
set add-dropped off
drop {}/scene.json
loaded
screenshot {}/scene.png
state {}/scene_state.json
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(State("broken.json").at("error").get<std::string>().find("broken.glb"),
            std::string::npos);
  EXPECT_FALSE(Picture("broken.png").Bytes() == Picture("broken_scene.png").Bytes())
      << "the window says it";
  EXPECT_EQ(State("broken.json").at("models").size(), 1u) << "what was shown stays";
  EXPECT_NE(State("absent.json").at("error").get<std::string>().find("absent.glb"),
            std::string::npos);
  EXPECT_EQ(State("other.json").at("error"), "");
  EXPECT_EQ(State("other.json").at("models"), nlohmann::json::array({"other.glb"}));
  EXPECT_GE(Psnr(Picture("other.png"), SceneOf(other), CameraOf(State("other.json"))), kMinPsnrDb);

  const auto first = std::make_shared<const LightFieldModel>(ReadGlb(model_));
  const auto second =
      std::make_shared<const LightFieldModel>(ReadGlb(scratch_.folder / "other.glb"));
  Scene both = {{"other", second, {}}};
  both.push_back({"model", first, PlaceBeside(both, first->mesh)});
  EXPECT_EQ(State("both.json").at("models").size(), 2u);
  EXPECT_EQ(State("both.json").at("triangles"),
            first->mesh.triangles.size() + second->mesh.triangles.size());
  EXPECT_GE(Psnr(Picture("both.png"), both, CameraOf(State("both.json"))), kMinPsnrDb - 3);
  Placement placed;
  placed.world_from_model.translation = {150, 0, 0};
  placed.scale = 0.5;
  const Scene scene = {{"model", first, {}}, {"other", second, placed}};
  EXPECT_GE(Psnr(Picture("scene.png"), scene, CameraOf(State("scene_state.json"))), kMinPsnrDb - 3)
      << "silhouettes within count";
}

TEST_F(ViewerScriptCommand, ModelsAreMovedAndScenesSaved) {
  WriteFileAtomically(scratch_.folder / "scene.json",
                      R"({"models": [{"file": "model.glb"}, {"file": "model.glb",
                          "translation": [150, 0, 0], "scale": 0.5}]})");
  const CommandOutcome outcome = PlayOn(scratch_.folder / "scene.json", R"(
loaded
state {}/before.json
set place 2 40 -60 90 0 0 120 0.6
screenshot {}/moved.png
state {}/moved.json
set save scene
wait 1
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(State("moved.json").at("distance"), State("before.json").at("distance"))
      << "nothing jumps";
  const auto model = std::make_shared<const LightFieldModel>(ReadGlb(model_));
  Placement placed;
  placed.world_from_model.rotation =
      Eigen::AngleAxisd(120 * kDegree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  placed.world_from_model.translation = {40, -60, 90};
  placed.scale = 0.6;
  const Scene scene = {{"first", model, {}}, {"second", model, placed}};
  EXPECT_GE(Psnr(Picture("moved.png"), scene, CameraOf(State("moved.json"))), kMinPsnrDb - 3);
  const std::vector<SceneEntry> saved = ReadSceneFile(here_ / "lfm-viewer-scene-0001.json");
  ASSERT_EQ(saved.size(), 2u);
  EXPECT_TRUE(fs::equivalent(saved[1].file, model_));
  EXPECT_LT(
      (saved[1].placement.world_from_model.rotation - placed.world_from_model.rotation).norm(),
      1e-12);
  EXPECT_EQ(saved[1].placement.world_from_model.translation, placed.world_from_model.translation);
  EXPECT_EQ(saved[1].placement.scale, 0.6);
}

TEST_F(ViewerScriptCommand, WhatIsBeingReadIsNotLostToWhatIsDropped) {
  for (const char* name : {"a.glb", "b.glb", "c.glb"})
    fs::copy_file(model_, scratch_.folder / name);
  const CommandOutcome outcome = Play(R"(
set add-dropped on
drop {}/a.glb
drop {}/b.glb
drop {}/c.glb
loaded
state {}/joined.json
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(State("joined.json").at("models"),
            nlohmann::json::array({"model.glb", "a.glb", "b.glb", "c.glb"}));
}

TEST_F(ViewerScriptCommand, TermsAskedForAtTheStartAreShown) {
  const LightFieldModel model = ReadGlb(model_);
  const OrbitCamera orbit = MakeOrbitCamera(model.mesh, view_);
  const std::string lines = "loaded\nstate {}/state.json\nscreenshot {}/picture.png\n";
  RenderOptions options;
  ASSERT_EQ(Play(lines, {"--term-alone", "2"}).status, 0);
  EXPECT_EQ(State("state.json").at("terms"), 2);
  options.evaluation.term_alone = 1;
  EXPECT_GE(Psnr(Picture("picture.png"), SceneOf(model), orbit, options), kMinPsnrDb);
  ASSERT_EQ(Play(lines, {"--terms", "1"}).status, 0);
  EXPECT_EQ(State("state.json").at("terms"), 1);
  options.evaluation = {1};
  EXPECT_GE(Psnr(Picture("picture.png"), SceneOf(model), orbit, options), kMinPsnrDb);
}

TEST_F(ViewerScriptCommand, OverlaysFollowModelsAndShareTheirScale) {
  LightFieldModel model = ReadGlb(model_);
  model.guessed.assign(model.mesh.vertices.size() * ((model.grid * model.grid + 7) / 8), 0);
  for (size_t v = 0; v < model.mesh.vertices.size(); v += 1) {  // the half at x > 0 is guessed
    const bool guessed = model.mesh.vertices[v].x() > 10;
    const size_t bytes = (model.grid * model.grid + 7) / 8;
    std::fill_n(model.guessed.begin() + v * bytes, bytes, guessed ? 255 : 0);
  }
  WriteGlb(model, model_);
  const CommandOutcome outcome = Play(R"(
loaded
set overlay guessed
wait 1
screenshot {}/before.png
set place 1 20 -40 0 0 0 180 1
wait 1
screenshot {}/moved.png
set overlay none
wait 1
set overlay guessed
wait 1
screenshot {}/again.png
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_FALSE(Picture("before.png").Bytes() == Picture("moved.png").Bytes());
  EXPECT_EQ(Picture("moved.png").Bytes(), Picture("again.png").Bytes());
}

}  // namespace
}  // namespace lfm
