// SPDX-License-Identifier: BSD-3-Clause
// The command lfm-resample: what it writes, and what it says to bad input.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "calib/calib_files.h"
#include "core/atomic_file.h"
#include "core/ply.h"
#include "mesh/mesh_files.h"
#include "resample/dense_light_field.h"
#include "resample/light_field.h"
#include "test_scenes.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;
const std::string kLfmResample = std::string(LFM_BIN_DIR) + "/lfm-resample";

double MeanViews(const LightField& field) {
  double views = 0;
  for (int t = 0; t < field.triangle_count(); ++t) {
    views += static_cast<double>(field.Patch(t).photos.size());
  }
  return views / field.triangle_count();
}

class LfmResampleCommand : public testing::Test {
 protected:
  /// A capture of four photographs of a sphere on disk, with its calibration and mesh.
  void SetUp() override {
    const TriangleMesh sphere = test::Sphere({0, 0, 0}, 40, 3);
    auto made = test::MakeCapture(
        sphere, test::TestCamera(120, 90, 210), test::PosesAround(4, 260),
        [](const Eigen::Vector3d&) { return Eigen::Vector3d(0.3, 0.5, 0.7); }, {0, 0, 0}, 1);
    made.capture.folder = capture_;
    made.capture.name = "sphere";
    for (const auto& [file, picture] : made.pictures) WriteImage(picture, capture_ / file);
    SaveCapture(made.capture);
    SaveCalib(made.calib, work_ / "calib");
    MeshResult mesh;
    mesh.pixel_mm = 1;
    mesh.surface = sphere;
    mesh.mesh = test::Sphere({0, 0, 0}, 40, 1);
    for (TriangleMesh* part : {&mesh.surface, &mesh.mesh}) {
      part->normals = ComputeVertexNormals(*part);
      part->confidence.assign(part->vertices.size(), 1);
    }
    mesh.surface.confidence.assign(mesh.surface.vertices.size(), 1.0F);
    SaveMesh(mesh, work_ / "mesh");
  }

  CommandOutcome Resample(std::vector<std::string> more = {},
                          const CommandSettings& settings = {}) const {
    std::vector<std::string> arguments = {kLfmResample, capture_, work_, "--view-grid", "8"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunCommand(arguments, settings);
  }

  void ExpectRefused(const CommandOutcome& outcome, int status,
                     const std::vector<std::string>& parts) const {
    EXPECT_EQ(outcome.status, status);
    EXPECT_TRUE(IsOneLineWith(outcome.err, parts)) << outcome.err;
    EXPECT_TRUE(!fs::exists(work_ / "resample") || fs::is_empty(work_ / "resample"));
  }

  ScratchFolder scratch_;
  const fs::path capture_ = scratch_.folder / "capture", work_ = scratch_.folder / "work",
                 file_ = work_ / "resample" / "light_field.lfs";
};

TEST_F(LfmResampleCommand, WritesTheLightFieldAndOnRequestTheDenseMatrix) {
  const fs::path dense = scratch_.folder / "dense.bin";
  const CommandOutcome outcome = Resample({"--quiet", "--dense", dense, "--pictures"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const LightField field = LightField::Open(file_);
  EXPECT_EQ(field.triangle_count(), 80);
  EXPECT_EQ(field.grid(), 8);
  EXPECT_GT(MeanViews(field), 0.5);
  EXPECT_EQ(ReadDenseBlock(dense, 7, 1), DenseBlock(field, 7, 1));
  int coverage = 0, sheets = 0;
  for (const auto& entry : fs::directory_iterator(work_ / "resample" / "pictures")) {
    const std::string name = entry.path().filename().string();
    coverage += name.starts_with("coverage_") ? 1 : 0;
    sheets += name.starts_with("triangle_") ? 1 : 0;
  }
  EXPECT_EQ(coverage, 3);
  EXPECT_EQ(sheets, 8);
}

TEST_F(LfmResampleCommand, TakesTheGeometryThatACaptureBrings) {
  Capture capture = LoadCapture(capture_);
  const CalibResult calib = LoadCalib(work_ / "calib");
  for (size_t i = 0; i < capture.photos.size(); ++i) {
    capture.photos[i].camera_from_world = calib.photos[i].camera_from_world;
  }
  capture.mesh = "mesh.ply";
  WritePly(test::Sphere({0, 0, 0}, 40, 2), capture_ / capture.mesh);
  SaveCapture(capture);
  fs::remove_all(work_);
  const CommandOutcome outcome = Resample({"--quiet"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(MeanViews(LightField::Open(file_)), 0.3);
}

TEST_F(LfmResampleCommand, NamesWhatIsMissingOrDamaged) {
  fs::rename(capture_ / "photo2.png", capture_ / "kept.png");
  ExpectRefused(Resample(), 2, {"photo2.png"});
  WriteFileAtomically(capture_ / "photo2.png", ReadFile(capture_ / "kept.png").substr(0, 200));
  ExpectRefused(Resample(), 2, {"photo2.png"});
  fs::rename(capture_ / "kept.png", capture_ / "photo2.png");
  EXPECT_EQ(Resample({"--quiet"}).status, 0);  // and a following run continues
}

TEST_F(LfmResampleCommand, NamesAMissingStage) {
  fs::remove_all(work_ / "mesh");
  ExpectRefused(Resample(), 2, {"mesh"});
  fs::remove_all(work_ / "calib");
  ExpectRefused(Resample(), 2, {"calib"});
  fs::remove(capture_ / "capture.json");
  ExpectRefused(Resample(), 2, {"capture.json"});
}

TEST_F(LfmResampleCommand, NamesTheOptionThatIsOutOfRange) {
  const CommandOutcome outcome = Resample({"--depth-margin-px", "-1"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("depth-margin-px"), std::string::npos) << outcome.err;
}

TEST_F(LfmResampleCommand, LeavesNothingOnAFullDisk) {
  CommandSettings settings;
  settings.max_file_bytes = 20000;
  ExpectRefused(Resample({}, settings), 1, {"light_field.lfs", "cannot be written"});
  EXPECT_EQ(Resample({"--quiet"}).status, 0);
}

}  // namespace
}  // namespace lfm
