// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>

#include "calib/calib_files.h"
#include "core/atomic_file.h"
#include "core/capture.h"
#include "core/json_reader.h"
#include "core/ply.h"
#include "mesh/mesh_files.h"
#include "tests/mesh/test_shapes.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

// A capture whose photographs and scans have been through the stages before.
struct Workspace {
  ScratchFolder scratch;
  std::filesystem::path capture = scratch.folder / "capture", work = scratch.folder / "work";

  Workspace() {
    const CalibResult calib = test::MakeCalib(12, 300, 30);
    Capture manifest;
    manifest.folder = capture;
    manifest.name = "ball";
    manifest.board = "board.json";
    manifest.cameras["camera"] = {960, 720, std::nullopt};
    for (const PosedImage& image : calib.photos) {
      Photo photo;
      photo.id = image.id;
      photo.file = image.file;
      photo.camera = image.camera;
      manifest.photos.push_back(photo);
    }
    SaveCapture(manifest);
    SaveCalib(calib, work / "calib");
    PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 30}), 20000);
    test::AddPlatform(cloud, 3000, 90, 32, 0.1, 2);
    WritePly(cloud, work / "scan" / "points.ply");
  }

  CommandOutcome Run(std::vector<std::string> options = {}) const {
    std::vector<std::string> line = {std::string(LFM_BIN_DIR) + "/lfm-mesh", capture.string(),
                                     work.string()};
    line.insert(line.end(), options.begin(), options.end());
    return RunCommand(line);
  }
};

TEST(MeshCommand, MakesTheFilesAndSaysWhatItDid) {
  const Workspace workspace;
  const CommandOutcome outcome =
      workspace.Run({"--poisson-depth", "6", "--triangle-count", "600", "--pictures"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const MeshResult result = LoadMesh(workspace.work / "mesh");
  EXPECT_TRUE(test::IsClosedManifold(result.surface));
  EXPECT_NEAR(static_cast<double>(result.mesh.triangles.size()), 600, 15);
  for (const char* name : {"surface_-60.png", "confidence_60.png", "mesh_180.png"}) {
    EXPECT_EQ(ReadImage(workspace.work / "mesh" / "pictures" / name).height(), 720) << name;
  }
}

// Makes the capture one that brings cameras, poses and a mesh.
void BringMesh(const Workspace& workspace) {
  const CalibResult calib = test::MakeCalib(12, 300, 30);
  Capture manifest = LoadCapture(workspace.capture);
  manifest.board.clear();
  manifest.mesh = "given.ply";
  manifest.cameras["camera"].intrinsics = calib.cameras.at("camera");
  for (size_t i = 0; i < manifest.photos.size(); ++i) {
    manifest.photos[i].camera_from_world = calib.photos[i].camera_from_world;
  }
  SaveCapture(manifest);
  WritePly(test::MakeSphere(30, 3, {0, 0, 30}), workspace.capture / "given.ply");
}

TEST(MeshCommand, CaptureThatBringsItsMesh) {
  const Workspace workspace;
  BringMesh(workspace);
  const CommandOutcome outcome = workspace.Run();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(LoadMesh(workspace.work / "mesh").mesh.triangles.size(), 1280u);
}

TEST(MeshCommand, PointsAreRefusedWhereTheCaptureBringsItsMesh) {
  const Workspace workspace;
  BringMesh(workspace);
  const CommandOutcome outcome =
      workspace.Run({"--points", (workspace.work / "scan" / "points.ply").string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(IsOneLineWith(outcome.err, {"--points", "points.ply", "given.ply"})) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(workspace.work / "mesh"));
}

TEST(MeshCommand, FiguresOfAnEarlierMeshGo) {
  const Workspace workspace;
  BringMesh(workspace);
  const auto folder = workspace.work / "mesh";
  const std::vector<std::string> names = {"comparison.json", "sweep.csv", "sweep.svg",
                                          "pictures/error_60.png"};
  ASSERT_EQ(
      workspace
          .Run({"--reference", (workspace.capture / "given.ply").string(), "--sweep", "--pictures"})
          .status,
      0);
  for (const std::string& name : names) EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  ASSERT_EQ(workspace.Run().status, 0);
  for (const std::string& name : names) {
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "pictures"));
  EXPECT_EQ(LoadMesh(folder).mesh.triangles.size(), 1280u);
}

// Before the work: the earlier mesh and what was measured of it stay.
TEST(MeshCommand, ABadReferenceCostsNothing) {
  const Workspace workspace;
  BringMesh(workspace);
  const auto reference = workspace.scratch.folder / "reference.ply";
  const auto kept = workspace.work / "mesh" / "comparison.json";
  WriteFileAtomically(kept, "kept");
  const auto expect = [&](const std::string& part) {
    const CommandOutcome outcome = workspace.Run({"--reference", reference.string()});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_TRUE(IsOneLineWith(outcome.err, {"reference.ply", part, "--reference takes a mesh"}))
        << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(workspace.work / "mesh" / "mesh.ply"));
    EXPECT_EQ(ReadFile(kept), "kept");
  };
  expect("");
  WriteFileAtomically(reference, "not a ply");
  expect("not a PLY file");
  WritePly(test::MeasureCloud(test::MakeSphere(30, 2), 100), reference);
  expect("cloud");
  TriangleMesh ball = test::MakeSphere(30, 2);
  ball.vertices[5].x() = 1e38;
  WritePly(ball, reference);
  expect("1e+38 mm");
  for (Eigen::Vector3d& v : ball.vertices) v.setZero();
  WritePly(ball, reference);
  expect("no area");
}

// A cloud from elsewhere: neither normals nor a scan's record.
TEST(MeshCommand, PointsOfOnesOwnComparedAndSwept) {
  const Workspace workspace;
  PointCloud bare = test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 30}), 20000);
  bare.normals.clear();
  bare.confidence.clear();
  const auto points = workspace.scratch.folder / "bare.ply";
  const auto reference = workspace.scratch.folder / "reference.ply";
  WritePly(bare, points);
  WritePly(test::MakeSphere(30, 5, {0, 0, 30}), reference);
  std::filesystem::remove_all(workspace.work / "scan");
  const CommandOutcome outcome =
      workspace.Run({"--poisson-depth", "5", "--points", points.string(), "--triangle-count", "600",
                     "--reference", reference.string(), "--threshold-mm", "0.4", "--sweep"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto folder = workspace.work / "mesh";
  const nlohmann::json record = ReadJson(folder / "mesh.json");
  EXPECT_EQ(record["method"], "poisson");
  EXPECT_GT(record["deviation_max_mm"], record["deviation_p95_mm"]);
  const nlohmann::json comparison = ReadJson(folder / "comparison.json");
  EXPECT_EQ(comparison["threshold_mm"], 0.4);
  // The base, a tenth of the ball, was not seen and is closed flat.
  EXPECT_GT(comparison["completeness"], 0.87);
  EXPECT_LT(comparison["completeness"], 0.95);
  EXPECT_GT(comparison["f_score"], 0.85);
  EXPECT_GT(std::filesystem::file_size(folder / "sweep.csv"), 200u);
  EXPECT_GT(std::filesystem::file_size(folder / "sweep.svg"), 1000u);
}

TEST(MeshCommand, BadInputIsOneLineAndStatusTwo) {
  const Workspace workspace;
  const auto points = workspace.work / "scan" / "points.ply";
  const auto expect = [&](const std::string& part, std::vector<std::string> options = {}) {
    const CommandOutcome outcome = workspace.Run(std::move(options));
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_TRUE(IsOneLineWith(outcome.err, {"lfm-mesh", part})) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(workspace.work / "mesh" / "mesh.ply"));
  };
  expect("triangle-count", {"--triangle-count", "-3"});
  expect("--triangle-count and --max-error-mm", {"--triangle-count", "500", "--max-error-mm", "1"});
  const auto own = workspace.scratch.folder / "own.ply";
  PointCloud cloud;
  cloud.points.assign(500, {1, 2, 30});
  cloud.normals.assign(500, {0, 0, 1});
  WritePly(cloud, own);
  expect("own.ply: all 500 points are the same", {"--points", own.string()});
  cloud = test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 30}), 2000);
  for (Eigen::Vector3d& p : cloud.points) p /= 1000;
  WritePly(cloud, own);
  expect("own.ply: all " + std::to_string(cloud.points.size()) + " points lie below 0.6 mm",
         {"--points", own.string()});
  std::filesystem::resize_file(points, std::filesystem::file_size(points) / 2);
  expect("points.ply");
  WritePly(PointCloud{}, points);
  expect("empty");
  WriteFileAtomically(points, "not a ply");
  expect("points.ply");
  std::filesystem::remove(points);
  expect("points.ply");
  std::filesystem::remove(workspace.capture / "capture.json");
  expect("capture.json");
}

TEST(MeshCommand, Help) {
  const CommandOutcome outcome = RunCommand({std::string(LFM_BIN_DIR) + "/lfm-mesh", "--help"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.out.find("--samples-per-triangle"), std::string::npos);
  EXPECT_NE(outcome.out.find("lfm-mesh demo/capture demo/work"), std::string::npos);
}

}  // namespace
}  // namespace lfm
