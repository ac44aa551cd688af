// SPDX-License-Identifier: BSD-3-Clause
// The command lfm-relight: what it writes, and what it says to bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/capture.h"
#include "core/image.h"
#include "fields/light_sampling.h"
#include "fields/relightable_file.h"
#include "fields/relighting.h"
#include "tests/fields/random_relightable.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"
#include "viewer/light_plan.h"
#include "viewer/tone.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;
const std::string kLfmRelight = std::string(LFM_BIN_DIR) + "/lfm-relight";

class LfmRelightCommand : public testing::Test {
 protected:
  void SetUp() override {
    Image map(32, 16, 3, PixelType::kFloat32, ColorEncoding::kLinear);
    for (size_t i = 0; i < map.size(); ++i) {
      map.Data<float>()[i] = 0.03125f * static_cast<float>(i % 11);
    }
    WriteImage(map, environment_);
    WriteRelightable(model_, file_);
  }

  static CommandOutcome Run(std::vector<std::string> arguments,
                            const CommandSettings& settings = {}) {
    arguments.insert(arguments.begin(), kLfmRelight);
    arguments.emplace_back("--quiet");
    return RunCommand(arguments, settings);
  }

  Image Relit(const LightVector& light, int residuals = -1) const {
    const Relighter relighter(model_);
    return relighter.RelightPicture(relighter.Prepare(WithChannels(light, model_.channels)),
                                    residuals);
  }
  LightVector Surroundings(double turn_deg) const {
    return SampleProbe(MakeLightCells(model_.kind, model_.directions), ReadLightProbe(environment_),
                       turn_deg);
  }
  LightVector Lamp(const Eigen::Vector3d& to_light, double irradiance, double radius) const {
    LightVector light = SampleCap(MakeLightCells(model_.kind, model_.directions),
                                  TriangulateLights(model_.directions), to_light, radius);
    for (float& v : light.values) v *= static_cast<float>(irradiance);
    return light;
  }

  void ExpectRefusal(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& parts) const {
    const CommandOutcome outcome = Run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_TRUE(IsOneLineWith(outcome.err, parts)) << outcome.err;
    EXPECT_FALSE(fs::exists(out_));
  }

  ScratchFolder scratch_;
  RelightableModel model_ = RandomRelightable({.width = 12, .height = 7, .columns = 30});
  const std::string file_ = scratch_.folder / "model.lfr";
  const std::string environment_ = scratch_.folder / "room.exr";
  const std::string out_ = scratch_.folder / "out.png";
};

TEST_F(LfmRelightCommand, WritesWhatTheLibraryRelights) {
  ASSERT_EQ(Run({file_, out_, "--environment", environment_, "--rotate", "25"}).status, 0);
  EXPECT_TRUE(ReadImage(out_).Bytes() == ShowLinear({}, Relit(Surroundings(25))).Bytes());

  ASSERT_EQ(Run({file_, out_, "--light", "40,30", "--irradiance", "2", "--residuals", "1",
                 "--exposure", "1", "--tone", "soft"})
                .status,
            0);
  const LightVector lamp = Lamp(ParseLightDirections("40,30").at(0), 2, 0);
  EXPECT_TRUE(ReadImage(out_).Bytes() == ShowLinear({1, ToneCurve::kSoft}, Relit(lamp, 1)).Bytes());

  const std::string exr = scratch_.folder / "out.exr";
  ASSERT_EQ(Run({file_, exr, "--light", "0,-0.5,1", "--light-radius", "20", "--irradiance", "1",
                 "--exposure", "5"})
                .status,
            0);
  EXPECT_TRUE(ReadImage(exr).Bytes() == Relit(Lamp({0, -0.5, 1}, 1, 20)).Bytes());
}

TEST_F(LfmRelightCommand, AddsTheLightToTheSurroundings) {
  const std::string exr = scratch_.folder / "out.exr";
  ASSERT_EQ(
      Run({file_, exr, "--environment", environment_, "--light", "0,0,1", "--irradiance", "1"})
          .status,
      0);
  LightVector both = Surroundings(0);
  const LightVector lamp = WithChannels(Lamp({0, 0, 1}, 1, 0), 3);
  for (size_t i = 0; i < both.values.size(); ++i) both.values[i] += lamp.values[i];
  EXPECT_TRUE(ReadImage(exr).Bytes() == Relit(both).Bytes());
}

TEST_F(LfmRelightCommand, LightsGrayModelsByLuminance) {
  model_ = RandomRelightable({.width = 12, .height = 7, .channels = 1, .columns = 30});
  WriteRelightable(model_, file_);
  ASSERT_EQ(Run({file_, out_, "--environment", environment_}).status, 0);
  const Image image = ReadImage(out_);
  EXPECT_EQ(image.channels(), 1);
  EXPECT_TRUE(image.Bytes() == ShowLinear({}, Relit(Surroundings(0))).Bytes());
}

TEST_F(LfmRelightCommand, AutoExposureBringsTheBrightestToWhite) {
  ASSERT_EQ(Run({file_, out_, "--light", "0,60", "--irradiance", "1e6", "--auto-exposure"}).status,
            0);
  const Image image = ReadImage(out_);
  const auto white = std::count(image.Data<uint8_t>(), image.Data<uint8_t>() + image.size(), 255);
  EXPECT_GE(white, 1);
  EXPECT_LE(white, static_cast<long>(0.02 * static_cast<double>(image.size())) + 1);
}

TEST_F(LfmRelightCommand, WritesFilms) {
  const fs::path film = scratch_.folder / "film";
  ASSERT_EQ(Run({file_, film, "--environment", environment_, "--frames", "3"}).status, 0);
  for (int i = 0; i < 3; ++i) {
    const fs::path frame = film / ("frame_000" + std::to_string(i) + ".png");
    EXPECT_TRUE(ReadImage(frame).Bytes() == ShowLinear({}, Relit(Surroundings(120 * i))).Bytes());
  }
  EXPECT_FALSE(fs::exists(film / "frame_0003.png"));
  ASSERT_EQ(Run({file_, film, "--light", "0,10;90,10", "--frames", "2"}).status, 0);
  EXPECT_TRUE(ReadImage(film / "frame_0001.png").Bytes() ==
              ShowLinear({}, Relit(Lamp(ParseLightDirections("90,10").at(0), 3.14159265358979, 0)))
                  .Bytes());
}

TEST_F(LfmRelightCommand, RefusesBadInputInOneLine) {
  ExpectRefusal({file_, out_}, {"--environment", "--light"});
  ExpectRefusal({file_}, {"OUT"});
  ExpectRefusal({(scratch_.folder / "absent.lfr").string(), out_, "--light", "0,0"},
                {"absent.lfr"});
  ExpectRefusal({environment_, out_, "--light", "0,0"}, {"room.exr", "is not a model"});
  ExpectRefusal({file_, out_, "--light", "0"}, {"--light", "AZIMUTH"});
  ExpectRefusal({file_, out_, "--light", "0,0;9,9"}, {"--light", "--frames"});
  ExpectRefusal({file_, out_, "--light", "0,0", "--frames", "2"}, {"out.png", "folder"});
  ExpectRefusal({file_, (scratch_.folder / "out.bmp").string(), "--light", "0,0"}, {"out.bmp"});
  ExpectRefusal({file_, out_, "--light", "0,0", "--residuals", "-2"}, {"residuals"});
  ExpectRefusal({file_, out_, "--light", "0,0", "--light-radius", "181"}, {"light-radius"});
  ExpectRefusal({file_, out_, "--light", "0,0", "--irradiance", "nan"}, {"irradiance"});
  ExpectRefusal({file_, out_, "--environment", "absent.hdr"}, {"absent.hdr"});
  ExpectRefusal({file_, out_, "--environment", file_}, {"model.lfr"});
  const std::string png = scratch_.folder / "map.png";
  WriteImage(Image(4, 2, 3, PixelType::kUint8, ColorEncoding::kSrgb), png);
  ExpectRefusal({file_, out_, "--environment", png}, {"map.png", ".hdr"});
  const std::string bytes = ReadFile(file_);
  WriteFileAtomically(file_, std::string_view(bytes).substr(0, bytes.size() / 2));
  ExpectRefusal({file_, out_, "--light", "0,0"}, {"model.lfr", "should have"});
  RelightableModel vertices = model_;
  vertices.width = vertices.height = 0;
  WriteRelightable(vertices, file_);
  ExpectRefusal({file_, out_, "--light", "0,0"}, {"model.lfr", "vertices"});
  RelightableModel views = model_;
  views.kind = FieldColumns::kViews;
  WriteRelightable(views, file_);
  ExpectRefusal({file_, out_, "--light", "0,0"}, {"views"});
}

TEST_F(LfmRelightCommand, NeverReplacesTheSurroundingsNorShowsWhatIsNotFinite) {
  const std::string before = ReadFile(environment_);
  const CommandOutcome outcome = Run({file_, environment_, "--environment", environment_});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(IsOneLineWith(outcome.err, {"room.exr", "is the environment"})) << outcome.err;
  EXPECT_EQ(ReadFile(environment_), before);

  for (float& weight : model_.model.weights) weight *= 1e20f;
  WriteRelightable(model_, file_);
  ExpectRefusal({file_, out_, "--light", "0,60", "--irradiance", "1e30"},
                {"too strong", "--irradiance"});
}

TEST_F(LfmRelightCommand, WritesPagesForBrowsers) {
  const fs::path web = scratch_.folder / "web";
  ASSERT_EQ(Run({file_, web, "--web"}).status, 0);
  EXPECT_EQ(ReadFile(web / "model.lfr"), ReadFile(file_));
  for (const char* name : {"relight.html", "index.html"}) {
    const std::string page = ReadFile(web / name);
    EXPECT_NE(page.find("<title>random</title>"), std::string::npos) << name;
    EXPECT_NE(page.find("name=\"camera\" content=\"\""), std::string::npos) << name;
  }
  // Pages take the place of pages, not of a model that stands by itself.
  model_.name = "another";
  WriteRelightable(model_, file_);
  ASSERT_EQ(Run({file_, web, "--web"}).status, 0);
  EXPECT_NE(ReadFile(web / "relight.html").find("<title>another</title>"), std::string::npos);
  for (const char* name : {"relight.html", "index.html", "app.js"}) fs::remove(web / name);
  model_.name = "a third";
  WriteRelightable(model_, file_);
  ExpectRefusal({file_, web, "--web"}, {"model.lfr", "another folder"});
  const fs::path site = scratch_.folder / "site";
  WriteFileAtomically(site / "index.html", "somebody's");
  ExpectRefusal({file_, site, "--web"}, {"index.html", "another folder"});
  EXPECT_EQ(ReadFile(site / "index.html"), "somebody's");
}

TEST_F(LfmRelightCommand, PagesKnowTheCameraOfTheCapture) {
  Capture capture;
  capture.folder = scratch_.folder / "capture";
  capture.name = "a capture";
  capture.cameras["view"] = CaptureCamera{};
  capture.cameras["view"].width = 12;
  capture.cameras["view"].height = 7;
  ReflectanceField field;
  field.camera = "view";
  field.pictures.push_back({.file = "light.png"});
  field.camera_from_world = Pose{};
  field.camera_from_world->rotation << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
  capture.reflectance_field = field;
  SaveCapture(capture);
  const fs::path web = scratch_.folder / "web";
  ASSERT_EQ(Run({file_, web, "--web", "--capture", capture.folder}).status, 0);
  EXPECT_NE(ReadFile(web / "relight.html").find("content=\"0.6 -0.8 0 0.8 0.6 0 0 0 1\""),
            std::string::npos);
  capture.reflectance_field->camera_from_world.reset();
  SaveCapture(capture);
  ExpectRefusal({file_, (scratch_.folder / "other").string(), "--web", "--capture", capture.folder},
                {"camera", "--capture"});
}

TEST_F(LfmRelightCommand, PagesRefuseWhatTheyCannotShow) {
  const std::string web = scratch_.folder / "web";
  ExpectRefusal({file_, web, "--web", "--light", "0,0"}, {"--light", "--web"});
  ExpectRefusal({file_, out_, "--light", "0,0", "--capture", "x"}, {"--capture", "--web"});
  ExpectRefusal({file_, web, "--web", "--capture", "absent"}, {"absent"});
  ExpectRefusal({environment_, web, "--web"}, {"room.exr", "is not a model"});
  RelightableModel views = model_;
  views.kind = FieldColumns::kViews;
  WriteRelightable(views, file_);
  ExpectRefusal({file_, web, "--web"}, {"views"});
  model_.width = model_.height = 0;
  WriteRelightable(model_, file_);
  ExpectRefusal({file_, web, "--web"}, {"vertices"});
  EXPECT_FALSE(fs::exists(web));
}

TEST_F(LfmRelightCommand, AFullDiskLeavesNoPicture) {
  model_ = RandomRelightable({.width = 80, .height = 70, .columns = 30});
  WriteRelightable(model_, file_);
  CommandSettings settings;
  settings.max_file_bytes = 2000;
  const CommandOutcome outcome = Run({file_, out_, "--light", "0,0"}, settings);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneLineWith(outcome.err, {"out.png"})) << outcome.err;
  EXPECT_FALSE(fs::exists(out_));
}

}  // namespace
}  // namespace lfm
