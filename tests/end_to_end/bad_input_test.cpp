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
#include "pipeline/workspace_lock.h"
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

// A photograph, straight from above, of the print of `board`.
Image PictureOfPrint(const Board& board, int width, int height) {
  const Image print = ToRgb8(DrawBoard(board, 0.95 * height / board.height_mm));
  Image picture(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(picture.Data<uint8_t>(), picture.size(), uint8_t{200});
  const int left = (width - print.width()) / 2, top = (height - print.height()) / 2;
  for (int y = 0; y < print.height(); ++y) {
    std::copy_n(&print.At<uint8_t>(0, y), 3 * print.width(), &picture.At<uint8_t>(left, top + y));
  }
  return picture;
}

TEST(BadInput, PhotographsThatCannotBeUsedAreSetAsideEachWithItsReason) {
  const SmallCapture small;
  const json manifest = small.Manifest();
  const auto file = [&](int photo) {
    return small.capture() / manifest["photos"][photo]["file"].get<std::string>();
  };
  const Image original = ReadImage(file(0));
  fs::remove(file(0));
  TruncateFile(file(1), 0.4);
  Image gray(original.width(), original.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(gray.Data<uint8_t>(), gray.size(), uint8_t{128});
  WriteImage(gray, file(2));
  // Two boards mixed up: one with other tags, and one with the same tags in other places.
  const Board ours = ReadBoard(small.capture() / manifest["board"].get<std::string>());
  Board other = ours, shuffled = ours;
  for (BoardTag& tag : other.tags) tag.id += 300;
  for (size_t i = 0; i < ours.tags.size(); ++i) {
    shuffled.tags[i].id = ours.tags[(7 * i + 3) % ours.tags.size()].id;
  }
  WriteImage(PictureOfPrint(other, original.width(), original.height()), file(3));
  WriteImage(PictureOfPrint(shuffled, original.width(), original.height()), file(4));
  // A placement that is set aside is no photograph.
  const json placement = manifest["scanner"]["placements"][0];
  for (const json& frame : placement["frames"]) {
    fs::remove(small.capture() / frame.get<std::string>());
  }

  ASSERT_EQ(small.RunPipeline({"--to", "calib", "-q"}).status, 0);
  const json figures = ReadJson(small.work() / "calib" / "stage.json")["figures"];
  const std::pair<int, const char*> reasons[] = {
      {0, "no such file"}, {1, "truncated"}, {2, "tag"}, {3, "another board"}, {4, "mixed up"}};
  for (const auto& [photo, part] : reasons) {
    const std::string reason =
        ReasonFor(figures["rejected"], manifest["photos"][photo]["id"].get<std::string>());
    EXPECT_NE(reason.find(part), std::string::npos) << photo << ": " << reason;
    if (photo < 2) {
      EXPECT_NE(reason.find(file(photo).filename()), std::string::npos) << reason;
    }
  }
  EXPECT_NE(ReasonFor(figures["rejected"], placement["id"]), "");
  EXPECT_EQ(figures["photos_rejected"], 5);
  EXPECT_EQ(figures["scans_rejected"], 0);
  EXPECT_EQ(figures["placements_rejected"], 1);
  EXPECT_EQ(figures["photos_used"].get<size_t>(), manifest["photos"].size() - 5);
}

TEST(BadInput, AnotherBoardIsToldFromOurs) {
  const SmallCapture small;
  // The manifest describes a platform whose tags are others than the photographed ones.
  const std::string board_file = small.Manifest()["board"];
  Board board = ReadBoard(small.capture() / board_file);
  for (BoardTag& tag : board.tags) tag.id += 300;
  WriteBoard(board, small.capture() / board_file);
  ExpectInputError(small.RunPipeline({"-q"}),
                   {"lfm-pipeline: error:", "not on the board", "a picture of another board?"});
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
  small.BeginAfter({"calib", "scan"});
  WritePly(PointCloud{}, small.work() / "scan" / "points.ply");
  const CommandOutcome outcome = RunCommand(
      {SmallCapture::Command("lfm-mesh"), small.capture().string(), small.work().string(), "-q"});
  ExpectInputError(outcome,
                   {"lfm-mesh: error:", "scan/points.ply: holds 0 points where rig.json says",
                    "run lfm-scan again"});
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

TEST(BadInput, AnIdThatIsNoFileNameIsRefused) {
  const SmallCapture small;
  const fs::path outside = small.capture() / "outside";
  for (const std::string& id : {std::string("../../x"), outside.string()}) {
    json manifest = small.Manifest();
    manifest["photos"][2]["id"] = id;
    small.SetManifest(manifest);
    ExpectInputError(small.RunPipeline({"-q"}), {"capture.json", "photos[2].id"});
  }
}

TEST(BadInput, ACaptureWithoutScansIsRefusedBeforeAnyWork) {
  const SmallCapture small;
  json manifest = small.Manifest();
  manifest.erase("scanner");
  small.SetManifest(manifest);
  ExpectInputError(small.RunPipeline({"-q"}), {"capture.json", "scanner"});
  EXPECT_FALSE(fs::exists(small.work())) << "calibration must not run first";
}

TEST(BadInput, ASecondRunInOneWorkspaceIsRefused) {
  const SmallCapture small;
  const WorkspaceLock lock(small.work());
  ExpectInputError(small.RunPipeline({"-q"}), {small.work().string(), "another run"});
}

TEST(BadInput, AWorkspaceThatCannotBeWrittenIsSaidBeforeAnyWork) {
  const SmallCapture small;
  const std::string capture = small.capture(), file = small.capture() / "capture.json";
  for (const std::string& work : {file, file + "/x", std::string("/proc/x")}) {
    const std::vector<std::vector<std::string>> lines = {
        {"lfm-calib", capture, work},   {"lfm-scan", capture, work},
        {"lfm-mesh", capture, work},    {"lfm-resample", capture, work},
        {"lfm-encode", work},           {"lfm-board", work},
        {"lfm-capture", "--out", work}, {"lfm-pipeline", "run", capture, "--out", work}};
    for (std::vector<std::string> line : lines) {
      const std::string command = line[0];
      line[0] = SmallCapture::Command(command);
      ExpectInputError(RunCommand(line), {command + ": error: " + work, "nothing can be written"});
    }
  }
}

TEST(BadInput, ARunFromALaterStageOnMakesNoWorkspace) {
  const SmallCapture small;
  ExpectInputError(small.RunPipeline({"--from", "mesh", "-q"}), {"lfm-pipeline: error:", "calib"});
  EXPECT_FALSE(fs::exists(small.work()));
}

TEST(BadInput, AMissingCaptureIsNamed) {
  ExpectInputError(RunCommand({SmallCapture::Command("lfm-pipeline"), "run", "/no/such/capture"}),
                   {"/no/such/capture"});
}

TEST(BadInput, ATruncatedLightFieldIsRefusedAndMadeAgain) {
  const SmallCapture small;
  small.BeginAfter({"calib", "scan", "mesh", "resample", "encode"});
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
  small.BeginAfter({"calib", "scan", "mesh", "resample", "encode"});
  const fs::path model = small.work() / "encode" / "model.glb";
  const std::string whole = ReadFile(model);
  TruncateFile(model, 0.7);
  const fs::path picture = small.work() / "picture.png";
  ExpectInputError(
      RunCommand({SmallCapture::Command("lfm-render"), model.string(), picture.string(), "-q"}),
      {"lfm-render: error:", "model.glb"});
  EXPECT_FALSE(fs::exists(picture));
  ASSERT_EQ(small.RunPipeline({"--to", "encode", "-q"}).status, 0);
  EXPECT_EQ(ReadFile(model), whole);
}

TEST(BadInput, AFullDiskIsSaidAndTheNextRunGoesOn) {
  const SmallCapture small;
  small.BeginAfter({"calib", "scan", "mesh"});
  CommandSettings full;
  full.max_file_bytes = 100'000;  // light field and model need more
  for (const auto& [stage, file] :
       {std::pair("resample", "light_field.lfs"), std::pair("encode", "model.glb")}) {
    const CommandOutcome outcome = small.RunPipeline({"--to", stage, "-q"}, full);
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_TRUE(IsOneLineWith(outcome.err, {"lfm-pipeline: error:", file, "free some space"}))
        << outcome.err;
    EXPECT_TRUE(NothingHalfWritten(small.work()));
    EXPECT_FALSE(fs::exists(small.work() / stage));
    EXPECT_EQ(small.RunPipeline({"--to", stage, "-q"}).status, 0);
  }
}

}  // namespace
}  // namespace lfm
