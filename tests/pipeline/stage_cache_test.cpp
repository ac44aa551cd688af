// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/stage_cache.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/progress.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

// A stage that copies its input and counts how often it really ran.
struct Copier {
  fs::path input;
  nlohmann::json options = {{"knob", 1}};
  int runs = 0;

  StageJob Job() {
    return {"copy", options, {input}, [this](const fs::path& folder) -> nlohmann::json {
              ++runs;
              WriteFileAtomically(folder / "copy.txt", ReadFile(input));
              return {{"bytes", ReadFile(input).size()}};
            }};
  }
};

class StageCache : public ::testing::Test {
 protected:
  void SetUp() override {
    copier_.input = scratch_.folder / "input.txt";
    WriteFileAtomically(copier_.input, "first");
  }
  fs::path Work() const { return scratch_.folder / "work"; }
  ScratchFolder scratch_;
  Copier copier_;
};

TEST_F(StageCache, SkipsWhatIsUnchangedAndKeepsItsFigures) {
  EXPECT_FALSE(RunOrSkip(Work(), copier_.Job()).skipped);
  const StageRecord second = RunOrSkip(Work(), copier_.Job());
  EXPECT_TRUE(second.skipped);
  EXPECT_EQ(second.figures.at("bytes"), 5);
  EXPECT_EQ(copier_.runs, 1);
}

TEST_F(StageCache, RunsAgainWhenAnInputChanges) {
  RunOrSkip(Work(), copier_.Job());
  WriteFileAtomically(copier_.input, "other");
  EXPECT_FALSE(RunOrSkip(Work(), copier_.Job()).skipped);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "other");
}

TEST_F(StageCache, RunsAgainWhenAnOptionChanges) {
  RunOrSkip(Work(), copier_.Job());
  copier_.options["knob"] = 2;
  EXPECT_FALSE(RunOrSkip(Work(), copier_.Job()).skipped);
}

TEST_F(StageCache, RunsAgainWhenAResultWasTouched) {
  RunOrSkip(Work(), copier_.Job());
  WriteFileAtomically(Work() / "copy" / "copy.txt", "damaged");
  EXPECT_FALSE(RunOrSkip(Work(), copier_.Job()).skipped);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  fs::remove(Work() / "copy" / "copy.txt");
  EXPECT_FALSE(RunOrSkip(Work(), copier_.Job()).skipped);
}

TEST_F(StageCache, SurvivesADamagedRecord) {
  RunOrSkip(Work(), copier_.Job());
  for (const char* record : {"", "{", "{}", "[1]", "{\"key\": 3}"}) {
    WriteFileAtomically(Work() / "copy" / "stage.json", record);
    EXPECT_FALSE(RunOrSkip(Work(), copier_.Job()).skipped) << record;
  }
}

TEST_F(StageCache, AFailedRunLeavesTheEarlierResultAndNothingElse) {
  RunOrSkip(Work(), copier_.Job());
  WriteFileAtomically(copier_.input, "other");
  StageJob failing = copier_.Job();
  failing.run = [](const fs::path& folder) -> nlohmann::json {
    WriteFileAtomically(folder / "copy.txt", "half");
    throw Interrupted();
  };
  EXPECT_THROW(RunOrSkip(Work(), failing), Interrupted);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  EXPECT_EQ(std::distance(fs::directory_iterator(Work()), fs::directory_iterator()), 1);
}

TEST_F(StageCache, GoesOnAfterAKilledRun) {
  // What a killed process leaves behind.
  WriteFileAtomically(Work() / ".copy.partial" / "copy.txt", "half");
  EXPECT_FALSE(RunOrSkip(Work(), copier_.Job()).skipped);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  EXPECT_FALSE(fs::exists(Work() / ".copy.partial"));
}

TEST_F(StageCache, AMissingInputIsAStateOfItsOwn) {
  StageJob job = copier_.Job();
  job.inputs.push_back(scratch_.folder / "absent.png");
  RunOrSkip(Work(), job);
  EXPECT_TRUE(RunOrSkip(Work(), job).skipped);
  WriteFileAtomically(scratch_.folder / "absent.png", "now here");
  EXPECT_FALSE(RunOrSkip(Work(), job).skipped);
}

TEST_F(StageCache, AMissingStageNamesTheCommandThatMakesIt) {
  try {
    ReadStageRecord(Work(), "mesh");
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("lfm-pipeline run"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace lfm
