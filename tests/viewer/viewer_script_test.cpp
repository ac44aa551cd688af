// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_script.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using Kind = ScriptStep::Kind;

std::vector<ScriptStep> Parsed(const std::string& text) {
  const ScratchFolder scratch;
  std::ofstream(scratch.folder / "script.txt", std::ios::binary) << text;
  return ReadViewerScript(scratch.folder / "script.txt");
}

// The only step of a line.
ScriptStep Step(const std::string& line) {
  const std::vector<ScriptStep> steps = Parsed(line + "\n");
  EXPECT_EQ(steps.size(), 2u) << line;
  EXPECT_EQ(steps.back().kind, Kind::kQuit) << line;
  return steps.front();
}

std::string MessageOf(const std::string& text) {
  try {
    Parsed(text);
    ADD_FAILURE() << "accepted: " << text.substr(0, 200);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

// What is thrown names the file, the line and `what`, in one line that is not long.
void ExpectRefused(const std::string& text, int line, const std::string& what) {
  const std::string message = MessageOf(text);
  EXPECT_NE(message.find("script.txt: line " + std::to_string(line) + ": "), std::string::npos)
      << message;
  EXPECT_NE(message.find(what), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(message.size(), 600u);
}

TEST(ViewerScript, ReadsEveryStep) {
  const struct {
    const char* line;
    Kind kind;
    const char* text;
    std::vector<double> numbers;
  } cases[] = {
      {"key M", Kind::kKey, "M", {}},
      {"move 3.5 -4", Kind::kMove, "", {3.5, -4}},
      {"press left", Kind::kPress, "left", {}},
      {"release middle", Kind::kRelease, "middle", {}},
      {"drag right 100 80 160.25 1e2", Kind::kDrag, "right", {100, 80, 160.25, 100}},
      {"click left 0 16384", Kind::kClick, "left", {0, 16384}},
      {"double-click left -16384 2", Kind::kDoubleClick, "left", {-16384, 2}},
      {"scroll 0 -2", Kind::kScroll, "", {0, -2}},
      {"hold shift", Kind::kHold, "shift", {}},
      {"let-go alt", Kind::kLetGo, "alt", {}},
      {"drop my models/bust #2.glb", Kind::kDrop, "my models/bust", {}},
      {"drop my models/bust#2.glb", Kind::kDrop, "my models/bust#2.glb", {}},
      {"resize 0 480", Kind::kResize, "", {0, 480}},
      {"wait 1", Kind::kWait, "", {1}},
      {"loaded", Kind::kLoaded, "", {}},
      {"screenshot  out/the mean.png", Kind::kScreenshot, "out/the mean.png", {}},
      {"windowshot a.png", Kind::kWindowshot, "a.png", {}},
      {"set terms   2", Kind::kSet, "terms 2", {}},
      {"set photo a name", Kind::kSet, "photo a name", {}},
      {"state out.json", Kind::kState, "out.json", {}},
  };
  for (const auto& expected : cases) {
    const ScriptStep step = Step(expected.line);
    EXPECT_EQ(step.kind, expected.kind) << expected.line;
    EXPECT_EQ(step.text, expected.text) << expected.line;
    EXPECT_EQ(step.numbers, expected.numbers) << expected.line;
    EXPECT_EQ(step.line, 1) << expected.line;
  }
}

TEST(ViewerScript, SkipsBlanksAndComments) {
  const std::vector<ScriptStep> steps =
      Parsed("# what it does\n\n  \t loaded   # at first\r\nkey\t a\r\n#quit\n\nscroll 1\t2 #");
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[0].kind, Kind::kLoaded);
  EXPECT_EQ(steps[0].line, 3);
  EXPECT_EQ(steps[1].text, "A");
  EXPECT_EQ(steps[1].line, 4);
  EXPECT_EQ(steps[2].numbers, (std::vector<double>{1, 2}));
  EXPECT_EQ(steps[2].line, 7);
  EXPECT_EQ(steps[3].kind, Kind::kQuit);
}

TEST(ViewerScript, EndsWithQuitOnce) {
  for (const char* text : {"", "\n", "# nothing\n", "quit", "quit\n\n# over\n"}) {
    const std::vector<ScriptStep> steps = Parsed(text);
    ASSERT_EQ(steps.size(), 1u) << text;
    EXPECT_EQ(steps[0].kind, Kind::kQuit);
    EXPECT_GE(steps[0].line, 1);
  }
  EXPECT_EQ(Parsed("loaded\nquit").size(), 2u);
  ExpectRefused("quit\nloaded\n", 2, "quit is the last step");
  ExpectRefused("quit\nquit\n", 2, "quit is the last step");
}

TEST(ViewerScript, KnowsItsKeysByName) {
  for (char c = 'a'; c <= 'z'; ++c) {
    const std::string capital(1, static_cast<char>(c - 'a' + 'A'));
    EXPECT_EQ(Step(std::string("key ") + c).text, capital);
    EXPECT_EQ(Step("key " + capital).text, capital);
  }
  std::vector<std::string> names = {
      "home",  "end",   "left", "right", "up",    "down",    "[",      "]", "page-down", "escape",
      "space", "enter", "tab",  "plus",  "minus", "page-up", "delete", "0", "9"};
  for (int f = 1; f <= 12; ++f) names.push_back("F" + std::to_string(f));
  for (const std::string& name : names) EXPECT_EQ(Step("key " + name).text, name);
  for (const std::string name :
       {"F0", "F13", "f1", "Home", "ab", "-", "+", "\xc3\xa4", "ctrl", "shift+a", "00"}) {
    ExpectRefused("key " + name, 1, "no key '" + name + "'");
  }
}

TEST(ViewerScript, RefusesWhatIsNone) {
  for (const std::string line :
       {"dance", "Loaded", "LOADED", "loaded;", "\"loaded\"", "doubleclick left 1 2",
        "\xef\xbb\xbfquit", "let go shift", "-", "\x01"}) {
    ExpectRefused("\n" + line + "\nquit\n", 2, "there is no step");
  }
  for (const std::string line : {"key", "press", "drag", "hold", "drop", "drop  # file",
                                 "screenshot", "set", "state", "click"}) {
    ExpectRefused(line, 1, "a word is missing");
  }
  for (const std::string line : {"move", "move 1", "drag left 1 2 3", "click left", "scroll 1",
                                 "resize 640", "wait", "click left 1 # 2"}) {
    ExpectRefused(line, 1, "a number is missing");
  }
  ExpectRefused("set terms", 1, "value is missing");
  for (const std::string line : {"loaded 1", "quit now", "move 1 2 3", "key a b", "press left 1",
                                 "hold shift ctrl", "wait 1 frame", "drag left 1 2 3 4 5"}) {
    ExpectRefused(line, 1, "is too much");
  }
  for (const std::string line :
       {"press Left", "click 1 2 3", "drag shift 1 2 3 4", "hold left", "let-go super"}) {
    ExpectRefused(line, 1, "is none of");
  }
  for (const std::string line :
       {"screenshot a.jpg", "screenshot png", "screenshot .png", "windowshot a.png.exr",
        "screenshot a.png b", "windowshot A.PNG"}) {
    ExpectRefused(line, 1, "does not end in .png");
  }
  ExpectRefused("state a.txt", 1, "does not end in .json");
  ExpectRefused(std::string("drop a\0b", 8), 1, "zero byte");
}

TEST(ViewerScript, RefusesNumbersThatAreNone) {
  for (const std::string number :
       {"nan",       "-nan",   "inf", "-inf", "infinity", "1e999", "-1e999",
        "16384.001", "-16385", "1e5", "0x10", "1,5",      "1.5.2", "+1",
        "--1",       "",       "one", "1e",   "NAN",      "1\x01"}) {
    ExpectRefused("move 1 " + (number.empty() ? "\"\"" : number), 1, "is not a number");
  }
  for (const std::string line : {"resize 640.5 480", "resize -1 480", "resize 640 -0.5"}) {
    ExpectRefused(line, 1, "is not a whole number from 0");
  }
  for (const std::string line : {"wait 0", "wait -1", "wait 1.5"}) {
    ExpectRefused(line, 1, "is not a whole number from 1");
  }
}

TEST(ViewerScript, NamesLongWordsShortly) {
  ExpectRefused(std::string(1000000, 'x'), 1, "there is no step 'xxx");
  ExpectRefused("screenshot " + std::string(1000000, 'y'), 1, "yyy...'");
}

TEST(ViewerScript, HasAHundredThousandLinesAtMost) {
  std::string lines;
  for (int i = 0; i < 100000; ++i) lines += "loaded\n";
  EXPECT_EQ(Parsed(lines).size(), 100001u);
  ExpectRefused(lines + "#", 100001, "100000 lines");
  EXPECT_NE(MessageOf(std::string(16000001, '\n')).find("16000001"), std::string::npos);
}

TEST(ViewerScript, MissingFilesAndFoldersAreErrors) {
  const ScratchFolder scratch;
  EXPECT_THROW(ReadViewerScript(scratch.folder / "absent.txt"), Error);
  EXPECT_THROW(ReadViewerScript(scratch.folder), Error);
}

TEST(ViewerScript, SurvivesNoise) {
  const std::string good =
      "loaded\ndrag left 100 80 160 80\nhold shift\nscroll 0 -2\nkey M\nscreenshot "
      "mean.png\nquit\n";
  EXPECT_EQ(Parsed(good).size(), 7u);
  std::mt19937 random(11);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::string damaged = good.substr(0, random() % good.size());
    if (!damaged.empty()) damaged[random() % damaged.size()] = static_cast<char>(random());
    try {
      const std::vector<ScriptStep> steps = Parsed(damaged);
      ASSERT_FALSE(steps.empty());
      EXPECT_EQ(steps.back().kind, Kind::kQuit);
      for (const ScriptStep& step : steps) {
        for (const double number : step.numbers) EXPECT_LE(std::abs(number), 16384);
      }
    } catch (const Error& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("script.txt: line "), std::string::npos);
    }
  }
  EXPECT_GT(refused, 500);
}

// docs/formats.md lists all steps: those that are offered for one that is unknown.
TEST(ViewerScript, DocumentListsTheSteps) {
  const std::string document = ReadFile(LFM_SOURCE_DIR "/docs/formats.md");
  const size_t begin = document.find("## Viewer script");
  ASSERT_NE(begin, std::string::npos);
  const std::string section = document.substr(begin, document.find("\n## ", begin + 1) - begin);
  const std::string message = MessageOf("dance");
  size_t steps = 0;
  for (size_t at = message.find(", but ") + 6; at < message.size();) {
    const size_t end = std::min(message.find(", ", at), message.size());
    EXPECT_NE(section.find("`" + message.substr(at, end - at)), std::string::npos)
        << message.substr(at, end - at);
    at = end + 2;
    ++steps;
  }
  EXPECT_EQ(steps, 19u);
}

}  // namespace
}  // namespace lfm
