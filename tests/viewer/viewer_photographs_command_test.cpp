// SPDX-License-Identifier: BSD-3-Clause
// The photographs in lfm-viewer's window, under a virtual X server.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "calib/calib_files.h"
#include "core/capture.h"
#include "viewer/camera_file.h"
#include "viewer_script_fixture.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

/// A capture of a model by two cameras whose lens distorts: the photographs are what the reference
/// renderer makes of them, one of them darker.
class ViewerPhotographsCommand : public ViewerScriptCommand {
 protected:
  void SetUp() override {
    ViewerScriptCommand::SetUp();
    view_.size = "600x240";
    const LightFieldModel model = ReadGlb(model_);
    const ReferenceRenderer renderer(model);
    Camera lens;
    lens.width = 200;
    lens.height = 160;
    lens.fx = lens.fy = 300;
    lens.cx = 103;
    lens.cy = 78;
    lens.k1 = -0.12;
    lens.p1 = 0.002;
    Capture capture;
    capture.folder = scratch_.folder / "capture";
    capture.name = "two photographs";
    capture.cameras["main"] = {lens.width, lens.height, lens};
    CalibResult calib;
    calib.cameras["main"] = lens;
    fs::create_directories(capture.folder / "photos");
    const Eigen::Vector3d center(10, -20, 80);
    for (const auto& [id, offset, split, stops] :
         {std::tuple{"photo_000", Eigen::Vector3d(0, -330, 60), PhotoSplit::kTrain, 0.0},
          {"photo_001", Eigen::Vector3d(300, 100, 120), PhotoSplit::kTest, -1.0}}) {
      const Pose pose = LookAt(center + offset, center, Eigen::Vector3d::UnitZ());
      RenderOptions options;
      options.samples_per_side = 3;
      options.tone.exposure_stops = stops;
      const std::string file = std::string("photos/") + id + ".png";
      WriteImage(renderer.Render(lens, pose, options, SilentProgress()).color,
                 capture.folder / file);
      Photo photo;
      photo.id = id;
      photo.file = file;
      photo.camera = "main";
      photo.split = split;
      photo.camera_from_world = pose;
      capture.photos.push_back(photo);
      PosedImage posed;
      posed.id = id;
      posed.file = file;
      posed.camera = "main";
      posed.split = split;
      posed.camera_from_world = pose;
      calib.photos.push_back(posed);
    }
    SaveCapture(capture);
    SaveCalib(calib, fs::path(work_) / "calib");
  }

  CommandOutcome Play(const std::string& lines, std::vector<std::string> more) {
    more.insert(more.end(), {"--background", "000000"});
    return ViewerScriptCommand::Play(lines, std::move(more));
  }

  const std::string work_ = scratch_.folder / "work", capture_ = scratch_.folder / "capture";
};

TEST_F(ViewerPhotographsCommand, StandBesideTheRenderingWithTheirDifference) {
  const CommandOutcome outcome = Play(R"(
key P
loaded
set photograph photo_000
screenshot {}/there.png
key D
wait 1
screenshot {}/compared.png
state {}/all.json
set show mean
wait 1
state {}/mean.json
set show all
set photograph photo_001
wait 1
state {}/dark.json
set exposure -1
wait 1
state {}/as_dark.json
drag left 300 60 330 60
state {}/away.json
)",
                                      {"--work", work_, "--capture", capture_});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const double all = State("all.json").at("photograph_psnr_db");
  EXPECT_GT(all, 40) << "the photograph is the model's own picture";
  EXPECT_LT(State("mean.json").at("photograph_psnr_db"), all - 10);
  const double dark = State("dark.json").at("photograph_psnr_db");
  EXPECT_LT(dark, 25);
  EXPECT_GT(State("as_dark.json").at("photograph_psnr_db"), dark + 12);
  EXPECT_EQ(State("away.json").at("photograph"), "") << "turning leaves the photograph";
  EXPECT_FALSE(State("away.json").contains("photograph_psnr_db"));
  // Three pictures side by side: the object twice, then next to nothing.
  const Image compared = Picture("compared.png");
  const auto brightness = [&](int third) {
    int64_t sum = 0;
    for (int y = 60; y < 180; ++y) {
      for (int x = 200 * third + 50; x < 200 * third + 150; ++x) {
        for (int c = 0; c < 3; ++c) sum += compared.At<uint8_t>(x, y, c);
      }
    }
    return static_cast<double>(sum) / (120 * 100 * 3);
  };
  EXPECT_NEAR(brightness(0), brightness(1), 2);
  EXPECT_GT(brightness(0), 60);
  EXPECT_LT(brightness(2), 15);
}

TEST_F(ViewerPhotographsCommand, CamerasAreDrawnPickedAndCounted) {
  // Where the other camera's frustum is seen from home, found by the function that draws it.
  ViewOptions view;
  view.size = "600x240";
  view.distance = 1500;
  const LightFieldModel model = ReadGlb(model_);
  const OrbitCamera orbit = MakeOrbitCamera(model.mesh, view);
  const Camera camera = PinholeCamera(orbit, 600, 240);
  const Pose pose = CameraFromWorld(orbit);
  const PosedCamera there = PhotoCamera(work_, "photo_000");
  const Eigen::Vector2d eye = Project(camera, pose * there.camera_from_world.Center()).value();
  const std::string at = std::to_string(eye.x() + 0.5) + " " + std::to_string(eye.y() + 0.5);
  const CommandOutcome outcome = Play(R"(
key P
loaded
screenshot {}/without.png
click left )" + at + R"(
state {}/nothing.json
wait 30
key C
screenshot {}/cameras.png
click left )" + at + R"(
state {}/picked.json
screenshot {}/there.png
set cameras off
set photograph none
set overlay photographs
state {}/counted.json
set photograph photo_999
wait 1
state {}/absent.json
)",
                                      {"--work", work_, "--distance", "1500"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_FALSE(Picture("cameras.png").Bytes() == Picture("without.png").Bytes());
  EXPECT_EQ(State("nothing.json").at("photograph"), "") << "cameras that are not shown";
  EXPECT_EQ(State("picked.json").at("photograph"), "photo_000");
  // Both cameras stand to the side: some vertices are seen by one, some by both, some by none.
  const nlohmann::json legend = State("counted.json").at("legend");
  EXPECT_EQ(legend, nlohmann::json::array({"0 photographs", "1 photographs", "2 photographs"}));
  EXPECT_EQ(State("absent.json").at("photograph"), "");
  EXPECT_NE(State("absent.json").at("message").get<std::string>().find("photo_999"),
            std::string::npos);
}

TEST_F(ViewerPhotographsCommand, FaultsNameTheFolderOrTheFile) {
  const auto expect_refusal = [&](const std::vector<std::string>& more,
                                  const std::vector<std::string>& parts) {
    const CommandOutcome outcome = Play("loaded\n", more);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(IsOneLineWith(outcome.err, parts)) << outcome.err;
  };
  expect_refusal({"--capture", capture_}, {"--capture", "--work"});
  expect_refusal({"--work", work_ + "-absent"}, {"work-absent"});
  expect_refusal({"--work", work_, "--capture", capture_ + "-absent"}, {"capture-absent"});
  // A photograph that went missing is said in the window.
  fs::remove(fs::path(capture_) / "photos" / "photo_000.png");
  const CommandOutcome outcome = Play(R"(
loaded
set photograph photo_000
set compare on
wait 1
state {}/missing.json
)",
                                      {"--work", work_, "--capture", capture_});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(State("missing.json").at("message").get<std::string>().find("photo_000.png"),
            std::string::npos);
}

}  // namespace
}  // namespace lfm
