// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/report.h"

#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "pipeline/stage_cache.h"
#include "pipeline/truth_record.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using nlohmann::json;

// A workspace whose stages each wrote one small file.
class CollectReportTest : public ::testing::Test {
 protected:
  CollectReportTest() {
    capture_.folder = scratch_.folder / "capture";
    for (const char* stage : kStages) {
      if (std::string(stage) != "report") RunStage(stage, 1);
    }
  }
  void RunStage(const std::string& stage, int knob) {
    RunOrSkip(workspace_.folder,
              {stage,
               {{"knob", knob}},
               {},
               [&](const std::filesystem::path& folder) -> json {
                 WriteFileAtomically(folder / (stage == "encode" ? "model.glb" : "result"),
                                     "made with knob " + std::to_string(knob));
                 return {{"figure", knob}};
               }},
              SilentProgress());
  }
  json Collect() const { return CollectReport(capture_, workspace_); }

  ScratchFolder scratch_;
  Capture capture_;
  Workspace workspace_{scratch_.folder / "work"};
};

TEST_F(CollectReportTest, GathersEveryStage) {
  const json report = Collect();
  for (const char* stage : {"calib", "scan", "mesh", "resample", "encode", "evaluate"}) {
    EXPECT_EQ(report[stage]["figure"], 1) << stage;
    EXPECT_EQ(report["options"][stage]["knob"], 1) << stage;
    EXPECT_TRUE(report["time"].contains(std::string(stage) + "_s")) << stage;
  }
  EXPECT_FALSE(report.contains("truth"));
}

TEST_F(CollectReportTest, TheTruthOfAnEarlierModelIsLeftOut) {
  SaveTruth(workspace_, TruthInputs(capture_, workspace_),
            {{"truth", {{"pose_median_mm", 0.1}}}, {"evaluate", {{"figure", 30}}}});
  EXPECT_EQ(Collect()["evaluate"]["figure"], 30);
  EXPECT_EQ(Collect()["truth"]["pose_median_mm"], 0.1);
  RunStage("encode", 8);
  EXPECT_EQ(Collect()["evaluate"]["figure"], 1);
  EXPECT_FALSE(Collect().contains("truth"));
}

TEST_F(CollectReportTest, AStageChangedByHandShowsNoFigures) {
  WriteFileAtomically(workspace_.ModelFile(), "made by lfm-encode");
  const json report = Collect();
  EXPECT_FALSE(report["encode"].contains("figure"));
  EXPECT_TRUE(report["encode"]["out_of_date"].is_string());
  EXPECT_FALSE(report["time"].contains("encode_s"));
  EXPECT_EQ(report["mesh"]["figure"], 1);
}

TEST_F(CollectReportTest, AMissingStageIsNamed) {
  std::filesystem::remove_all(workspace_.Stage("mesh"));
  try {
    Collect();
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("'mesh'"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace lfm
