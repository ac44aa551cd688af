// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib_files.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "calib/board.h"
#include "core/error.h"
#include "error_message.h"
#include "rendered_board.h"

namespace lfm {
namespace {

class CalibFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() /
        ("lfm_calib_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Read(const std::filesystem::path& file) const {
    std::ifstream stream(folder_ / file, std::ios::binary);
    std::stringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  void Write(const std::filesystem::path& file, const std::string& text) const {
    std::ofstream(folder_ / file, std::ios::binary) << text;
  }
  std::filesystem::path folder_;
};

CalibResult SomeResult() {
  CalibResult result;
  result.cameras["photo"] = SmallCamera();
  result.cameras["photo"].k3 = 1.0 / 3;
  result.lens_terms["photo"] = 4;
  result.lens_trials["photo"] = {{0, 0.5}, {4, 0.25 / 3}, {8, INFINITY}};
  result.intrinsics_covariance["photo"] = Eigen::MatrixXd::Identity(8, 8) / 3;
  result.intrinsics_covariance["photo"](0, 7) = 0.125;
  result.platform_model = "tags moved, bent";
  result.platform_trials = {{"as printed", 0.5}, {"tags moved, bent", 0.1 / 3}};
  result.platform_shape.bend_per_mm = {1e-4 / 3, 0, -2e-5};
  result.platform_shape.shifts_mm = {{0.1, -0.2}, {1.0 / 3, 0}};
  result.reprojection_rms_px = 0.07;
  result.corner_noise_px = 0.05;
  for (int i = 0; i < 2; ++i) {
    PosedImage image;
    image.id = "photo_" + std::to_string(i);
    image.camera = "photo";
    image.file = "photos/" + image.id + ".png";
    image.camera_from_world = PosesAround(2)[i];
    image.covariance.setIdentity();
    image.covariance(0, 5) = image.covariance(5, 0) = 0.1;
    image.tags = 10 + i;
    image.corners = 90;
    image.reprojection_rms_px = 0.1 / 3;
    image.fingerprint = i == 0 ? "" : "0123456789abcdef0123456789abcdef";
    image.split = i == 0 ? PhotoSplit::kTrain : PhotoSplit::kTest;
    result.photos.push_back(image);
    result.scans.push_back(image);
    result.placements.push_back(image);
  }
  result.rejected.push_back({"x", "photos/x.png", "no tag \"found\"\n"});
  return result;
}

TEST_F(CalibFiles, RoundTrip) {
  const CalibResult result = SomeResult();
  SaveCalib(result, folder_);
  const CalibResult loaded = LoadCalib(folder_);
  const Camera &a = loaded.cameras.at("photo"), &b = result.cameras.at("photo");
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.fx, b.fx);
  EXPECT_EQ(a.fy, b.fy);
  EXPECT_EQ(a.cx, b.cx);
  EXPECT_EQ(a.cy, b.cy);
  EXPECT_EQ(a.k1, b.k1);
  EXPECT_EQ(a.k2, b.k2);
  EXPECT_EQ(a.k3, b.k3);
  EXPECT_EQ(a.p1, b.p1);
  EXPECT_EQ(a.p2, b.p2);
  EXPECT_EQ(loaded.reprojection_rms_px, result.reprojection_rms_px);
  EXPECT_EQ(loaded.corner_noise_px, result.corner_noise_px);
  EXPECT_EQ(loaded.lens_terms, result.lens_terms);
  ASSERT_EQ(loaded.lens_trials.at("photo").size(), 3u);
  EXPECT_EQ(loaded.lens_trials.at("photo")[1].terms, 4);
  EXPECT_EQ(loaded.lens_trials.at("photo")[1].heldout_rms_px, 0.25 / 3);
  EXPECT_TRUE(std::isinf(loaded.lens_trials.at("photo")[2].heldout_rms_px));
  EXPECT_EQ(loaded.intrinsics_covariance.at("photo"), result.intrinsics_covariance.at("photo"));
  EXPECT_EQ(loaded.platform_model, result.platform_model);
  ASSERT_EQ(loaded.platform_trials.size(), 2u);
  EXPECT_EQ(loaded.platform_trials[1].model, "tags moved, bent");
  EXPECT_EQ(loaded.platform_trials[1].heldout_rms_px, 0.1 / 3);
  EXPECT_EQ(loaded.platform_shape.bend_per_mm, result.platform_shape.bend_per_mm);
  EXPECT_EQ(loaded.platform_shape.shifts_mm, result.platform_shape.shifts_mm);
  for (const auto& [found, expected] :
       {std::pair(&loaded.photos, &result.photos), std::pair(&loaded.scans, &result.scans),
        std::pair(&loaded.placements, &result.placements)}) {
    ASSERT_EQ(found->size(), 2u);
    for (int i = 0; i < 2; ++i) {
      const PosedImage &f = (*found)[i], &e = (*expected)[i];
      EXPECT_EQ(f.id, e.id);
      EXPECT_EQ(f.file, e.file);
      EXPECT_EQ(f.camera, e.camera);
      EXPECT_EQ(f.split, e.split);
      EXPECT_EQ(f.fingerprint, e.fingerprint);
      EXPECT_EQ(f.tags, e.tags);
      EXPECT_EQ(f.corners, e.corners);
      EXPECT_EQ(f.covariance, e.covariance);
      EXPECT_EQ(f.reprojection_rms_px, e.reprojection_rms_px);
      EXPECT_LT(RotationAngle(f.camera_from_world.rotation, e.camera_from_world.rotation), 1e-14);
      EXPECT_EQ(f.camera_from_world.translation, e.camera_from_world.translation);
    }
  }
  ASSERT_EQ(loaded.rejected.size(), 1u);
  EXPECT_EQ(loaded.rejected[0].reason, result.rejected[0].reason);
}

TEST_F(CalibFiles, RefusesTruncatedAndHostileFiles) {
  SaveCalib(SomeResult(), folder_);
  const std::string cameras = Read("cameras.json"), poses = Read("poses.json");
  const std::string platform = Read("platform.json");
  const auto refuses = [&](const std::string& file, const std::string& good,
                           const std::string& text) {
    Write(file, text);
    EXPECT_THROW(LoadCalib(folder_), Error) << file << ":\n" << text.substr(0, 300);
    Write(file, good);
  };
  for (size_t i = 0; i < 40; ++i) {
    refuses("cameras.json", cameras, cameras.substr(0, cameras.rfind('}') * i / 40));
    refuses("poses.json", poses, poses.substr(0, poses.rfind('}') * i / 40));
    refuses("platform.json", platform, platform.substr(0, platform.rfind('}') * i / 40));
  }
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  for (const auto& [from, to] :
       {std::pair("\"width\": 480", "\"width\": 0"), std::pair("\"width\": 480", "\"width\": 1e30"),
        std::pair("522.0", "-522.0"), std::pair("522.0", "null"), std::pair("522.0", "1e999"),
        std::pair("\"k3\"", "\"k4\""), std::pair("\"photo\": 4", "\"photo\": 6"),
        std::pair("\"photo\": 4", "\"other\": 4"), std::pair("\"photo\": 4", "\"photo\": 5"),
        std::pair("\"k1 k2 p1 p2\"", "\"k1\""), std::pair("\"fx\",", "\"fy\","),
        std::pair("0.125", "1e999"), std::pair("0.125,", ""),
        std::pair("\"heldout_rms_px\": 0", "\"heldout_rms_px\": -0"),
        std::pair("\"lens_trials\"", "\"lens_trial\""),
        std::pair("\"corner_noise_px\": 0", "\"corner_noise_px\": -1")}) {
    refuses("cameras.json", cameras, changed(cameras, from, to));
  }
  for (const auto& [from, to] :
       {std::pair("\"camera\": \"photo\"", "\"camera\": \"other\""),
        std::pair("\"split\": \"train\"", "\"split\": \"both\""),
        std::pair("\"tags\": 10", "\"tags\": -1"),
        std::pair("\"id\": \"photo_1\"", "\"id\": \"photo_0\""), std::pair("\"scans\"", "\"scan\""),
        std::pair("\"reason\"", "\"reasons\""),
        std::pair("\"corners\": 90", "\"corners\": 90, \"colour\": 1")}) {
    refuses("poses.json", poses, changed(poses, from, to));
  }
  for (const auto& [from, to] :
       {std::pair("\"tags moved, bent\",", "\"flat\","), std::pair("-0.2", "\"x\""),
        std::pair("0.1,", ""), std::pair("\"bend_per_mm\"", "\"bend\""),
        std::pair("-2e-05", "1e999")}) {
    refuses("platform.json", platform, changed(platform, from, to));
  }
  EXPECT_NO_THROW(LoadCalib(folder_));
  for (const char* file : {"platform.json", "poses.json"}) {
    std::filesystem::remove(folder_ / file);
    EXPECT_THROW(LoadCalib(folder_), Error) << file;
  }
}

TEST_F(CalibFiles, RefusesAShapeThatNoPlatformHasAndNamesItsFileAndField) {
  const auto message = [&](double bend, double shift) {
    CalibResult result = SomeResult();
    result.platform_shape.bend_per_mm.y() = bend;
    result.platform_shape.shifts_mm[1].y() = shift;
    SaveCalib(result, folder_);
    return MessageOf([&] { LoadCalib(folder_); });
  };
  EXPECT_EQ(message(-1e-4, 3), "");
  for (const double bend : {1e300, -1e5, 0.01}) {
    EXPECT_NE(message(bend, 0).find("platform.json: bend_per_mm"), std::string::npos) << bend;
  }
  for (const double shift : {1e300, -1e3}) {
    EXPECT_NE(message(0, shift).find("platform.json: shifts_mm"), std::string::npos) << shift;
  }
}

TEST_F(CalibFiles, RefusesACameraThatNoLensHasAndNamesFileAndCamera) {
  CalibResult result = SomeResult();
  result.cameras["photo"].fx = 1e300;
  SaveCalib(result, folder_);
  EXPECT_NE(MessageOf([&] { LoadCalib(folder_); }).find("cameras.json: cameras.photo.fx"),
            std::string::npos);
}

TEST_F(CalibFiles, RefusesWhatIsNoCovariance) {
  const auto refuses = [&](const Eigen::Matrix<double, 6, 6>& covariance) {
    CalibResult result = SomeResult();
    result.photos[0].covariance = covariance;
    SaveCalib(result, folder_);
    try {
      LoadCalib(folder_);
      ADD_FAILURE() << covariance;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("poses.json"), std::string::npos) << error.what();
    }
  };
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
  covariance(2, 2) = -1;
  refuses(covariance);
  covariance.setIdentity();
  covariance(1, 4) = 0.5;
  refuses(covariance);
  covariance(4, 1) = 0.5, covariance(0, 5) = covariance(5, 0) = 1.5;
  refuses(covariance);
}

TEST(CalibFromCapture, TakesWhatIsGivenAndRefusesGaps) {
  Capture capture;
  capture.cameras["photo"] = {480, 360, SmallCamera()};
  Photo photo;
  photo.id = "a", photo.file = "a.png", photo.camera = "photo", photo.split = PhotoSplit::kTest;
  photo.camera_from_world = PosesAround(1)[0];
  capture.photos.push_back(photo);
  const CalibResult result = CalibFromCapture(capture);
  ASSERT_EQ(result.photos.size(), 1u);
  EXPECT_EQ(result.photos[0].split, PhotoSplit::kTest);
  EXPECT_EQ(result.photos[0].camera_from_world.translation, PosesAround(1)[0].translation);
  EXPECT_EQ(result.cameras.at("photo").fx, SmallCamera().fx);

  Capture no_pose = capture;
  no_pose.photos[0].camera_from_world.reset();
  EXPECT_THROW(CalibFromCapture(no_pose), Error);
  Capture no_intrinsics = capture;
  no_intrinsics.cameras["photo"].intrinsics.reset();
  EXPECT_THROW(CalibFromCapture(no_intrinsics), Error);
}

// A capture that brings its geometry and has a board as well: what is given wins, everywhere.
TEST_F(CalibFiles, GivenGeometryWinsOverABoardAndOverASavedCalibration) {
  Capture capture;
  capture.folder = folder_;
  capture.board = "board.json";  // not even read
  capture.mesh = "mesh.ply";
  capture.cameras["photo"] = {480, 360, SmallCamera()};
  Photo photo;
  photo.id = "a", photo.file = "a.png", photo.camera = "photo";
  photo.camera_from_world = PosesAround(2)[1];
  capture.photos.push_back(photo);
  SaveCalib(SomeResult(), folder_ / "work");
  for (const CalibResult& result : {CalibrateCapture(capture, {}, SilentProgress()),
                                    CalibOfCapture(capture, folder_ / "work")}) {
    ASSERT_EQ(result.photos.size(), 1u);
    EXPECT_EQ(result.photos[0].camera_from_world.translation, PosesAround(2)[1].translation);
  }
  capture.mesh.clear();
  EXPECT_EQ(CalibOfCapture(capture, folder_ / "work").photos.size(), 2u);
  capture.board.clear();
  EXPECT_THROW(CalibrateCapture(capture, {}, SilentProgress()), Error);
}

struct CommandResult {
  int status = -1;
  std::string output;
};

CommandResult RunCalib(const std::string& arguments) {
  CommandResult result;
  FILE* pipe = popen((std::string(LFM_BIN_DIR) + "/lfm-calib " + arguments + " 2>&1").c_str(), "r");
  char buffer[512];
  while (fgets(buffer, sizeof buffer, pipe)) result.output += buffer;
  result.status = WEXITSTATUS(pclose(pipe));
  return result;
}

TEST_F(CalibFiles, CommandCalibratesACaptureFolder) {
  const RenderedCapture rendered = RenderCapture(DefaultBoard(), 3, 1);
  Capture capture = rendered.capture;
  capture.folder = folder_ / "capture";
  std::filesystem::create_directories(capture.folder);
  WriteBoard(DefaultBoard(), capture.folder / "board.json");
  for (size_t i = 0; i < rendered.pictures.size(); ++i) {
    WriteImage(rendered.pictures[i], capture.folder / capture.photos[i].file);
  }
  Photo missing = capture.photos[0];
  missing.id = "gone", missing.file = "gone.png";
  capture.photos.push_back(missing);
  SaveCapture(capture);
  const std::string folders = capture.folder.string() + " " + (folder_ / "work").string();
  const CommandResult run = RunCalib(folders + " --pictures");
  EXPECT_EQ(run.status, 0) << run.output;
  const CalibResult result = LoadCalib(folder_ / "work" / "calib");
  EXPECT_EQ(result.photos.size(), 4u);
  ASSERT_EQ(result.rejected.size(), 1u);
  EXPECT_EQ(result.rejected[0].id, "gone");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "work/calib/pictures/photo-photo_0.png"));

  // Another capture with the same names.
  const std::filesystem::path calib = folder_ / "work" / "calib";
  EXPECT_EQ(CalibOfCapture(capture, calib).photos.size(), 4u);
  const std::filesystem::path first = capture.folder / capture.photos[0].file;
  WriteImage(rendered.pictures[1], first);
  const std::string refused = MessageOf([&] { CalibOfCapture(capture, calib); });
  EXPECT_NE(refused.find("another capture"), std::string::npos) << refused;
  EXPECT_NE(refused.find(first.string()), std::string::npos) << refused;
  std::filesystem::remove(first);
  EXPECT_EQ(CalibOfCapture(capture, calib).photos.size(), 4u);
  WriteImage(rendered.pictures[0], first);

  capture.photos.resize(1);
  SaveCapture(capture);
  std::filesystem::remove_all(folder_ / "work");
  const CommandResult one = RunCalib(folders);
  EXPECT_EQ(one.status, 2);
  EXPECT_NE(one.output.find("at least three"), std::string::npos) << one.output;
  EXPECT_EQ(std::count(one.output.begin(), one.output.end(), '\n'), 1) << one.output;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "work" / "calib" / "cameras.json"));

  Write("capture/board.json", "{\"name\": \"x\"}");
  EXPECT_EQ(RunCalib(folders).status, 2);
  EXPECT_EQ(RunCalib((folder_ / "nowhere").string() + " work").status, 2);
  EXPECT_EQ(RunCalib("").status, 2);
  EXPECT_EQ(RunCalib("--help").status, 0);
}

}  // namespace
}  // namespace lfm
