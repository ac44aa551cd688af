// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/truth_record.h"

#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "core/json_reader.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using nlohmann::json;

class TruthRecord : public ::testing::Test {
 protected:
  TruthRecord() {
    capture_.folder = scratch_.folder / "capture";
    capture_.photos.push_back({"p", "p.png", "hand", PhotoSplit::kTest, std::nullopt, ""});
    capture_.photos.push_back({"q", "q.png", "hand", PhotoSplit::kTrain, std::nullopt, ""});
    WriteFileAtomically(capture_.folder / "p.png", "pixels");
    WriteFileAtomically(workspace_.ModelFile(), "model");
    Save();
  }
  void Save() {
    SaveTruth(workspace_, TruthInputs(capture_, workspace_),
              {{"truth", {{"pose_median_mm", 0.1}}}, {"evaluate", {{"heldout_psnr_db", 30}}}});
  }
  ScratchFolder scratch_;
  Capture capture_;
  Workspace workspace_{scratch_.folder / "work"};
};

TEST_F(TruthRecord, IsFoundForWhatItWasFoundOn) {
  const std::optional<json> found = FindTruth(capture_, workspace_);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ((*found)["evaluate"]["heldout_psnr_db"], 30);
  EXPECT_EQ((*found)["truth"]["pose_median_mm"], 0.1);
}

TEST_F(TruthRecord, IsNotFoundForAnythingElse) {
  for (const std::filesystem::path& file :
       {workspace_.ModelFile(), workspace_.Stage("calib") / "cameras.json",
        workspace_.Stage("calib") / "poses.json", workspace_.Stage("scan") / "points.ply",
        workspace_.Stage("mesh") / "surface.ply", workspace_.Stage("mesh") / "mesh.ply",
        capture_.folder / "p.png"}) {
    Save();
    ASSERT_TRUE(FindTruth(capture_, workspace_).has_value());
    WriteFileAtomically(file, "another");
    EXPECT_FALSE(FindTruth(capture_, workspace_).has_value()) << file;
  }
  Save();
  WriteFileAtomically(capture_.folder / "q.png", "a photograph that is not scored");
  EXPECT_TRUE(FindTruth(capture_, workspace_).has_value());
}

TEST_F(TruthRecord, AbsentOrDamagedItIsNotFound) {
  for (const char* content : {"", "[]", "{}", R"({"truth": {}, "evaluate": {}})",
                              R"({"truth": {}, "evaluate": {}, "inputs": 3})"}) {
    WriteFileAtomically(workspace_.TruthFile(), content);
    EXPECT_FALSE(FindTruth(capture_, workspace_).has_value()) << content;
  }
  std::filesystem::remove(workspace_.TruthFile());
  EXPECT_FALSE(FindTruth(capture_, workspace_).has_value());
}

}  // namespace
}  // namespace lfm
