// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

OrbitCamera Start() {
  TriangleMesh mesh;
  mesh.vertices = {{-40, -40, 0}, {40, -40, 0}, {0, 40, 90}};
  mesh.triangles = {{0, 1, 2}};
  return FrameMesh(mesh, 0.5, 1.5);
}

CameraPath Parsed(const std::string& text) {
  const ScratchFolder scratch;
  WriteFileAtomically(scratch.folder / "path.json", text);
  return ReadCameraPath(scratch.folder / "path.json", Start());
}

TEST(CameraPath, PassesThroughItsKeysWithoutWrapping) {
  const CameraPath path = Parsed(R"({"frames_per_second": 10, "keys": [
      {"time": 1, "azimuth": 350, "elevation": 10},
      {"time": 2, "azimuth": 370, "elevation": 30, "distance": 5, "target": [1, 2, 3]},
      {"time": 4, "azimuth": 1090, "elevation": -20, "distance": 90000}]})");
  const std::vector<OrbitCamera> frames = FramesOf(path);
  ASSERT_EQ(frames.size(), 31u);
  EXPECT_NEAR(frames[0].azimuth, 350 * kDegree, 1e-9);
  EXPECT_NEAR(frames[10].azimuth, 370 * kDegree, 1e-9);
  EXPECT_NEAR(frames[10].distance, 5, 1e-6);
  EXPECT_NEAR((frames[10].target - Eigen::Vector3d(1, 2, 3)).norm(), 0, 1e-9);
  EXPECT_NEAR(frames[30].azimuth, 1090 * kDegree, 1e-9);
  EXPECT_NEAR(frames[30].elevation, -20 * kDegree, 1e-9);
  EXPECT_NEAR(frames[30].distance, 90000, 1e-6);
  EXPECT_NEAR(frames[0].distance, Start().distance, 1e-6);
  // It rests at both ends and does not jump: the largest step is not far above the mean one.
  const double turned = frames[30].azimuth - frames[0].azimuth;
  for (size_t i = 1; i < frames.size(); ++i) {
    const double step = frames[i].azimuth - frames[i - 1].azimuth;
    EXPECT_GT(step, 0) << i;
    EXPECT_LT(step, 4 * turned / 30) << i;
  }
  EXPECT_LT(frames[1].azimuth - frames[0].azimuth, 0.1 * turned / 30);
}

TEST(CameraPath, OneKeyIsOneFrame) {
  const std::vector<OrbitCamera> frames =
      FramesOf(Parsed(R"({"keys": [{"time": 0, "azimuth": 20, "elevation": 5}]})"));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].azimuth, 20 * kDegree, 1e-12);
}

TEST(CameraPath, RefusesWhatIsNone) {
  const std::string key = R"({"time": 0, "azimuth": 0, "elevation": 0})";
  for (const std::string& text : std::vector<std::string>{
           "", "[]", "{}", R"({"keys": []})", R"({"keys": [{}]})", R"({"keys": 3})",
           R"({"keys": [)" + key + ", " + key + "]}",
           R"({"frames_per_second": 0, "keys": [)" + key + "]}",
           R"({"frames_per_second": 1e9, "keys": [)" + key + "]}",
           R"({"keys": [{"time": 0, "azimuth": 1e9, "elevation": 0}]})",
           R"({"keys": [{"time": 0, "azimuth": 0, "elevation": 90}]})",
           R"({"keys": [{"time": 0, "azimuth": 0, "elevation": 0, "distance": -1}]})",
           R"({"keys": [{"time": 0, "azimuth": 0, "elevation": 0, "roll": 1}]})",
           R"({"keys": [{"time": 0, "azimuth": 0, "elevation": 0, "target": [1e308, 0, 0]}]})",
           R"({"keys": [)" + key + R"(, {"time": 1e8, "azimuth": 0, "elevation": 0}]})"}) {
    try {
      Parsed(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("path.json"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace lfm
