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

// Keeps what is said in detail.
struct Listener : Progress {
  void Start(std::string_view, int64_t) override {}
  void Advance(int64_t) override {}
  void Note(std::string_view) override {}
  void Detail(std::string_view line) override { last = line; }
  std::string last;
};

class StageCache : public ::testing::Test {
 protected:
  void SetUp() override {
    copier_.input = scratch_.folder / "input.txt";
    WriteFileAtomically(copier_.input, "first");
  }
  fs::path Work() const { return scratch_.folder / "work"; }
  StageRecord Run(const StageJob& job) { return RunOrSkip(Work(), job, talk_); }
  ScratchFolder scratch_;
  Copier copier_;
  Listener talk_;
};

TEST_F(StageCache, SkipsWhatIsUnchangedAndKeepsItsFigures) {
  EXPECT_FALSE(Run(copier_.Job()).skipped);
  const StageRecord second = Run(copier_.Job());
  EXPECT_TRUE(second.skipped);
  EXPECT_EQ(second.figures.at("bytes"), 5);
  EXPECT_EQ(copier_.runs, 1);
}

TEST_F(StageCache, RunsAgainWhenAnInputChanges) {
  Run(copier_.Job());
  WriteFileAtomically(copier_.input, "other");
  EXPECT_FALSE(Run(copier_.Job()).skipped);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "other");
}

TEST_F(StageCache, RunsAgainWhenAnOptionChanges) {
  Run(copier_.Job());
  copier_.options["knob"] = 2;
  EXPECT_FALSE(Run(copier_.Job()).skipped);
}

TEST_F(StageCache, RunsAgainWhenAResultWasTouched) {
  Run(copier_.Job());
  WriteFileAtomically(Work() / "copy" / "copy.txt", "damaged");
  EXPECT_FALSE(Run(copier_.Job()).skipped);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  fs::remove(Work() / "copy" / "copy.txt");
  EXPECT_FALSE(Run(copier_.Job()).skipped);
}

TEST_F(StageCache, SurvivesADamagedRecord) {
  Run(copier_.Job());
  for (const char* record : {"", "{", "{}", "[1]", "{\"key\": 3}"}) {
    WriteFileAtomically(Work() / "copy" / "stage.json", record);
    EXPECT_FALSE(Run(copier_.Job()).skipped) << record;
  }
}

TEST_F(StageCache, AFailedRunLeavesTheEarlierResultAndNothingElse) {
  Run(copier_.Job());
  WriteFileAtomically(copier_.input, "other");
  StageJob failing = copier_.Job();
  failing.run = [](const fs::path& folder) -> nlohmann::json {
    WriteFileAtomically(folder / "copy.txt", "half");
    throw Interrupted();
  };
  EXPECT_THROW(Run(failing), Interrupted);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  EXPECT_EQ(std::distance(fs::directory_iterator(Work()), fs::directory_iterator()), 1);
}

TEST_F(StageCache, GoesOnAfterAKilledRun) {
  // What a killed process leaves behind.
  WriteFileAtomically(Work() / ".copy.partial" / "copy.txt", "half");
  EXPECT_FALSE(Run(copier_.Job()).skipped);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  EXPECT_FALSE(fs::exists(Work() / ".copy.partial"));
}

TEST_F(StageCache, KilledBetweenTwoNamesItBringsTheOldResultBack) {
  Run(copier_.Job());
  // The moment after the old folder has made way and before the new one has taken its name.
  fs::rename(Work() / "copy", Work() / ".copy.old");
  WriteFileAtomically(Work() / ".copy.partial" / "copy.txt", "other");
  RecoverStage(Work(), "copy");
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  EXPECT_EQ(std::distance(fs::directory_iterator(Work()), fs::directory_iterator()), 1);
  EXPECT_TRUE(Run(copier_.Job()).skipped);
}

TEST_F(StageCache, KilledBeforeTheOldResultWasRemovedItKeepsTheNewOne) {
  Run(copier_.Job());
  WriteFileAtomically(Work() / ".copy.old" / "copy.txt", "older");
  EXPECT_TRUE(Run(copier_.Job()).skipped);
  EXPECT_EQ(ReadFile(Work() / "copy" / "copy.txt"), "first");
  EXPECT_FALSE(fs::exists(Work() / ".copy.old"));
}

TEST_F(StageCache, OtherFilesInTheFolderDoNotMatter) {
  Run(copier_.Job());
  WriteFileAtomically(Work() / "copy" / "pictures" / "tags.png", "drawn to look at");
  EXPECT_TRUE(Run(copier_.Job()).skipped);
  EXPECT_TRUE(ResultsAreAsRecorded(Work(), "copy"));
}

TEST_F(StageCache, KnowsResultsThatAnotherCommandHasWritten) {
  Run(copier_.Job());
  EXPECT_TRUE(ResultsAreAsRecorded(Work(), "copy"));
  WriteFileAtomically(Work() / "copy" / "copy.txt", "by hand");
  EXPECT_FALSE(ResultsAreAsRecorded(Work(), "copy"));
  fs::remove(Work() / "copy" / "copy.txt");
  EXPECT_FALSE(ResultsAreAsRecorded(Work(), "copy"));
}

TEST_F(StageCache, SaysInDetailWhyAStageRunsOrNot) {
  const auto expect = [&](const char* part) {
    Run(copier_.Job());
    EXPECT_NE(talk_.last.find(part), std::string::npos) << talk_.last;
  };
  expect("copy: runs: it has not run yet");
  expect("copy: skipped: options, inputs and results are unchanged");
  copier_.options["knob"] = 2;
  expect("copy: runs: option knob is now 2");
  WriteFileAtomically(copier_.input, "other");
  expect("input.txt has changed");
  WriteFileAtomically(Work() / "copy" / "copy.txt", "damaged");
  expect("copy.txt is not what the stage wrote");
  WriteFileAtomically(Work() / "copy" / "stage.json", "{}");
  expect("stage.json is damaged");
}

TEST_F(StageCache, AMissingInputIsAStateOfItsOwn) {
  StageJob job = copier_.Job();
  job.inputs.push_back(scratch_.folder / "absent.png");
  Run(job);
  EXPECT_TRUE(Run(job).skipped);
  WriteFileAtomically(scratch_.folder / "absent.png", "now here");
  EXPECT_FALSE(Run(job).skipped);
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
