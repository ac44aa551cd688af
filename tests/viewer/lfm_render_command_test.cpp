// SPDX-License-Identifier: BSD-3-Clause
// The command lfm-render: what it writes, and what it says to bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/calib_files.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/image_metrics.h"
#include "encode/glb.h"
#include "encode/transport_form.h"
#include "synthetic_model.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"
#include "viewer/camera_file.h"
#include "viewer/reference_renderer.h"
#include "viewer/view_options.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;
const std::string kLfmRender = std::string(LFM_BIN_DIR) + "/lfm-render";

Image Everything(int width, int height) {
  Image mask(width, height, 1, PixelType::kUint8, ColorEncoding::kLinear);
  std::fill_n(mask.Data<uint8_t>(), mask.size(), uint8_t{255});
  return mask;
}

class LfmRenderCommand : public testing::Test {
 protected:
  void SetUp() override {
    WriteGlb(MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral), model_);
  }

  static CommandOutcome Run(std::vector<std::string> arguments,
                            const CommandSettings& settings = {}) {
    arguments.insert(arguments.begin(), kLfmRender);
    arguments.emplace_back("--quiet");
    return RunCommand(arguments, settings);
  }

  /// What the library shows for the same model file.
  Rendering Expected(const PosedCamera& camera, int terms, int samples_per_side) const {
    const ReferenceRenderer renderer(ReadGlb(model_));
    RenderOptions options;
    options.evaluation.terms = terms;
    options.samples_per_side = samples_per_side;
    options.background = ParseColor(ViewOptions().background);
    return renderer.Render(camera.camera, camera.camera_from_world, options, SilentProgress());
  }

  PosedCamera OrbitView(const ViewOptions& view) const {
    const OrbitCamera orbit = MakeOrbitCamera(ReadGlb(model_).mesh, view);
    const PictureSize size = ParsePictureSize(view.size);
    return {PinholeCamera(orbit, size.width, size.height), CameraFromWorld(orbit)};
  }

  static PosedCamera LensCamera() {
    PosedCamera posed;
    posed.camera = {.width = 90, .height = 70, .fx = 150, .fy = 149, .cx = 44, .cy = 36};
    posed.camera.k1 = -0.1;
    posed.camera.p2 = 0.002;
    posed.camera_from_world = LookAt({250, 60, 160}, {10, -20, 80}, {0, 0, 1});
    return posed;
  }

  /// The command refuses with one line that holds `parts`, and leaves no file but the model.
  void ExpectRefusal(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& parts) const {
    const CommandOutcome outcome = Run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_TRUE(IsOneLineWith(outcome.err, parts)) << outcome.err;
    EXPECT_FALSE(fs::exists(out_));
  }

  ScratchFolder scratch_;
  const std::string model_ = scratch_.folder / "model.glb";
  const std::string out_ = scratch_.folder / "out.png";
};

TEST_F(LfmRenderCommand, DrawsTheTransportFormAndSaysWhatIsCutOff) {
  const LightFieldModel model = MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral);
  const std::string bytes = EncodeTransport(model, {60}).bytes;
  const std::string file = scratch_.folder / "model.lfz";
  const std::vector<std::string> arguments = {file, out_, "--size", "90x70"};
  WriteFileAtomically(file, bytes);
  ASSERT_EQ(Run(arguments).status, 0);
  const PosedCamera camera = OrbitView({.size = "90x70"});
  const Rendering expected = Expected(camera, model.terms, 2);
  EXPECT_GT(CompareImages(ReadImage(out_), expected.color, expected.coverage).psnr_db, 35);

  WriteFileAtomically(file, std::string_view(bytes).substr(0, bytes.size() - 1));
  const CommandOutcome cut = RunCommand({kLfmRender, file, out_, "--size", "90x70"}, {});
  EXPECT_EQ(cut.status, 0);
  EXPECT_NE((cut.out + cut.err).find("is cut off"), std::string::npos) << cut.out << cut.err;
  fs::remove(out_);
  WriteFileAtomically(file, std::string_view(bytes).substr(0, 100));
  ExpectRefusal(arguments, {"model.lfz", "it ends before its mean view"});
}

TEST_F(LfmRenderCommand, WritesThePictureOfTheReferenceRenderer) {
  ViewOptions view;
  view.azimuth = 40;
  view.elevation = -15;
  view.size = "100x80";
  for (const int terms : {0, 2, 3}) {
    const CommandOutcome outcome =
        Run({model_, out_, "--azimuth", "40", "--elevation", "-15", "--size", "100x80", "--terms",
             std::to_string(terms), "--supersample", "2"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(ReadImage(out_).Bytes() == Expected(OrbitView(view), terms, 2).color.Bytes());
  }
}

TEST_F(LfmRenderCommand, MeanOnlyShowsNoTerm) {
  ASSERT_EQ(Run({model_, out_, "--size", "60x50", "--mean-only", "--supersample", "1"}).status, 0);
  ViewOptions view;
  view.size = "60x50";
  EXPECT_TRUE(ReadImage(out_).Bytes() == Expected(OrbitView(view), 0, 1).color.Bytes());
}

TEST_F(LfmRenderCommand, AlphaWritesTheObjectAlone) {
  ASSERT_EQ(Run({model_, out_, "--size", "60x50", "--alpha", "--supersample", "3"}).status, 0);
  ViewOptions view;
  view.size = "60x50";
  const Image picture = ReadImage(out_);
  ASSERT_EQ(picture.channels(), 4);
  EXPECT_TRUE(picture.Bytes() == Expected(OrbitView(view), 16, 3).layer.Bytes());
}

TEST_F(LfmRenderCommand, TurntableWritesFramesOfOneTurn) {
  const fs::path folder = scratch_.folder / "turn" / "table";
  const CommandOutcome outcome = Run({model_, folder, "--turntable", "3", "--size", "60x50",
                                      "--azimuth", "10", "--supersample", "1"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  ViewOptions view;
  view.size = "60x50";
  for (int frame = 0; frame < 3; ++frame) {
    view.azimuth = 10 + 120 * frame;
    const Image picture = ReadImage(folder / ("frame_000" + std::to_string(frame) + ".png"));
    const Image expected = Expected(OrbitView(view), 16, 1).color;
    // Angles summed in another order may move a ray by rounding.
    int differ = 0;
    for (size_t i = 0; i < picture.size(); ++i) {
      differ += std::abs(picture.Data<uint8_t>()[i] - expected.Data<uint8_t>()[i]) > 1;
    }
    EXPECT_LE(differ, 6) << frame;
  }
  EXPECT_FALSE(fs::exists(folder / "frame_0003.png"));
}

TEST_F(LfmRenderCommand, RendersFromACameraFileThroughItsLens) {
  const fs::path file = scratch_.folder / "camera.json";
  WriteCameraFile(LensCamera(), file);
  ASSERT_EQ(Run({model_, out_, "--camera", file, "--supersample", "1"}).status, 0);
  EXPECT_TRUE(ReadImage(out_).Bytes() == Expected(ReadCameraFile(file), 16, 1).color.Bytes());
}

TEST_F(LfmRenderCommand, RendersFromThePhotographsCameraOfAWorkFolder) {
  CalibResult calib;
  calib.cameras["main"] = LensCamera().camera;
  PosedImage photo;
  photo.id = "photo_007";
  photo.camera = "main";
  photo.file = "photos/007.png";
  photo.camera_from_world = LensCamera().camera_from_world;
  calib.photos.push_back(photo);
  SaveCalib(calib, scratch_.folder / "work" / "calib");
  const std::string work = scratch_.folder / "work";
  ASSERT_EQ(
      Run({model_, out_, "--work", work, "--photo", "photo_007", "--supersample", "1"}).status, 0);
  const PosedCamera camera = PhotoCamera(work, "photo_007");
  EXPECT_TRUE(ReadImage(out_).Bytes() == Expected(camera, 16, 1).color.Bytes());
  fs::remove(out_);
  const fs::path folder = scratch_.folder / "views";
  ASSERT_EQ(Run({model_, folder, "--work", work, "--supersample", "1"}).status, 0);
  EXPECT_TRUE(ReadImage(folder / "photo_007.png").Bytes() == Expected(camera, 16, 1).color.Bytes());
  // Ids become names of files.
  const std::string poses = ReadFile(fs::path(work) / "calib" / "poses.json");
  std::string hostile = poses;
  hostile.replace(hostile.find("photo_007"), 9, "../../out");
  WriteFileAtomically(fs::path(work) / "calib" / "poses.json", hostile);
  ExpectRefusal({model_, folder, "--work", work}, {"poses.json", "../../out"});
  WriteFileAtomically(fs::path(work) / "calib" / "poses.json", poses);
  ExpectRefusal({model_, out_, "--work", work, "--photo", "photo_007", "--renderer", "gl"},
                {"lens", "--renderer gl"});
  ExpectRefusal({model_, out_, "--work", work, "--photo", "photo_8"}, {"photo_8", "photo_007"});
  ExpectRefusal({model_, out_, "--work", work + "-absent", "--photo", "photo_007"}, {"absent"});
}

TEST_F(LfmRenderCommand, WritesLinearLightAsExr) {
  ViewOptions view;
  view.size = "60x50";
  const Rendering expected = Expected(OrbitView(view), 16, 2);
  const fs::path file = scratch_.folder / "out.exr";
  ASSERT_EQ(Run({model_, file, "--size", "60x50"}).status, 0);
  const Image picture = ReadImage(file);
  ASSERT_EQ(picture.channels(), 3);
  ASSERT_EQ(picture.encoding(), ColorEncoding::kLinear);
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 60; ++x) {
      EXPECT_NEAR(255 * SrgbFromLinear(picture.At<float>(x, y, 1)),
                  expected.color.At<uint8_t>(x, y, 1), 0.6);
    }
  }
  ASSERT_EQ(Run({model_, file, "--size", "60x50", "--alpha"}).status, 0);
  EXPECT_EQ(ReadImage(file).channels(), 4);
}

TEST_F(LfmRenderCommand, OpenGlShowsTheSame) {
  ViewOptions view;
  view.size = "60x50";
  const Rendering expected = Expected(OrbitView(view), 16, 2);
  ASSERT_EQ(Run({model_, out_, "--size", "60x50", "--renderer", "gl"}).status, 0);
  EXPECT_GT(CompareImages(ReadImage(out_), expected.color, Everything(60, 50)).psnr_db, 35)
      << "silhouettes and all";
}

TEST_F(LfmRenderCommand, FilmsACameraPath) {
  const fs::path path = scratch_.folder / "path.json", folder = scratch_.folder / "film";
  WriteFileAtomically(path, R"({"frames_per_second": 2, "keys": [
      {"time": 0, "azimuth": 300, "elevation": 25}, {"time": 1, "azimuth": 20, "elevation": 40}]})");
  ASSERT_EQ(Run({model_, folder, "--path", path, "--size", "60x50"}).status, 0);
  ViewOptions view;
  view.size = "60x50";
  EXPECT_GT(CompareImages(ReadImage(folder / "frame_0000.png"),
                          Expected(OrbitView(view), 16, 2).color, Everything(60, 50))
                .psnr_db,
            50);
  EXPECT_TRUE(fs::exists(folder / "frame_0002.png"));
  EXPECT_FALSE(fs::exists(folder / "frame_0003.png"));
  ExpectRefusal({model_, out_, "--path", path, "--turntable", "3"}, {"exclude"});
  ExpectRefusal({model_, model_, "--path", path}, {"folder"});
  ExpectRefusal({model_, folder, "--path", scratch_.folder / "absent.json"}, {"absent.json"});
  ExpectRefusal({model_, out_, "--path", path}, {"out.png", "folder"});
}

TEST_F(LfmRenderCommand, WritesThePagesForBrowsers) {
  const fs::path folder = scratch_.folder / "web";
  ASSERT_EQ(Run({model_, folder, "--web"}).status, 0);
  EXPECT_EQ(ReadFile(folder / "model.glb"), ReadFile(model_));
  for (const char* name : {"index.html", "app.js", "model.html"}) {
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  }
  ExpectRefusal({model_, out_, "--web", "--turntable", "2"}, {"--web"});
  ExpectRefusal({model_, model_, "--web"}, {"folder"});
  ExpectRefusal({scratch_.folder / "absent.glb", folder, "--web"}, {"absent.glb"});
  ExpectRefusal({model_, folder, "--web", "--terms", "1"}, {"--terms", "--web"});
  WriteGlb(MakeSmoothRandomModel(2, DirectionMap::kHemiOctahedral),
           scratch_.folder / "other" / "model.glb");
  ExpectRefusal({model_, scratch_.folder / "other", "--web"}, {"another model"});
  WriteFileAtomically(scratch_.folder / "site" / "index.html", "somebody's");
  ExpectRefusal({model_, scratch_.folder / "site", "--web"}, {"index.html", "somebody else's"});
}

TEST_F(LfmRenderCommand, RefusesModelsThatAreNone) {
  const std::string bytes = ReadFile(model_);
  const std::string broken = scratch_.folder / "broken.glb";
  ExpectRefusal({scratch_.folder / "absent.glb", out_}, {"absent.glb"});
  ExpectRefusal({scratch_.folder, out_}, {});
  for (const size_t length :
       {size_t{0}, size_t{3}, size_t{20}, bytes.size() / 2, bytes.size() - 1}) {
    WriteFileAtomically(broken, bytes.substr(0, length));
    ExpectRefusal({broken, out_}, {"broken.glb"});
  }
  WriteFileAtomically(broken, "This is not a model but a sentence that goes on for a while.");
  ExpectRefusal({broken, out_}, {"broken.glb"});
}

TEST_F(LfmRenderCommand, RefusesBadOptions) {
  ExpectRefusal({model_}, {"lfm-render"});
  ExpectRefusal({model_, out_, "--size", "0x5"}, {"--size", "0x5"});
  ExpectRefusal({model_, out_, "--size", "100000x5"}, {"--size"});
  ExpectRefusal({model_, out_, "--background", "blue"}, {"--background", "blue"});
  ExpectRefusal({model_, out_, "--supersample", "0"}, {"supersample"});
  ExpectRefusal({model_, out_, "--supersample", "17"}, {"supersample"});
  ExpectRefusal({model_, out_, "--elevation", "91"}, {"elevation"});
  ExpectRefusal({model_, out_, "--elevation", "nan"}, {"elevation"});
  ExpectRefusal({model_, out_, "--fov", "180"}, {"fov"});
  ExpectRefusal({model_, out_, "--distance", "-3"}, {"distance"});
  ExpectRefusal({model_, out_, "--terms", "-1"}, {"terms"});
  ExpectRefusal({model_, out_, "--photo", "x"}, {"--work", "--photo"});
  ExpectRefusal({model_, out_, "--turntable", "2", "--camera", "c.json"}, {"exclude"});
  ExpectRefusal({model_, out_, "--no-such-option"}, {"no-such-option"});
  ExpectRefusal({model_, scratch_.folder / "out.bmp"}, {"out.bmp", ".png"});
  ExpectRefusal({model_, scratch_.folder / "out.jpg", "--alpha"}, {"out.jpg", ".png"});
  ExpectRefusal({model_, model_, "--turntable", "2"}, {"folder"});
}

TEST_F(LfmRenderCommand, RefusesBadCameraFiles) {
  const std::string file = scratch_.folder / "camera.json";
  WriteCameraFile(LensCamera(), file);
  const std::string good = ReadFile(file);
  const auto changed = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  for (const std::string& bad :
       {std::string(), std::string("[]"), good.substr(0, good.size() / 2),
        changed("\"width\": 90", "\"width\": 0"), changed("\"width\": 90", "\"width\": 1e9"),
        changed("\"fx\": 150", "\"fx\": -150"), changed("\"fx\": 150", "\"fx\": 1e999"),
        changed("\"fx\"", "\"focal\""), changed("\"k1\"", "\"k9\""),
        changed("\"cx\": 44", "\"cx\": \"44\""), changed("\"rotation\"", "\"turn\"")}) {
    WriteFileAtomically(file, bad);
    ExpectRefusal({model_, out_, "--camera", file}, {"camera.json"});
  }
  ExpectRefusal({model_, out_, "--camera", scratch_.folder / "absent.json"}, {"absent.json"});
}

TEST_F(LfmRenderCommand, AFullDiskLeavesNoPicture) {
  CommandSettings settings;
  settings.max_file_bytes = 2000;
  const CommandOutcome outcome = Run({model_, out_, "--size", "200x150"}, settings);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneLineWith(outcome.err, {"out.png"})) << outcome.err;
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch_.folder)) {
    EXPECT_EQ(entry.path(), fs::path(model_));
  }
}

TEST_F(LfmRenderCommand, InterruptedItLeavesNoPicture) {
  CommandSettings settings;
  settings.signal_after_seconds = 0.5;
  const CommandOutcome outcome =
      Run({model_, out_, "--size", "1000x8000", "--supersample", "16"}, settings);
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(LfmRenderCommand, ShowsATermAloneThatThereIs) {
  ASSERT_EQ(Run({model_, out_, "--size", "60x50", "--term-alone", "3"}).status, 0);
  ViewOptions view;
  view.size = "60x50";
  EXPECT_FALSE(ReadImage(out_).Bytes() == Expected(OrbitView(view), 16, 2).color.Bytes());
  fs::remove(out_);
  ExpectRefusal({model_, out_, "--term-alone", "4"}, {"--term-alone 4", "3 terms"});
  ExpectRefusal({model_, out_, "--term-alone", "1", "--mean-only"},
                {"--term-alone", "--mean-only"});
}

TEST_F(LfmRenderCommand, RendersScenesAndKeepsTheirFiles) {
  const fs::path room = scratch_.folder / "room";
  const std::string scene = room / "scene.json";
  WriteFileAtomically(scene, R"({"models": [{"file": "../model.glb"}, {"file": "../model.glb",
                                 "translation": [150, 0, 0], "scale": 0.5}]})");
  const std::string before = ReadFile(scene);
  for (const char* renderer : {"cpu", "gl"}) {
    ASSERT_EQ(Run({scene, out_, "--size", "80x60", "--renderer", renderer}).status, 0);
    EXPECT_EQ(ReadImage(out_).width(), 80);
    fs::remove(out_);
  }
  // Pages never replace what they are made of, nor what is somebody else's.
  ExpectRefusal({scene, room.string(), "--web"}, {"scene.json", "--web"});
  EXPECT_EQ(ReadFile(scene), before);
  const fs::path pages = scratch_.folder / "pages";
  WriteFileAtomically(pages / "model-2.glb", "somebody's");
  ExpectRefusal({scene, pages.string(), "--web"}, {"model-2.glb", "--web"});
  EXPECT_EQ(ReadFile(pages / "model-2.glb"), "somebody's");
  fs::remove(pages / "model-2.glb");
  EXPECT_EQ(Run({scene, pages.string(), "--web"}).status, 0);
  EXPECT_EQ(Run({scene, pages.string(), "--web"}).status, 0) << "pages replace pages";
}

}  // namespace
}  // namespace lfm
