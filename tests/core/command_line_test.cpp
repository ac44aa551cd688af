// SPDX-License-Identifier: BSD-3-Clause
#include "core/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <new>

#include "core/parallel.h"
#include "test_files.h"

namespace lfm {
namespace {

struct Outcome {
  int status;
  std::string out, error;
  std::string first = "unset";
  bool ran = false, count_given = false;
};

struct ToolOptions {
  int count = 1;
  void Declare(OptionVisitor& v) { v.Integer({"count", "How many.", "", 1, 9}, count); }
};

Outcome RunTool(
    std::vector<std::string> arguments,
    const std::function<void(Progress&)>& body = [](Progress&) {}) {
  arguments.insert(arguments.begin(), "lfm-tool");
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  Outcome outcome;
  CommandLine line("lfm-tool", "Does things.", "lfm-tool input");
  line.Positional("FIRST", "The first.", outcome.first);
  ToolOptions options;
  line.Options(AnyOptions(options));
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  outcome.status = line.Run(static_cast<int>(argv.size()), argv.data(), [&](Progress& progress) {
    outcome.ran = true;
    outcome.count_given = line.Given("count");
    body(progress);
  });
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.error = testing::internal::GetCapturedStderr();
  ClearInterruptRequest();
  SetThreadCount(0);
  return outcome;
}

void ExpectOneErrorLine(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.error.rfind("lfm-tool: ", 0), 0u) << outcome.error;
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  EXPECT_NE(outcome.error.find(part), std::string::npos) << outcome.error;
  EXPECT_EQ(outcome.out, "");
}

TEST(CommandLine, SuccessIsZeroAndSilent) {
  const Outcome outcome = RunTool({"a"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(outcome.ran);
  EXPECT_EQ(outcome.first, "a");
  EXPECT_EQ(outcome.error + outcome.out, "");
}

TEST(CommandLine, UsageErrorsAreTwo) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                    {"a", "b"},
                                                    {"a", "--nonsense"},
                                                    {"a", "--threads", "-3"},
                                                    {"a", "--threads", "many"},
                                                    {"a", "--count", ""}}) {
    const Outcome outcome = RunTool(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_FALSE(outcome.ran);
    ExpectOneErrorLine(outcome, "--help");
  }
}

TEST(CommandLine, BadInputIsTwo) {
  const Outcome outcome = RunTool({"a"}, [](Progress&) { throw Error("a.png: is\nbroken\n"); });
  EXPECT_EQ(outcome.status, 2);
  ExpectOneErrorLine(outcome, "error: a.png: is broken");
}

TEST(CommandLine, OurFailuresAreOne) {
  Outcome outcome =
      RunTool({"a"}, [](Progress&) { throw Error("the disk is full", ErrorKind::kSystem); });
  EXPECT_EQ(outcome.status, 1);
  ExpectOneErrorLine(outcome, "the disk is full");
  outcome = RunTool({"a"}, [](Progress&) { throw std::bad_alloc(); });
  EXPECT_EQ(outcome.status, 1);
  ExpectOneErrorLine(outcome, "memory");
  outcome = RunTool({"a"}, [](Progress&) { throw std::logic_error("oops"); });
  EXPECT_EQ(outcome.status, 1);
  ExpectOneErrorLine(outcome, "oops");
}

TEST(CommandLine, InterruptIs130) {
  const Outcome outcome = RunTool({"a"}, [](Progress& progress) {
    progress.Start("work", 10);
    std::raise(SIGINT);
    progress.Advance();
    ADD_FAILURE() << "went on after Ctrl-C";
  });
  EXPECT_EQ(outcome.status, 130);
  ExpectOneErrorLine(outcome, "interrupted");
  const Outcome terminated = RunTool({"a"}, [](Progress& progress) {
    progress.Start("work", 10);
    std::raise(SIGTERM);
    progress.Advance();
  });
  EXPECT_EQ(terminated.status, 130);
}

TEST(CommandLine, HelpShowsTheExampleAndEveryCommonOption) {
  const Outcome outcome = RunTool({"--help"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_FALSE(outcome.ran);
  for (const char* part : {"lfm-tool input", "--quiet", "--verbose", "--threads", "--config",
                           "--version", "FIRST", "The first."}) {
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part;
  }
}

TEST(CommandLine, VersionIsTheProjects) {
  const Outcome outcome = RunTool({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out, "lfm-tool " LFM_VERSION "\n");
}

TEST(CommandLine, ThreadsBoundThisProcess) {
  int inside = 0;
  RunTool({"a", "--threads", "1"}, [&](Progress&) { inside = ThreadCount(); });
  EXPECT_EQ(inside, 1);
}

TEST(CommandLine, QuietSaysNothing) {
  const auto talk = [](Progress& progress) { progress.Note("half way"); };
  EXPECT_EQ(RunTool({"a", "--quiet"}, talk).error, "");
  EXPECT_EQ(RunTool({"a"}, talk).error, "half way\n");
}

// What the tool says of a config file with this content.
Outcome RunWithConfig(const TestFolder& folder, const std::string& content,
                      std::vector<std::string> more = {}) {
  Put(folder / "tool.toml", content);
  more.insert(more.begin(), {"a", "--config", (folder / "tool.toml").string()});
  return RunTool(more);
}

TEST(CommandLine, AConfigFileThatIsWrongIsNamedWithWhatIsWrong) {
  const TestFolder folder;
  for (const auto& [content, part] :
       {std::pair("count = 3\n[x", "line 2: a section's name ends with ]"),
        std::pair("[x\ncount = 3\n", "line 1: a section's name ends with ]"),
        std::pair("[x]\ncount = 3\n", "line 1: options are in no sections"),
        std::pair("ab", "line 1: \"ab\" is no option"), std::pair("count =\n", "gives no value"),
        std::pair("# fine\n\ncount = [3,\n", "line 3: its [ is never closed"),
        std::pair("colour = 3\n", "unknown option colour"), std::pair("count = many\n", "--count"),
        std::pair("count = 99\n", "--count is 99")}) {
    const Outcome outcome = RunWithConfig(folder, content);
    EXPECT_EQ(outcome.status, 2) << content;
    EXPECT_FALSE(outcome.ran) << content;
    ExpectOneErrorLine(outcome, (folder / "tool.toml").string() + ": ");
    ExpectOneErrorLine(outcome, part);
  }
}

TEST(CommandLine, AConfigFileOfGarbageIsNotEchoed) {
  const TestFolder folder;
  const std::string garbage = "\x1b[31m\x07\xff\xfe" + std::string(5000, '\x01') + "\n";
  const Outcome binary = RunWithConfig(folder, garbage);
  EXPECT_EQ(binary.status, 2);
  ExpectOneErrorLine(binary, "tool.toml: line 1: is no text");
  const Outcome wordy = RunWithConfig(folder, std::string(5000, 'x') + " = 3\n");
  EXPECT_EQ(wordy.status, 2);
  EXPECT_LT(wordy.error.size(), 700U);
  const Outcome endless = RunWithConfig(folder, std::string(2 << 20, '#'));
  EXPECT_EQ(endless.status, 2);
  ExpectOneErrorLine(endless, "begins more than a megabyte");
}

TEST(CommandLine, AConfigFileThatIsRightIsFollowedAndNotBlamed) {
  const TestFolder folder;
  EXPECT_EQ(RunWithConfig(folder, "# as ever\n\n  count = 3 # three\nquiet=true\n").status, 0);
  const Outcome outcome = RunWithConfig(folder, "count = 3\n", {"--count", "99"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.error.find("tool.toml"), std::string::npos) << outcome.error;
}

// Whatever the value: also the default.
TEST(CommandLine, KnowsWhichOptionsWereGiven) {
  EXPECT_FALSE(RunTool({"a"}).count_given);
  EXPECT_TRUE(RunTool({"a", "--count", "1"}).count_given);
  const TestFolder folder;
  EXPECT_TRUE(RunWithConfig(folder, "count = 1\n").count_given);
  EXPECT_FALSE(RunWithConfig(folder, "\n").count_given);
}

TEST(CommandLine, WhatATerminalWouldObeyIsEscaped) {
  const Outcome outcome = RunTool({"a", "--no\x1b[2Jnsense\xff\xc2\x9b", "--na\xc3\xafve"});
  EXPECT_EQ(outcome.status, 2);
  ExpectOneErrorLine(outcome, "--no\\x1b[2Jnsense\\xff\\xc2\\x9b");
  ExpectOneErrorLine(outcome, "na\xc3\xafve");
}

TEST(CommandLine, VerboseOpensDetails) {
  const auto talk = [](Progress& progress) {
    progress.Detail("because of this");
    progress.Note("half way");
  };
  EXPECT_EQ(RunTool({"a"}, talk).error, "half way\n");
  const std::string more = RunTool({"a", "--verbose"}, talk).error;
  EXPECT_NE(more.find("because of this\nhalf way\n"), std::string::npos) << more;
  EXPECT_NE(more.find("lfm-tool " LFM_VERSION), std::string::npos) << more;
  EXPECT_EQ(RunTool({"a", "--verbose", "--quiet"}, talk).error, "");
}

}  // namespace
}  // namespace lfm
