// SPDX-License-Identifier: BSD-3-Clause
// Every kind of bad input that people bring: one clear line, the right exit status, nothing
// half-written, and a following run that goes on.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "calib/board.h"
#include "core/atomic_file.h"
#include "core/image.h"
#include "core/ply.h"
#include "tests/end_to_end/small_capture.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Nothing under `folder` is a temporary or a partial result.
::testing::AssertionResult NothingHalfWritten(const fs::path& folder) {
  if (!fs::exists(folder)) return ::testing::AssertionSuccess();
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name.front() == '.') {
      return ::testing::AssertionFailure() << entry.path() << " was left behind";
    }
  }
  return ::testing::AssertionSuccess();
}

void ExpectInputError(const CommandOutcome& outcome, const std::vector<std::string>& parts) {
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_TRUE(IsOneLineWith(outcome.err, parts)) << outcome.err;
}

std::string FirstPhoto(const SmallCapture& small) {
  return small.Manifest()["photos"][0]["file"].get<std::string>();
}

json Rejected(const SmallCapture& small, const std::string& stage) {
  return ReadJson(small.work() / stage / "stage.json")["figures"]["rejected"];
}

std::string ReasonFor(const json& rejected, const std::string& id) {
  for (const json& entry : rejected) {
    if (entry["id"] == id) return entry["reason"];
  }
  return "";
}

void TruncateFile(const fs::path& file, double share) {
  fs::resize_file(file, static_cast<uintmax_t>(static_cast<double>(fs::file_size(file)) * share));
}

TEST(BadInput, AMissingPhotographIsSetAsideAndNamed) {
  const SmallCapture small;
  fs::remove(small.capture() / FirstPhoto(small));
  ASSERT_EQ(small.RunPipeline({"--to", "calib", "-q"}).status, 0);
  const json rejected = Rejected(small, "calib");
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_NE(rejected[0]["reason"].get<std::string>().find(FirstPhoto(small)), std::string::npos);
}

TEST(BadInput, AnUnreadablePhotographIsSetAsideAndNamed) {
  const SmallCapture small;
  TruncateFile(small.capture() / FirstPhoto(small), 0.4);
  ASSERT_EQ(small.RunPipeline({"--to", "calib", "-q"}).status, 0);
  EXPECT_EQ(Rejected(small, "calib").size(), 1u);
}

TEST(BadInput, APhotographWithoutTagsIsSetAsideWithThatReason) {
  const SmallCapture small;
  const json photo = small.Manifest()["photos"][0];
  const Image original = ReadImage(small.capture() / FirstPhoto(small));
  Image gray(original.width(), original.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(gray.Data<uint8_t>(), gray.size(), uint8_t{128});
  WriteImage(gray, small.capture() / FirstPhoto(small));
  ASSERT_EQ(small.RunPipeline({"--to", "calib", "-q"}).status, 0);
  EXPECT_NE(ReasonFor(Rejected(small, "calib"), photo["id"]).find("tag"), std::string::npos);
}

TEST(BadInput, AnotherBoardIsToldFromOurs) {
  const SmallCapture small;
  // The manifest describes a platform whose tags are others than the photographed ones.
  const std::string board_file = small.Manifest()["board"];
  Board board = ReadBoard(small.capture() / board_file);
  for (BoardTag& tag : board.tags) tag.id += 300;
  WriteBoard(board, small.capture() / board_file);
  ExpectInputError(small.RunPipeline({"-q"}), {"lfm-pipeline: error:"});
  EXPECT_TRUE(NothingHalfWritten(small.work()));
}

TEST(BadInput, AScanWithMissingFramesIsSetAsideAndNamed) {
  const SmallCapture small;
  const json scan = small.Manifest()["scanner"]["scans"][0];
  fs::remove(small.capture() / scan["frames"].back().get<std::string>());
  ASSERT_EQ(small.RunPipeline({"--to", "scan", "-q"}).status, 0);
  EXPECT_NE(
      ReasonFor(Rejected(small, "scan"), scan["id"]).find(scan["frames"].back().get<std::string>()),
      std::string::npos);
}

TEST(BadInput, AnEmptyCloudIsRefusedWithACure) {
  const SmallCapture small;
  ASSERT_EQ(small.RunPipeline({"--to", "scan", "-q"}).status, 0);
  WritePly(PointCloud{}, small.work() / "scan" / "points.ply");
  const CommandOutcome outcome = RunCommand(
      {SmallCapture::Command("lfm-mesh"), small.capture().string(), small.work().string(), "-q"});
  ExpectInputError(outcome, {"lfm-mesh: error:"});
  EXPECT_FALSE(fs::exists(small.work() / "mesh" / "mesh.ply"));
}

TEST(BadInput, OnePhotographIsTooFew) {
  const SmallCapture small;
  json manifest = small.Manifest();
  const json first = manifest["photos"][0];
  manifest["photos"] = json::array({first});
  small.SetManifest(manifest);
  ExpectInputError(small.RunPipeline({"-q"}), {"lfm-pipeline: error:", "photo"});
}

TEST(BadInput, AnUnknownKeyIsNamed) {
  const SmallCapture small;
  json manifest = small.Manifest();
  manifest["photoz"] = 1;
  small.SetManifest(manifest);
  ExpectInputError(small.RunPipeline({"-q"}), {"capture.json", "photoz"});
}

TEST(BadInput, AWrongTypeIsNamed) {
  const SmallCapture small;
  json manifest = small.Manifest();
  manifest["photos"][1]["file"] = 7;
  small.SetManifest(manifest);
  ExpectInputError(small.RunPipeline({"-q"}), {"capture.json", "photos[1].file"});
}

TEST(BadInput, APathThatLeavesTheCaptureIsRefused) {
  const SmallCapture small;
  json manifest = small.Manifest();
  manifest["photos"][0]["file"] = "../../etc/passwd";
  small.SetManifest(manifest);
  ExpectInputError(small.RunPipeline({"-q"}), {"capture.json", "photos[0]"});
}

TEST(BadInput, AMissingCaptureIsNamed) {
  ExpectInputError(RunCommand({SmallCapture::Command("lfm-pipeline"), "run", "/no/such/capture"}),
                   {"/no/such/capture"});
}

TEST(BadInput, ATruncatedLightFieldIsRefusedAndMadeAgain) {
  const SmallCapture small;
  ASSERT_EQ(small.RunPipeline({"--to", "encode", "-q"}).status, 0);
  const std::string model = ReadFile(small.work() / "encode" / "model.glb");
  TruncateFile(small.work() / "resample" / "light_field.lfs", 0.5);
  ExpectInputError(RunCommand({SmallCapture::Command("lfm-encode"), small.work().string(), "-q"}),
                   {"lfm-encode: error:", "light_field.lfs"});
  EXPECT_EQ(ReadFile(small.work() / "encode" / "model.glb"), model) << "nothing may be lost";
  ASSERT_EQ(small.RunPipeline({"--to", "encode", "-q"}).status, 0);
  EXPECT_EQ(ReadFile(small.work() / "encode" / "model.glb"), model);
}

TEST(BadInput, ATruncatedModelIsRefused) {
  const SmallCapture small;
  ASSERT_EQ(small.RunPipeline({"--to", "encode", "-q"}).status, 0);
  const fs::path model = small.work() / "encode" / "model.glb";
  TruncateFile(model, 0.7);
  const fs::path picture = small.work() / "picture.png";
  ExpectInputError(
      RunCommand({SmallCapture::Command("lfm-render"), model.string(), picture.string(), "-q"}),
      {"lfm-render: error:", "model.glb"});
  EXPECT_FALSE(fs::exists(picture));
}

TEST(BadInput, AFullDiskIsSaidAndTheNextRunGoesOn) {
  const SmallCapture small;
  ASSERT_EQ(small.RunPipeline({"--to", "mesh", "-q"}).status, 0);
  CommandSettings full;
  full.max_file_bytes = 100'000;  // the light field needs more
  const CommandOutcome outcome = small.RunPipeline({"--to", "resample", "-q"}, full);
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_TRUE(IsOneLineWith(outcome.err, {"lfm-pipeline: error:", "light_field.lfs"}))
      << outcome.err;
  EXPECT_TRUE(NothingHalfWritten(small.work()));
  EXPECT_FALSE(fs::exists(small.work() / "resample"));
  EXPECT_EQ(small.RunPipeline({"--to", "resample", "-q"}).status, 0);
}

}  // namespace
}  // namespace lfm
