// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/studio.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>

#include "calib/board.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "core/ray_scene.h"
#include "scan/patterns.h"

namespace lfm {
namespace {

StudioOptions SmallOptions() {
  StudioOptions options;
  options.photos = 3;
  options.test_photos = 1;
  options.photo_width = 160;
  options.photo_height = 120;
  options.scans = 1;
  options.placements = 1;
  options.scan_width = 64;
  options.scan_height = 48;
  options.projector_width = 64;
  options.projector_height = 48;
  options.edge_mm = 2.5;
  options.tiny = true;
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

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "lfm_studio_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    path_ = name;
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

class StudioTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { run_ = new Shoot(RunStudio(SmallOptions())); }
  static void TearDownTestSuite() { delete run_; }
  static Shoot* run_;
};
Shoot* StudioTest::run_ = nullptr;

TEST_F(StudioTest, HandsOverEveryListedPicture) {
  const Capture& capture = run_->result.capture;
  ASSERT_EQ(capture.photos.size(), 3u);
  for (const Photo& photo : capture.photos) {
    ASSERT_TRUE(run_->pictures.contains(photo.file));
    EXPECT_FALSE(photo.camera_from_world);
    EXPECT_EQ(run_->pictures.at(photo.file).channels(), 3);
  }
  ASSERT_TRUE(capture.scanner);
  // White, black, six bits with inverses and four phase steps; with rows, twice the latter.
  EXPECT_EQ(capture.scanner->scan_roles.size(), 2u + 12 + 4);
  EXPECT_EQ(capture.scanner->placement_roles.size(), 2u + 24 + 8);
  EXPECT_EQ(SequenceFromNames(64, 48, capture.scanner->scan_roles).phase_steps, 4);
  for (const auto* sets : {&capture.scanner->scans, &capture.scanner->placements}) {
    for (const ScanSet& set : *sets) {
      EXPECT_FALSE(set.camera_from_world);
      for (const std::string& frame : set.frames) ASSERT_TRUE(run_->pictures.contains(frame));
    }
  }
  int clean = 0;
  for (const Photo& photo : run_->result.truth.photos) {
    ASSERT_TRUE(photo.camera_from_world);
    ASSERT_TRUE(run_->pictures.contains("ground_truth/" + photo.mask));
    const bool has_clean = run_->pictures.contains("ground_truth/" + photo.file);
    EXPECT_EQ(has_clean, photo.split == PhotoSplit::kTest);
    clean += has_clean;
  }
  EXPECT_EQ(clean, 1);
}

// Masks against rays cast by other code, through the true cameras at the true mesh.
TEST_F(StudioTest, MasksAgreeWithTheTrueMeshAndPoses) {
  const RayScene scene(run_->result.mesh);
  const Capture& truth = run_->result.truth;
  const Camera camera = *truth.cameras.at("photo").intrinsics;
  for (const Photo& photo : truth.photos) {
    const Image& mask = run_->pictures.at("ground_truth/" + photo.mask);
    const Pose world_from_camera = photo.camera_from_world->Inverse();
    int object = 0, different = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d direction =
            world_from_camera.rotation *
            Unproject(camera, {static_cast<double>(x), static_cast<double>(y)});
        const bool hit = scene.Intersect(world_from_camera.translation, direction).has_value();
        object += hit;
        different += hit != (mask.At<uint8_t>(x, y) == 255);
      }
    }
    EXPECT_GT(object, 1500);
    EXPECT_LE(different, object / 500);
  }
}

TEST_F(StudioTest, TestPhotographIsItsNoiseFreePicturePlusNoise) {
  for (const Photo& photo : run_->result.truth.photos) {
    if (photo.split != PhotoSplit::kTest) continue;
    const Image& clean = run_->pictures.at("ground_truth/" + photo.file);
    const Image& noisy = run_->pictures.at("photos/" + photo.id + ".png");
    double squares = 0;
    for (size_t i = 0; i < clean.size(); ++i) {
      const double d = clean.Data<uint8_t>()[i] - noisy.Data<uint8_t>()[i];
      squares += d * d;
    }
    const double rms = std::sqrt(squares / static_cast<double>(clean.size()));
    // Shot noise at 20 000 electrons is one to three levels.
    EXPECT_GT(rms, 0.5);
    EXPECT_LT(rms, 3.5);
  }
}

TEST_F(StudioTest, FewObjectPixelsSaturateAndTheDiffuseIsMidTone) {
  for (const Photo& photo : run_->result.truth.photos) {
    const Image& mask = run_->pictures.at("ground_truth/" + photo.mask);
    const Image& picture = run_->pictures.at("photos/" + photo.id + ".png");
    double sum = 0;
    int pixels = 0, saturated = 0;
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        if (mask.At<uint8_t>(x, y) == 0) continue;
        ++pixels;
        const uint8_t* p = &picture.At<uint8_t>(x, y);
        sum += (p[0] + p[1] + p[2]) / 3.0;
        saturated += std::max({p[0], p[1], p[2]}) == 255;
      }
    }
    EXPECT_GT(sum / pixels, 70);
    EXPECT_LT(sum / pixels, 170);
    EXPECT_LT(saturated, 0.01 * pixels);
  }
}

TEST_F(StudioTest, ReportsRaysAndAMonteCarloErrorBelowTheSensorsNoise) {
  const StudioReport& report = run_->result.report;
  ASSERT_EQ(report.size(), 3u);
  EXPECT_EQ(report[0].name, "baking light");
  EXPECT_GT(report[0].rays.bounce, 100'000);
  EXPECT_EQ(report[1].name, "photographs");
  EXPECT_GE(report[1].rays.camera, 3 * 160 * 120 * 4);
  EXPECT_EQ(report[2].name, "scans");
  EXPECT_GE(report[2].rays.camera, 2 * 64 * 48 * 16);
  EXPECT_GT(report[2].rays.shadow, 0);
  for (size_t i = 1; i < 3; ++i) {
    ASSERT_TRUE(report[i].noise) << report[i].name;
    EXPECT_GT(report[i].noise->MonteCarloRms(), 0) << report[i].name;
  }
  EXPECT_LT(report[1].noise->MonteCarloRms(), report[1].noise->SensorRms());
}

StudioOptions OneTinyScan() {
  StudioOptions options;
  options.tiny = true;
  options.photos = 1;
  options.test_photos = 0;
  options.scans = 1;
  options.placements = 0;
  options.photo_width = 64;
  options.photo_height = 48;
  return options;
}

// At the size that tiny scans have; at 64 x 48 a pixel is as wide as the bust's features.
TEST(Studio, ScansHaveAMonteCarloErrorBelowTheSensorsNoise) {
  const NoiseTally noise = *RunStudio(OneTinyScan()).result.report.back().noise;
  EXPECT_GT(noise.MonteCarloRms(), 0);
  EXPECT_LT(noise.MonteCarloRms(), noise.SensorRms());
}

// A coarse object has creases inside pixels.
TEST(Studio, WhiteIsNowhereDarkerThanBlack) {
  StudioOptions options = OneTinyScan();
  options.trouble.sensor.noise = SensorNoise::kOff;
  const Shoot shoot = RunStudio(options);
  const Image& white = shoot.pictures.at("scans/scan_00/white.png");
  const Image& black = shoot.pictures.at("scans/scan_00/black.png");
  int darker = 0, lit = 0;
  for (size_t i = 0; i < white.size(); ++i) {
    darker += white.Data<uint8_t>()[i] < black.Data<uint8_t>()[i];
    lit += white.Data<uint8_t>()[i] > 100;
  }
  EXPECT_EQ(darker, 0);
  EXPECT_GT(lit, 1000);
}

TEST_F(StudioTest, IsTheSameForEveryNumberOfThreads) {
  SetThreadCount(1);
  const Shoot other = RunStudio(SmallOptions());
  SetThreadCount(0);
  for (size_t i = 0; i < run_->result.report.size(); ++i) {
    const StageReport &a = run_->result.report[i], &b = other.result.report[i];
    EXPECT_EQ(a.rays.Total(), b.rays.Total());
    if (a.noise) {
      EXPECT_EQ(a.noise->MonteCarloRms(), b.noise->MonteCarloRms());
    }
  }
  ASSERT_EQ(other.pictures.size(), run_->pictures.size());
  for (const auto& [file, picture] : run_->pictures) {
    ASSERT_EQ(picture.Bytes(), other.pictures.at(file).Bytes()) << file;
  }
}

TEST(Studio, AFileInPlaceOfTheFolderIsRefusedAtOnce) {
  const TemporaryFolder folder;
  const std::filesystem::path taken = folder.path() / "taken";
  std::ofstream(taken) << "x";
  StudioOptions options;
  options.tiny = true;
  EXPECT_THROW(MakeCapture(options, taken, SilentProgress()), Error);
}

TEST(Studio, WritesACaptureThatLoads) {
  const TemporaryFolder folder;
  StudioOptions options = SmallOptions();
  options.jpeg_quality = 90;
  MakeCapture(options, folder.path() / "capture", SilentProgress());
  const Capture capture = LoadCapture(folder.path() / "capture");
  const Capture truth = LoadCapture(folder.path() / "capture" / "ground_truth");
  EXPECT_TRUE(truth.BringsGeometry());
  EXPECT_FALSE(capture.BringsGeometry());
  ASSERT_TRUE(truth.scanner && truth.scanner->projector && truth.scanner->projector_from_camera);
  EXPECT_TRUE(truth.scanner->scans.at(0).camera_from_world);
  const Board board = ReadBoard(capture.folder / capture.board);
  EXPECT_EQ(board.tags.size(), DefaultBoard().tags.size());
  EXPECT_GT(ReadPlyMesh(truth.folder / truth.mesh).triangles.size(), 1000u);
  const ImageLoader load = MakeImageLoader(capture);
  EXPECT_EQ(load(capture.photos[0].file).width(), 160);
  EXPECT_EQ(load(capture.scanner->placements[0].frames.back()).channels(), 1);
  EXPECT_TRUE(std::filesystem::exists(truth.folder / "studio.json"));
}

TEST(Studio, RendersAnyMesh) {
  const TemporaryFolder folder;
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 4}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  WritePly(mesh, folder.path() / "mesh.ply");
  StudioOptions options = SmallOptions();
  options.mesh = (folder.path() / "mesh.ply").string();
  options.scans = options.placements = 0;
  const Shoot run = RunStudio(options);
  EXPECT_FALSE(run.result.capture.scanner);
  int object = 0;
  for (const auto& [file, picture] : run.pictures) {
    if (!file.starts_with("ground_truth/masks")) continue;
    for (size_t i = 0; i < picture.size(); ++i) object += picture.Data<uint8_t>()[i] == 255;
  }
  EXPECT_GT(object, 1000);
}

// An OBJ file by the command: its picture is on the object.
TEST(Studio, StandsATexturedObjOnThePlatform) {
  const TemporaryFolder folder;
  Image picture(2, 2, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) picture.At<uint8_t>(x, y, y == 0 ? 0 : 2) = 255;  // red over blue
  }
  WriteImage(picture, folder.path() / "map.png");
  std::ofstream(folder.path() / "m.mtl") << "newmtl a\nmap_Kd map.png\nKd 1 1 1\n";
  std::ofstream(folder.path() / "m.obj")
      << "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 4\nv 1 1 1\nvt 0.5 0.25\n"
         "vt 0.5 0.75\nf 1/1 3/1 2/1\nf 1/1 2/1 4/2\nf 2/1 3/1 4/2\nf 1/1 4/2 3/1\n";
  StudioOptions options = SmallOptions();
  options.mesh = (folder.path() / "m.obj").string();
  options.scans = options.placements = 0;
  const Shoot run = RunStudio(options);
  double low_blue = 0, high_red = 0;
  int low = 0, high = 0;
  const TriangleMesh& mesh = run.result.mesh;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].z() < 10) {
      low_blue += mesh.colors[v].z() - mesh.colors[v].x();
      ++low;
    } else if (mesh.vertices[v].z() > 80) {
      high_red += mesh.colors[v].x() - mesh.colors[v].z();
      ++high;
    }
  }
  ASSERT_GT(low, 10);
  ASSERT_GT(high, 1);
  EXPECT_GT(low_blue / low, 0.3);
  EXPECT_GT(high_red / high, 0.3);
}

TEST(Studio, RejectsBadOptionsAndMeshes) {
  const TemporaryFolder folder;
  StudioOptions options = SmallOptions();
  options.test_photos = 9;
  EXPECT_THROW(RunStudio(options), Error);
  options = SmallOptions();
  options.photo_width = 0;
  EXPECT_THROW(RunStudio(options), Error);
  options = SmallOptions();
  options.mesh = (folder.path() / "absent.ply").string();
  EXPECT_THROW(RunStudio(options), Error);
  std::ofstream(folder.path() / "broken.ply") << "ply\nformat ascii 1.0\nelement vertex 99\n";
  options.mesh = (folder.path() / "broken.ply").string();
  EXPECT_THROW(RunStudio(options), Error);
}

// Stops after a few steps, as Ctrl-C would.
class StoppingProgress : public Progress {
 public:
  void Start(std::string_view what, int64_t) override { photos_ = what == "photographs"; }
  void Advance(int64_t) override {
    if (photos_) throw Interrupted();
  }
  void Note(std::string_view) override {}

 private:
  bool photos_ = false;
};

TEST(Studio, InterruptedRunLeavesNoManifestAndOnlyWholePictures) {
  const TemporaryFolder folder;
  const std::filesystem::path capture = folder.path() / "capture";
  std::filesystem::create_directories(capture);
  std::ofstream(capture / "capture.json") << "{}";
  StoppingProgress progress;
  EXPECT_THROW(MakeCapture(SmallOptions(), capture, progress), Interrupted);
  EXPECT_FALSE(std::filesystem::exists(capture / "capture.json"));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(capture)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_NO_THROW(ReadImage(entry.path())) << entry.path();
  }
}

TEST(Studio, TinyKeepsWhatIsGiven) {
  StudioOptions options;
  options.tiny = true;
  options.photos = 7;
  const StudioOptions resolved = ResolveTiny(options);
  EXPECT_EQ(resolved.photos, 7);
  EXPECT_EQ(resolved.photo_width, 320);
  EXPECT_EQ(ResolveTiny(StudioOptions()).photo_width, 960);
}

}  // namespace
}  // namespace lfm
