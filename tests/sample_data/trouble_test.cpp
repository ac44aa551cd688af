// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/trouble.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"
#include "sample_data/camera_path.h"
#include "sample_data/studio.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

StudioOptions SmallOptions() {
  StudioOptions options;
  options.photos = 6;
  options.test_photos = 2;
  options.photo_width = 96;
  options.photo_height = 72;
  options.scans = 2;
  options.placements = 1;
  options.scan_width = 48;
  options.scan_height = 36;
  options.projector_width = 64;
  options.projector_height = 48;
  options.edge_mm = 5;
  options.tiny = true;
  return options;
}

StudioOptions EverythingWrong() {
  StudioOptions options = SmallOptions();
  Trouble& t = options.trouble;
  t.photo.distortion = 1.5;
  t.photo.exposure_jitter_stops = 0.3;
  t.photo.white_balance_jitter_percent = 5;
  t.photo.vignetting_stops = 1;
  t.photo.motion_blur_mm = 0.5;
  t.photo.aperture_mm = 4;
  t.photo.blur_samples = 4;
  t.photo.occluded_share = 0.5;
  t.photo.half_frame_share = 0.25;
  t.photo.occluder = OccluderKind::kHand;
  t.photo.format = PhotoFormat::kPng16;
  t.sensor = {SensorNoise::kAuto, 8000, 12};
  t.platform = {0.1, 0.5, 1, 1, 0.2, 0.1};
  t.scan = {1.8, 0.8, 0.04, 1.1, 5, 0.3};
  return options;
}

struct Shoot {
  StudioResult result;
  std::map<std::string, Image> pictures;
};

Shoot RunStudio(const StudioOptions& options) {
  Shoot run;
  std::mutex mutex;
  run.result = RenderStudio(
      options,
      [&](const std::string& file, const Image& picture) {
        const std::lock_guard lock(mutex);
        EXPECT_TRUE(run.pictures.emplace(file, picture).second) << file;
      },
      SilentProgress());
  return run;
}

TEST(Trouble, EveryKnobIsValidatedAndNamesAreDistinct) {
  StudioOptions options = EverythingWrong();
  EXPECT_NO_THROW(ValidateOptions(AnyOptions(options)));
  // Names that clash would overwrite each other: as many keys as there are options.
  Trouble trouble;
  EXPECT_EQ(OptionsToJson(AnyOptions(trouble)).size(), 12u + 3 + 6 + 6);
  options.trouble.scan.projector_gamma = 0;
  EXPECT_THROW(RunStudio(options), Error);
  options = SmallOptions();
  options.trouble.photo.occluded_share = 1.1;
  EXPECT_THROW(RunStudio(options), Error);
}

TEST(MakeSensor, IsSilentAtReferenceQualityUnlessAskedForNoise) {
  const auto silent = [](const StudioOptions& options) {
    return NoiseVariance(MakeSensor(options), 0.5f) == 0;
  };
  StudioOptions options;
  EXPECT_FALSE(silent(options));
  options.trouble.sensor.noise = SensorNoise::kOff;
  EXPECT_TRUE(silent(options));
  options = {};
  options.quality = RenderQuality::kReference;
  EXPECT_TRUE(silent(options));
  options.trouble.sensor.noise = SensorNoise::kOn;
  EXPECT_FALSE(silent(options));
  EXPECT_EQ(MakeSensor(options).full_well, 20000);
  options = {};
  options.quality = RenderQuality::kReference;
  options.trouble.sensor.read_noise_electrons = 6;
  EXPECT_FALSE(silent(options));
}

// Without noise a photograph of a test view is the clean one, and a scan repeats with any seed.
TEST(MakeSensor, WithoutNoisePicturesAreClean) {
  StudioOptions options = SmallOptions();
  options.trouble.sensor.noise = SensorNoise::kOff;
  const Shoot run = RunStudio(options);
  int compared = 0;
  for (const Photo& photo : run.result.truth.photos) {
    if (photo.split != PhotoSplit::kTest) continue;
    EXPECT_EQ(run.pictures.at("ground_truth/" + photo.file).Bytes(),
              run.pictures.at("photos/" + photo.id + ".png").Bytes());
    ++compared;
  }
  EXPECT_EQ(compared, 2);
  for (const StageReport& stage : run.result.report) {
    if (stage.noise) {
      EXPECT_EQ(stage.noise->SensorRms(), 0);
    }
  }
}

// Frames of a scan on a wobbling platform show it in different places: the white frame of a scan
// that rests, and single frames off by about the wobble.
TEST(FrameWobble, MovesEachFrameByItself) {
  StudioOptions options = SmallOptions();
  options.photos = 1;
  options.test_photos = 0;
  options.placements = 0;
  options.scans = 1;
  options.scan_width = 96;
  options.scan_height = 72;
  options.trouble.sensor.noise = SensorNoise::kOff;
  const Shoot still = RunStudio(options);
  options.trouble.platform.frame_wobble_mm = 2;
  const Shoot wobbling = RunStudio(options);
  const std::vector<std::string>& frames = still.result.capture.scanner->scans[0].frames;
  const auto changed = [&](const std::string& file) {
    const Image &a = still.pictures.at(file), &b = wobbling.pictures.at(file);
    int pixels = 0;
    for (size_t i = 0; i < a.size(); ++i) {
      pixels += std::abs(a.Data<uint8_t>()[i] - b.Data<uint8_t>()[i]) > 12;
    }
    return pixels;
  };
  int moved = 0;
  for (const std::string& file : frames) {
    moved += changed(file) > 100;
    EXPECT_LT(changed(file), 96 * 72 / 2);
  }
  EXPECT_GT(moved, static_cast<int>(frames.size()) / 2);
  EXPECT_EQ(still.result.truth.scanner->scans[0].camera_from_world->translation,
            wobbling.result.truth.scanner->scans[0].camera_from_world->translation);
}

TEST(ScaleDistortion, ScalesEveryTermAndRefusesALensThatFolds) {
  const Camera usual = MakePhotoCamera(96, 72), double_it = ScaleDistortion(usual, 2);
  EXPECT_EQ(double_it.k1, 2 * usual.k1);
  EXPECT_EQ(double_it.k3, 2 * usual.k3);
  EXPECT_EQ(double_it.p2, 2 * usual.p2);
  EXPECT_EQ(double_it.fx, usual.fx);
  EXPECT_THROW(ScaleDistortion(usual, 40), Error);
}

TEST(Trouble, EverythingAtOnceIsTheSameForEveryNumberOfThreads) {
  SetThreadCount(1);
  const Shoot one = RunStudio(EverythingWrong());
  SetThreadCount(3);
  const Shoot three = RunStudio(EverythingWrong());
  SetThreadCount(0);
  ASSERT_EQ(one.pictures.size(), three.pictures.size());
  for (const auto& [file, picture] : one.pictures) {
    ASSERT_EQ(picture.Bytes(), three.pictures.at(file).Bytes()) << file;
  }
}

// The truth stays the truth: masks against rays through the stated cameras at the stated mesh.
TEST(Trouble, PosesAndMasksOfTheTruthAreThoseOfThePictures) {
  StudioOptions options = SmallOptions();
  options.scans = options.placements = 0;
  options.photos = 8;
  options.trouble.photo.half_frame_share = 0.5;
  options.trouble.photo.distortion = -1;
  options.trouble.photo.aperture_mm = 5;
  options.trouble.photo.blur_samples = 2;
  const Shoot run = RunStudio(options);
  const RayScene scene(run.result.mesh);
  const Camera camera = *run.result.truth.cameras.at("photo").intrinsics;
  EXPECT_EQ(camera.k1, 0.112);
  int halves = 0;
  for (size_t i = 0; i < 8; ++i) {
    const Photo& photo = run.result.truth.photos[i];
    halves += run.result.conditions[i].half_framed;
    const Image& mask = run.pictures.at("ground_truth/" + photo.mask);
    const Pose world_from_camera = photo.camera_from_world->Inverse();
    int object = 0, different = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const V3 direction = world_from_camera.rotation *
                             Unproject(camera, {static_cast<double>(x), static_cast<double>(y)});
        const bool hit = scene.Intersect(world_from_camera.translation, direction).has_value();
        object += hit;
        different += hit != (mask.At<uint8_t>(x, y) == 255);
      }
    }
    EXPECT_GT(object, 200);
    EXPECT_LE(different, 2 + object / 200);
  }
  EXPECT_EQ(halves, 3);  // half of the six training photographs
}

class TroubleFolder : public testing::Test {
 protected:
  TroubleFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("lfm_trouble_" + std::to_string(getpid()))) {}
  ~TroubleFolder() override { std::filesystem::remove_all(path_); }
  std::filesystem::path path_;
};

TEST_F(TroubleFolder, HoldsACaptureThatLoadsAndTheTruthAboutItsTrouble) {
  MakeCapture(EverythingWrong(), path_, SilentProgress());
  const Capture capture = LoadCapture(path_), truth = LoadCapture(path_ / "ground_truth");
  EXPECT_EQ(capture.cameras.at("photo").encoding, ColorEncoding::kLinear);
  EXPECT_FALSE(capture.cameras.at("scanner").encoding);
  const Image photo = MakeImageLoader(capture)(capture.photos[0].file);
  EXPECT_EQ(photo.type(), PixelType::kUint16);
  EXPECT_EQ(photo.encoding(), ColorEncoding::kLinear);
  const Board nominal = ReadBoard(path_ / "board.json");
  const Board printed = ReadBoard(path_ / "ground_truth/board.json");
  EXPECT_EQ(nominal.tag_size_mm, 24);
  EXPECT_NEAR(printed.tag_size_mm, 24.12, 1e-9);
  EXPECT_NE(printed.tags[3].center_mm, 1.005 * nominal.tags[3].center_mm);
  std::ifstream stream(path_ / "ground_truth/trouble.json");
  const nlohmann::json trouble = nlohmann::json::parse(stream);
  EXPECT_EQ(trouble.at("knobs").at("wobble"), 0.2);
  ASSERT_EQ(trouble.at("photos").size(), 6u);
  int occluded = 0;
  for (const auto& p : trouble.at("photos")) occluded += p.at("occluded").get<bool>();
  EXPECT_EQ(occluded, 2);
  EXPECT_TRUE(std::filesystem::exists(path_ / "ground_truth/platform.json"));
  EXPECT_TRUE(std::filesystem::exists(path_ / "ground_truth/exports/nerf/transforms.json"));
  // A clean capture in the same place says nothing of the trouble before it.
  StudioOptions clean = SmallOptions();
  clean.scans = clean.placements = 0;
  MakeCapture(clean, path_, SilentProgress());
  for (const char* name : {"trouble.json", "platform.json", "board.json"}) {
    EXPECT_FALSE(std::filesystem::exists(path_ / "ground_truth" / name)) << name;
  }
}

TEST(Studio, ProjectsEveryKindOfPattern) {
  for (PatternScheme scheme :
       {PatternScheme::kGray, PatternScheme::kMultiPhase, PatternScheme::kStripe}) {
    StudioOptions options = SmallOptions();
    options.photos = 1;
    options.test_photos = 0;
    options.scans = 1;
    options.patterns = scheme;
    options.stripe_step_px = 8;
    const Shoot run = RunStudio(options);
    const Scanner& scanner = *run.result.capture.scanner;
    PatternOptions expected;
    expected.scheme = scheme;
    expected.phase_steps = 4;
    expected.stripe.step_px = 8;
    EXPECT_EQ(scanner.scan_roles.size(),
              MakePatternSequence(64, 48, PatternRows::kWithout, expected).patterns.size());
    EXPECT_NO_THROW(SequenceFromNames(64, 48, scanner.scan_roles));
    EXPECT_NO_THROW(SequenceFromNames(64, 48, scanner.placement_roles));
    for (const std::string& file : scanner.scans[0].frames)
      EXPECT_TRUE(run.pictures.contains(file));
  }
}

}  // namespace
}  // namespace lfm
