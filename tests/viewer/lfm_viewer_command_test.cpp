// SPDX-License-Identifier: BSD-3-Clause
// The command lfm-viewer, under a virtual X server.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/image_metrics.h"
#include "encode/glb.h"
#include "synthetic_model.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"
#include "viewer/reference_renderer.h"
#include "viewer/view_options.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;
const std::string kLfmViewer = std::string(LFM_BIN_DIR) + "/lfm-viewer";
constexpr double kMinPsnrDb = 45;

class LfmViewerCommand : public testing::Test {
 protected:
  void SetUp() override {
    WriteGlb(MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral), model_);
  }

  static CommandOutcome RunWithDisplay(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"xvfb-run", "-a", kLfmViewer});
    return RunCommand(arguments);
  }

  static CommandOutcome RunWithoutDisplay(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {"env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", kLfmViewer});
    return RunCommand(arguments);
  }

  ScratchFolder scratch_;
  const std::string model_ = scratch_.folder / "model.glb";
  const std::string picture_ = scratch_.folder / "picture.png";
};

TEST_F(LfmViewerCommand, ScreenshotsAgreeWithTheReferenceRenderer) {
  ViewOptions view;
  view.size = "220x180";
  view.azimuth = 75;
  view.elevation = 35;
  const LightFieldModel model = ReadGlb(model_);
  const ReferenceRenderer reference(model);
  const OrbitCamera orbit = MakeOrbitCamera(model.mesh, view);
  for (const int terms : {0, 3}) {
    const CommandOutcome outcome = RunWithDisplay(
        {model_, "--screenshot", picture_, "--size", "220x180", "--azimuth", "75", "--elevation",
         "35", "--multisample", "1", "--terms", std::to_string(terms)});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    RenderOptions options;
    options.evaluation.terms = terms;
    options.background = ParseColor(view.background);
    const Rendering expected = reference.Render(PinholeCamera(orbit, 220, 180),
                                                CameraFromWorld(orbit), options, SilentProgress());
    const Image picture = ReadImage(picture_);
    ASSERT_EQ(picture.width(), 220);
    ASSERT_EQ(picture.height(), 180);
    const ImageDifference difference = CompareImages(picture, expected.color, expected.coverage);
    EXPECT_GT(difference.pixels, 4000);
    EXPECT_GE(difference.psnr_db, kMinPsnrDb) << terms << " terms";
    for (int c = 0; c < 3; ++c) {  // a corner shows the background
      EXPECT_EQ(picture.At<uint8_t>(1, 1, c), expected.color.At<uint8_t>(1, 1, c));
    }
  }
}

TEST_F(LfmViewerCommand, WireframeAndPanelAreSeenWhenAskedFor) {
  const std::vector<std::string> common = {model_, "--screenshot", picture_, "--size", "500x300"};
  const auto shoot = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = common;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandOutcome outcome = RunWithDisplay(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return ReadImage(picture_);
  };
  const Image plain = shoot({});
  EXPECT_FALSE(shoot({"--wireframe"}).Bytes() == plain.Bytes());
  const Image panel = shoot({"--with-panel"});
  // The panel covers the left top corner and nothing at the right.
  int left = 0, right = 0;
  for (int y = 20; y < 60; ++y) {
    for (int x = 0; x < 50; ++x) {
      left += panel.At<uint8_t>(20 + x, y, 2) != plain.At<uint8_t>(20 + x, y, 2);
      right += panel.At<uint8_t>(450 + x, y, 2) != plain.At<uint8_t>(450 + x, y, 2);
    }
  }
  EXPECT_GT(left, 1000);
  EXPECT_EQ(right, 0);
}

TEST_F(LfmViewerCommand, RunsUntilInterrupted) {
  const CommandOutcome outcome =
      RunCommand({"xvfb-run", "-a", "timeout", "--preserve-status", "--signal=INT", "2", kLfmViewer,
                  model_, "--size", "300x200"});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_GE(outcome.elapsed_in_seconds, 1.9);
}

TEST_F(LfmViewerCommand, SaysWhatToDoWithoutADisplay) {
  const CommandOutcome outcome = RunWithoutDisplay({model_, "--screenshot", picture_});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneLineWith(outcome.err, {"display", "xvfb-run", "lfm-render"})) << outcome.err;
  EXPECT_FALSE(fs::exists(picture_));
}

TEST_F(LfmViewerCommand, RefusesBrokenModelsAndBadOptions) {
  const std::string broken = scratch_.folder / "broken.glb";
  const std::string bytes = ReadFile(model_);
  WriteFileAtomically(broken, bytes.substr(0, bytes.size() / 2));
  const auto expect_refusal = [&](const std::vector<std::string>& arguments,
                                  const std::vector<std::string>& parts) {
    const CommandOutcome outcome = RunWithoutDisplay(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(IsOneLineWith(outcome.err, parts)) << outcome.err;
    EXPECT_FALSE(fs::exists(picture_));
  };
  expect_refusal({broken, "--screenshot", picture_}, {"broken.glb"});
  expect_refusal({scratch_.folder / "absent.glb"}, {"absent.glb"});
  expect_refusal({model_, "--screenshot", scratch_.folder / "picture.gif"},
                 {"picture.gif", ".png"});
  expect_refusal({model_, "--size", "big"}, {"--size", "big"});
  expect_refusal({model_, "--multisample", "0"}, {"multisample"});
  expect_refusal({}, {"MODEL"});
}

}  // namespace
}  // namespace lfm
