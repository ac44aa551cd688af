// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_files.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

class ScanFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = ::testing::TempDir() + "lfm_scan_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

PointCloud SomePoints(int count, double offset) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.points.emplace_back(i + offset, 2 * i, 3.5);
    cloud.normals.emplace_back(0, 0.6, 0.8);
    cloud.confidence.push_back(0.25F * static_cast<float>(i % 4));
    cloud.sigma_mm.push_back(0.01F * static_cast<float>(i + 1));
  }
  return cloud;
}

ScanResult SomeResult() {
  ScanResult result;
  result.rig = testing::KnownRig(true);
  result.rig.camera_rms_px = 0.12;
  result.rig.projector_rms_px = 0.07;
  result.rig.condition = 1234.5;
  result.rig.projector_terms = 4;
  result.scans = {{"first", SomePoints(5, 0), testing::TurnedPlatform(0)},
                  {"second \"quoted\"", SomePoints(3, 0.5), testing::TurnedPlatform(20)}};
  result.turntables = {{{"first", "x"}, {0, 0.6, 0.8}, {1, 2, 3}, 0.012, 1.1}};
  result.registration = {true, 1, 20, 10, 0.05, 0.04, 0.07};
  result.points = SomePoints(8, 0);
  result.rejected = {{"third", "frame missing"}};
  return result;
}

void ReplaceInFile(const std::filesystem::path& file, const std::string& from,
                   const std::string& to) {
  std::string text = ReadFile(file);
  const size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  WriteFileAtomically(file, text);
}

TEST_F(ScanFiles, RoundTrip) {
  const ScanResult saved = SomeResult();
  SaveScan(saved, folder_ / "scan");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "scan/scan_01.ply"));
  const ScanResult loaded = LoadScan(folder_ / "scan");
  EXPECT_EQ(loaded.rig.projector.k1, saved.rig.projector.k1);
  EXPECT_EQ(loaded.rig.camera.cx, saved.rig.camera.cx);
  EXPECT_LT(
      (loaded.rig.projector_from_camera.rotation - saved.rig.projector_from_camera.rotation).norm(),
      1e-12);
  EXPECT_EQ(loaded.rig.projector_from_camera.translation,
            saved.rig.projector_from_camera.translation);
  EXPECT_EQ(loaded.rig.condition, 1234.5);
  ASSERT_EQ(loaded.scans.size(), 2U);
  EXPECT_EQ(loaded.scans[1].id, "second \"quoted\"");
  EXPECT_EQ(loaded.scans[1].cloud.points, saved.scans[1].cloud.points);
  EXPECT_EQ(loaded.scans[1].cloud.confidence, saved.scans[1].cloud.confidence);
  EXPECT_EQ(loaded.scans[1].cloud.sigma_mm, saved.scans[1].cloud.sigma_mm);
  EXPECT_LT(
      (loaded.scans[1].camera_from_world.Center() - testing::TurnedPlatform(20).Center()).norm(),
      1e-9);
  EXPECT_EQ(loaded.rig.projector_terms, 4);
  EXPECT_EQ(loaded.rig.source, RigSource::kPlacements);
  ASSERT_EQ(loaded.turntables.size(), 1U);
  EXPECT_EQ(loaded.turntables[0].scans, saved.turntables[0].scans);
  EXPECT_EQ(loaded.turntables[0].direction, saved.turntables[0].direction);
  EXPECT_EQ(loaded.turntables[0].chi2_per_dof, 1.1);
  EXPECT_TRUE(loaded.registration.kept);
  EXPECT_EQ(loaded.registration.held_out, 10);
  EXPECT_EQ(loaded.registration.after_mm, 0.04);
  EXPECT_EQ(loaded.points.points.size(), 8U);
  ASSERT_EQ(loaded.rejected.size(), 1U);
  EXPECT_EQ(loaded.rejected[0].reason, "frame missing");
}

TEST_F(ScanFiles, CloudsOfAnEarlierRunAreRemovedAndNothingElse) {
  SaveScan(SomeResult(), folder_);
  for (const char* other : {"scan_notes.ply", "scan_1x.ply", "points_old.ply"}) {
    WriteFileAtomically(folder_ / other, "kept");
  }
  WriteFileAtomically(folder_ / "scan_00000000000000000099.ply", "stale");
  ScanResult fewer = SomeResult();
  fewer.scans.pop_back();
  fewer.points = fewer.scans[0].cloud;
  SaveScan(fewer, folder_);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scan_02.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scan_00000000000000000099.ply"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "scan_notes.ply"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "scan_1x.ply"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "points_old.ply"));
  EXPECT_EQ(LoadScan(folder_).scans.size(), 1U);
}

TEST_F(ScanFiles, MalformedFilesAreErrors) {
  const auto expect_error = [&](const std::string& from, const std::string& to) {
    SaveScan(SomeResult(), folder_);
    ReplaceInFile(folder_ / "rig.json", from, to);
    EXPECT_THROW(LoadScan(folder_), Error) << to;
  };
  expect_error("\"condition\"", "\"conditoin\"");
  expect_error("1234.5", "-1");
  expect_error("1234.5", "1e999");
  expect_error("1234.5", "\"1234.5\"");
  expect_error("\"points\": 5", "\"points\": 6");
  expect_error("\"points\": 5", "\"points\": -5");
  expect_error("{", "[");
  expect_error("\"width\": 240", "\"width\": 0");
  expect_error("\"id\": \"first\"", "\"id\": 7");
  expect_error("\"source\": \"placements\"", "\"source\": \"guessed\"");
  expect_error("\"kept\": true", "\"kept\": 1");
  expect_error("\"projector_terms\": 4", "\"projector_terms\": 5");

  SaveScan(SomeResult(), folder_);
  std::filesystem::remove(folder_ / "scan_02.ply");
  EXPECT_THROW(LoadScan(folder_), Error);
  SaveScan(SomeResult(), folder_);
  std::filesystem::resize_file(folder_ / "points.ply",
                               std::filesystem::file_size(folder_ / "points.ply") - 1);
  EXPECT_THROW(LoadScan(folder_), Error);
  SaveScan(SomeResult(), folder_);
  WriteFileAtomically(folder_ / "rig.json", "");
  EXPECT_THROW(LoadScan(folder_), Error);
  EXPECT_THROW(LoadScan(folder_ / "nowhere"), Error);
}

TEST_F(ScanFiles, AKnownRigIsReadFromARigFile) {
  const ScanResult saved = SomeResult();
  SaveScan(saved, folder_);
  ScanOptions options;
  EXPECT_FALSE(KnownRigOf(options));
  options.rig = (folder_ / "rig.json").string();
  const auto known = KnownRigOf(options);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->projector.k1, saved.rig.projector.k1);
  EXPECT_EQ(known->camera.fx, saved.rig.camera.fx);
  EXPECT_EQ(known->projector_from_camera.translation, saved.rig.projector_from_camera.translation);
  EXPECT_EQ(known->source, options.rig);
  const auto expect_error = [&](const std::string& text) {
    WriteFileAtomically(folder_ / "rig.json", text);
    EXPECT_THROW(KnownRigOf(options), Error) << text;
  };
  const std::string whole = ReadFile(folder_ / "rig.json");
  for (size_t length : {size_t{0}, whole.size() / 4, whole.size() - 3}) {
    expect_error(whole.substr(0, length));
  }
  expect_error("[]");
  expect_error("{}");
  expect_error(R"({"camera": 1, "projector": 2, "projector_from_camera": 3})");
  std::string broken = whole;
  broken.replace(broken.find("\"fx\": "), 6, "\"fx\": -");
  expect_error(broken);
  std::filesystem::remove(folder_ / "rig.json");
  EXPECT_THROW(KnownRigOf(options), Error);
}

struct CommandRun {
  int status = -1;
  std::string output;
};

CommandRun RunCommand(const std::string& arguments) {
  const std::string line = std::string(LFM_BIN_DIR) + "/lfm-scan " + arguments + " 2>&1";
  CommandRun run;
  FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return run;
  char buffer[512];
  while (fgets(buffer, sizeof buffer, pipe) != nullptr) run.output += buffer;
  const int status = pclose(pipe);
  if (WIFEXITED(status)) run.status = WEXITSTATUS(status);
  return run;
}

TEST_F(ScanFiles, CommandExplainsItselfAndRefusesBadInputInOneLine) {
  const CommandRun help = RunCommand("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.output.find("lfm-scan demo/capture demo/work"), std::string::npos);
  EXPECT_NE(help.output.find("--min-contrast"), std::string::npos);
  EXPECT_EQ(RunCommand("").status, 2);
  for (const std::string& arguments :
       {folder_.string() + "/none " + folder_.string(), folder_.string() + " x --min-contrast 7",
        folder_.string() + " x --min-contrast nan"}) {
    const CommandRun run = RunCommand(arguments);
    EXPECT_EQ(run.status, 2) << run.output;
    EXPECT_FALSE(run.output.empty());
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace lfm
