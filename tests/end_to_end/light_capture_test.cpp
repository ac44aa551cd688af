// SPDX-License-Identifier: BSD-3-Clause
// A capture that varies in light, by the commands: recorded, encoded, scored, reported.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/image.h"
#include "core/json_reader.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

std::string Command(const std::string& name) { return std::string(LFM_BIN_DIR) + "/" + name; }

TEST(LightCapture, IsEncodedScoredAndReported) {
  const ScratchFolder scratch;
  const std::string capture = scratch.folder / "plant", work = scratch.folder / "work";
  ASSERT_EQ(RunCommand(
                {Command("lfm-capture"), "--scene", "plant", "--tiny", "--quiet", "--out", capture})
                .status,
            0);
  const std::vector<std::string> run = {
      Command("lfm-pipeline"), "run", capture, "--out", work, "--clusters", "8",
      "--cluster-terms",       "3"};
  const CommandOutcome outcome = RunCommand(run);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("interpolated pictures"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("model.lfr"), std::string::npos) << outcome.out;
  const nlohmann::json report = ReadJson(fs::path(work) / "report" / "report.json");
  EXPECT_GT(report["evaluate"]["heldout_psnr_db"].get<double>(), 15);
  for (const auto& picture : report["evaluate"]["pictures"]) {
    EXPECT_NO_THROW(
        ReadImage(fs::path(work) / "report" / "pictures" / picture["file"].get<std::string>()));
  }
  EXPECT_NE(RunCommand(run).err.find("report: unchanged"), std::string::npos);
  const CommandOutcome evaluated = RunCommand({Command("lfm-evaluate"), capture, work, "-q"});
  ASSERT_EQ(evaluated.status, 0) << evaluated.err;
  EXPECT_NE(evaluated.out.find("evaluate.heldout_psnr_db"), std::string::npos);
  const CommandOutcome refused =
      RunCommand({Command("lfm-evaluate"), capture, work, "-q", "--ground-truth"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(IsOneLineWith(refused.err, {"lfm-evaluate: error: ", "held-out lights"}));
}

}  // namespace
}  // namespace lfm
