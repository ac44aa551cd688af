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
#include "tests/end_to_end/tiny_capture.h"

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

std::string FirstPhoto(const TinyCapture& tiny) {
  return tiny.Manifest()["photos"][0]["file"].get<std::string>();
}

json Rejected(const TinyCapture& tiny, const std::string& stage) {
  return ReadJson(tiny.work() / stage / "stage.json")["figures"]["rejected"];
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
  const TinyCapture tiny;
  fs::remove(tiny.capture() / FirstPhoto(tiny));
  ASSERT_EQ(tiny.RunPipeline({"--to", "calib", "-q"}).status, 0);
  const json rejected = Rejected(tiny, "calib");
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_NE(rejected[0]["reason"].get<std::string>().find(FirstPhoto(tiny)), std::string::npos);
}

TEST(BadInput, AnUnreadablePhotographIsSetAsideAndNamed) {
  const TinyCapture tiny;
  TruncateFile(tiny.capture() / FirstPhoto(tiny), 0.4);
  ASSERT_EQ(tiny.RunPipeline({"--to", "calib", "-q"}).status, 0);
  EXPECT_EQ(Rejected(tiny, "calib").size(), 1u);
}

TEST(BadInput, APhotographWithoutTagsIsSetAsideWithThatReason) {
  const TinyCapture tiny;
  const json photo = tiny.Manifest()["photos"][0];
  const Image original = ReadImage(tiny.capture() / FirstPhoto(tiny));
  Image gray(original.width(), original.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(gray.Data<uint8_t>(), gray.size(), uint8_t{128});
  WriteImage(gray, tiny.capture() / FirstPhoto(tiny));
  ASSERT_EQ(tiny.RunPipeline({"--to", "calib", "-q"}).status, 0);
  EXPECT_NE(ReasonFor(Rejected(tiny, "calib"), photo["id"]).find("tag"), std::string::npos);
}

TEST(BadInput, AnotherBoardIsToldFromOurs) {
  const TinyCapture tiny;
  // The manifest describes a platform whose tags are others than the photographed ones.
  const std::string board_file = tiny.Manifest()["board"];
  Board board = ReadBoard(tiny.capture() / board_file);
  for (BoardTag& tag : board.tags) tag.id += 300;
  WriteBoard(board, tiny.capture() / board_file);
  ExpectInputError(tiny.RunPipeline({"-q"}), {"lfm-pipeline: error:"});
  EXPECT_TRUE(NothingHalfWritten(tiny.work()));
}

TEST(BadInput, AScanWithMissingFramesIsSetAsideAndNamed) {
  const TinyCapture tiny;
  const json scan = tiny.Manifest()["scanner"]["scans"][0];
  fs::remove(tiny.capture() / scan["frames"].back().get<std::string>());
  ASSERT_EQ(tiny.RunPipeline({"--to", "scan", "-q"}).status, 0);
  EXPECT_NE(
      ReasonFor(Rejected(tiny, "scan"), scan["id"]).find(scan["frames"].back().get<std::string>()),
      std::string::npos);
}

TEST(BadInput, AnEmptyCloudIsRefusedWithACure) {
  const TinyCapture tiny;
  ASSERT_EQ(tiny.RunPipeline({"--to", "scan", "-q"}).status, 0);
  WritePly(PointCloud{}, tiny.work() / "scan" / "points.ply");
  const CommandOutcome outcome = RunCommand(
      {TinyCapture::Command("lfm-mesh"), tiny.capture().string(), tiny.work().string(), "-q"});
  ExpectInputError(outcome, {"lfm-mesh: error:"});
  EXPECT_FALSE(fs::exists(tiny.work() / "mesh" / "mesh.ply"));
}

TEST(BadInput, OnePhotographIsTooFew) {
  const TinyCapture tiny;
  json manifest = tiny.Manifest();
  const json first = manifest["photos"][0];
  manifest["photos"] = json::array({first});
  tiny.SetManifest(manifest);
  ExpectInputError(tiny.RunPipeline({"-q"}), {"lfm-pipeline: error:", "photo"});
}

TEST(BadInput, AnUnknownKeyIsNamed) {
  const TinyCapture tiny;
  json manifest = tiny.Manifest();
  manifest["photoz"] = 1;
  tiny.SetManifest(manifest);
  ExpectInputError(tiny.RunPipeline({"-q"}), {"capture.json", "photoz"});
}

TEST(BadInput, AWrongTypeIsNamed) {
  const TinyCapture tiny;
  json manifest = tiny.Manifest();
  manifest["photos"][1]["file"] = 7;
  tiny.SetManifest(manifest);
  ExpectInputError(tiny.RunPipeline({"-q"}), {"capture.json", "photos[1].file"});
}

TEST(BadInput, APathThatLeavesTheCaptureIsRefused) {
  const TinyCapture tiny;
  json manifest = tiny.Manifest();
  manifest["photos"][0]["file"] = "../../etc/passwd";
  tiny.SetManifest(manifest);
  ExpectInputError(tiny.RunPipeline({"-q"}), {"capture.json", "photos[0]"});
}

TEST(BadInput, AMissingCaptureIsNamed) {
  ExpectInputError(RunCommand({TinyCapture::Command("lfm-pipeline"), "run", "/no/such/capture"}),
                   {"/no/such/capture"});
}

TEST(BadInput, ATruncatedLightFieldIsRefusedAndMadeAgain) {
  const TinyCapture tiny;
  ASSERT_EQ(tiny.RunPipeline({"--to", "encode", "-q"}).status, 0);
  const std::string model = ReadFile(tiny.work() / "encode" / "model.glb");
  TruncateFile(tiny.work() / "resample" / "light_field.lfs", 0.5);
  ExpectInputError(RunCommand({TinyCapture::Command("lfm-encode"), tiny.work().string(), "-q"}),
                   {"lfm-encode: error:", "light_field.lfs"});
  EXPECT_EQ(ReadFile(tiny.work() / "encode" / "model.glb"), model) << "nothing may be lost";
  ASSERT_EQ(tiny.RunPipeline({"--to", "encode", "-q"}).status, 0);
  EXPECT_EQ(ReadFile(tiny.work() / "encode" / "model.glb"), model);
}

TEST(BadInput, ATruncatedModelIsRefused) {
  const TinyCapture tiny;
  ASSERT_EQ(tiny.RunPipeline({"--to", "encode", "-q"}).status, 0);
  const fs::path model = tiny.work() / "encode" / "model.glb";
  TruncateFile(model, 0.7);
  const fs::path picture = tiny.work() / "picture.png";
  ExpectInputError(
      RunCommand({TinyCapture::Command("lfm-render"), model.string(), picture.string(), "-q"}),
      {"lfm-render: error:", "model.glb"});
  EXPECT_FALSE(fs::exists(picture));
}

TEST(BadInput, AFullDiskIsSaidAndTheNextRunGoesOn) {
  const TinyCapture tiny;
  ASSERT_EQ(tiny.RunPipeline({"--to", "mesh", "-q"}).status, 0);
  CommandSettings full;
  full.max_file_bytes = 100'000;  // the light field needs more
  const CommandOutcome outcome = tiny.RunPipeline({"--to", "resample", "-q"}, full);
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_TRUE(IsOneLineWith(outcome.err, {"lfm-pipeline: error:", "light_field.lfs"}))
      << outcome.err;
  EXPECT_TRUE(NothingHalfWritten(tiny.work()));
  EXPECT_FALSE(fs::exists(tiny.work() / "resample"));
  EXPECT_EQ(tiny.RunPipeline({"--to", "resample", "-q"}).status, 0);
}

}  // namespace
}  // namespace lfm
