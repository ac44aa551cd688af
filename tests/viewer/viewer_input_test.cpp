// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using Kind = ScriptStep::Kind;

ScriptStep Step(Kind kind, const std::string& text = "", std::vector<double> numbers = {}) {
  return {kind, text, std::move(numbers), 0};
}

struct Played {
  std::vector<ScriptedInput> frames;
  std::vector<std::pair<size_t, ScriptStep>> requests;  ///< and the frames that they came before
};

constexpr size_t kMostFrames = 500;

/// Plays as the viewer does, up to quit. `busy`: whether something is being read then.
Played Play(std::vector<ScriptStep> steps, const std::function<bool(size_t)>& busy = {}) {
  steps.push_back(Step(Kind::kQuit));
  ScriptPlayer player(std::move(steps));
  Played played;
  while (played.frames.size() < kMostFrames) {
    const size_t frame = played.frames.size();
    if (const auto request = player.Request(busy && busy(frame))) {
      played.requests.emplace_back(frame, *request);
      if (request->kind == Kind::kQuit) return played;
    }
    played.frames.push_back(player.NextFrame());
  }
  ADD_FAILURE() << "the script does not end";
  return played;
}

bool Button(const ScriptedInput& frame, const std::string& button) {
  return button == "left" ? frame.left : button == "right" ? frame.right : frame.middle;
}

/// Frames in which the button goes down.
std::vector<size_t> Presses(const std::vector<ScriptedInput>& frames, const std::string& button) {
  std::vector<size_t> presses;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (Button(frames[i], button) && (i == 0 || !Button(frames[i - 1], button))) {
      presses.push_back(i);
    }
  }
  return presses;
}

const char* const kButtons[] = {"left", "right", "middle"};

TEST(ScriptPlayer, ADragBeginsAndEndsWhereItShould) {
  const Eigen::Vector2d from(10, 80), to(40, 20);
  for (const std::string button : kButtons) {
    const Played played = Play({Step(Kind::kDrag, button, {10, 80, 40, 20})});
    const std::vector<ScriptedInput>& frames = played.frames;
    const std::vector<size_t> presses = Presses(frames, button);
    ASSERT_EQ(presses.size(), 1u) << button;
    ASSERT_GT(presses[0], 0u) << "the pointer is there before";
    EXPECT_EQ(frames[presses[0] - 1].pointer, from);
    EXPECT_EQ(frames[presses[0]].pointer, from);
    size_t i = presses[0];
    std::set<double> places;
    for (; i < frames.size() && Button(frames[i], button); ++i) {
      EXPECT_GE(frames[i].pointer.x(), frames[i - 1].pointer.x());
      const Eigen::Vector2d way = frames[i].pointer - from, whole = to - from;
      EXPECT_NEAR(way.x() * whole.y() - way.y() * whole.x(), 0, 1e-9) << "straight";
      places.insert(frames[i].pointer.x());
      for (const char* other : kButtons) EXPECT_EQ(Button(frames[i], other), other == button);
    }
    EXPECT_GE(places.size(), 4u) << "over several frames";
    EXPECT_EQ(frames[i - 1].pointer, to) << "held to the end";
    ASSERT_LT(i, frames.size());
    for (; i < frames.size(); ++i) {
      EXPECT_FALSE(Button(frames[i], button));
      EXPECT_EQ(frames[i].pointer, to);
    }
  }
}

TEST(ScriptPlayer, AClickPressesOnceAndADoubleClickTwice) {
  constexpr size_t kMostFramesOfADoubleClick = 6;  // GUIs count those close together
  for (const std::string button : kButtons) {
    for (const Kind kind : {Kind::kClick, Kind::kDoubleClick}) {
      const std::vector<ScriptedInput> frames = Play({Step(kind, button, {33, 44})}).frames;
      const std::vector<size_t> presses = Presses(frames, button);
      ASSERT_EQ(presses.size(), kind == Kind::kClick ? 1u : 2u) << button;
      EXPECT_LE(presses.back() - presses.front(), kMostFramesOfADoubleClick);
      ASSERT_GT(presses[0], 0u);
      for (size_t i = presses[0] - 1; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].pointer, Eigen::Vector2d(33, 44)) << i;
      }
      EXPECT_FALSE(Button(frames.back(), button));
      for (const char* other : kButtons) {
        EXPECT_EQ(Presses(frames, other).empty(), other != button) << other;
      }
    }
  }
}

TEST(ScriptPlayer, ButtonsStayPressedUntilTheyAreReleased) {
  const std::vector<ScriptedInput> frames =
      Play({Step(Kind::kMove, "", {5, 6}), Step(Kind::kPress, "right"),
            Step(Kind::kMove, "", {50, 60}), Step(Kind::kWait, "", {3}),
            Step(Kind::kRelease, "right"), Step(Kind::kWait, "", {2})})
          .frames;
  ASSERT_EQ(frames.size(), 9u);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].right, i >= 1 && i < 6) << i;
    EXPECT_EQ(frames[i].pointer, i < 2 ? Eigen::Vector2d(5, 6) : Eigen::Vector2d(50, 60)) << i;
    EXPECT_FALSE(frames[i].left || frames[i].middle);
  }
}

TEST(ScriptPlayer, KeysLastAFrame) {
  const std::vector<ScriptedInput> frames =
      Play({Step(Kind::kKey, "M"), Step(Kind::kKey, "M"), Step(Kind::kKey, "home")}).frames;
  std::vector<int> pressed;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (!frames[i].key) continue;
    pressed.push_back(*frames[i].key);
    ASSERT_LT(i + 1, frames.size());
    EXPECT_FALSE(frames[i + 1].key) << "let go, else the same key again is none";
  }
  EXPECT_EQ(pressed, (std::vector<int>{'M', 'M', *KeyNumber("home")}));
}

TEST(ScriptPlayer, ModifiersAreHeldUntilTheyAreLetGo) {
  using Member = bool ScriptedInput::*;
  const std::pair<const char*, Member> modifiers[] = {{"shift", &ScriptedInput::shift},
                                                      {"ctrl", &ScriptedInput::ctrl},
                                                      {"alt", &ScriptedInput::alt}};
  for (const auto& [name, member] : modifiers) {
    const std::vector<ScriptedInput> frames =
        Play({Step(Kind::kWait, "", {2}), Step(Kind::kHold, name), Step(Kind::kKey, "K"),
              Step(Kind::kDrag, "left", {1, 2, 3, 4}), Step(Kind::kLetGo, name),
              Step(Kind::kScroll, "", {0, 1})})
            .frames;
    int keys = 0, drags = 0, scrolls = 0, changes = 0;
    for (size_t i = 0; i < frames.size(); ++i) {
      changes += i > 0 && frames[i].*member != frames[i - 1].*member;
      keys += frames[i].key && frames[i].*member;
      drags += frames[i].left && frames[i].*member;
      scrolls += frames[i].scroll.y() != 0 && !(frames[i].*member);
      for (const auto& [other_name, other] : modifiers) {
        EXPECT_TRUE(other == member || !(frames[i].*other)) << other_name;
      }
    }
    EXPECT_EQ(changes, 2) << name;
    EXPECT_EQ(keys, 1) << name;
    EXPECT_GT(drags, 3) << name;
    EXPECT_EQ(scrolls, 1) << name;
  }
}

TEST(ScriptPlayer, ScrollingLastsAFrame) {
  const std::vector<ScriptedInput> frames =
      Play({Step(Kind::kScroll, "", {0.5, -2}), Step(Kind::kWait, "", {3}),
            Step(Kind::kScroll, "", {0, 1})})
          .frames;
  std::vector<Eigen::Vector2d> scrolls;
  for (const ScriptedInput& frame : frames) {
    if (!frame.scroll.isZero()) scrolls.push_back(frame.scroll);
  }
  EXPECT_EQ(scrolls, (std::vector<Eigen::Vector2d>{{0.5, -2}, {0, 1}}));
}

TEST(ScriptPlayer, WaitingCountsFrames) {
  const auto frames_between = [](std::vector<ScriptStep> between) {
    between.insert(between.begin(), Step(Kind::kScreenshot, "a.png"));
    between.push_back(Step(Kind::kScreenshot, "b.png"));
    const Played played = Play(std::move(between));
    EXPECT_EQ(played.requests.size(), 3u);
    return played.requests[1].first - played.requests[0].first;
  };
  const size_t without = frames_between({});
  EXPECT_EQ(without, 1u);
  for (const int frames : {1, 2, 7}) {
    EXPECT_EQ(frames_between({Step(Kind::kWait, "", {static_cast<double>(frames)})}),
              without + frames);
  }
}

TEST(ScriptPlayer, AsksForOneThingAFrame) {
  const std::vector<ScriptStep> steps = {
      Step(Kind::kSet, "terms 2"),         Step(Kind::kDrop, "a.glb"),
      Step(Kind::kResize, "", {640, 480}), Step(Kind::kScreenshot, "a.png"),
      Step(Kind::kWindowshot, "b.png"),    Step(Kind::kState, "c.json")};
  const Played played = Play(steps);
  ASSERT_EQ(played.requests.size(), steps.size() + 1) << "and quit";
  for (size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(played.requests[i].first, i);
    EXPECT_EQ(played.requests[i].second.kind, steps[i].kind) << i;
    EXPECT_EQ(played.requests[i].second.text, steps[i].text) << i;
    EXPECT_EQ(played.requests[i].second.numbers, steps[i].numbers) << i;
  }
}

TEST(ScriptPlayer, PicturesComeAfterTheFramesBeforeThem) {
  const Played played =
      Play({Step(Kind::kDrag, "left", {1, 2, 30, 40}), Step(Kind::kScreenshot, "a.png"),
            Step(Kind::kKey, "M"), Step(Kind::kWindowshot, "b.png")});
  ASSERT_EQ(played.requests.size(), 3u);
  const auto drawn_before = [&](size_t request) {
    const auto begin = played.frames.begin();
    return std::vector<ScriptedInput>(begin,
                                      begin + static_cast<int>(played.requests[request].first));
  };
  EXPECT_EQ(played.requests[0].second.text, "a.png");
  const std::vector<ScriptedInput> before_a = drawn_before(0), before_b = drawn_before(1);
  ASSERT_FALSE(before_a.empty());
  EXPECT_EQ(Presses(before_a, "left").size(), 1u);
  EXPECT_FALSE(before_a.back().left) << "the drag is over";
  EXPECT_EQ(before_a.back().pointer, Eigen::Vector2d(30, 40));
  const auto has_key = [](const ScriptedInput& frame) { return frame.key.has_value(); };
  EXPECT_EQ(std::count_if(before_a.begin(), before_a.end(), has_key), 0);
  EXPECT_EQ(std::count_if(before_b.begin(), before_b.end(), has_key), 1);
}

TEST(ScriptPlayer, LoadedWaitsWhileSomethingIsBeingRead) {
  for (const size_t busy_frames : {0, 1, 9}) {
    const Played played =
        Play({Step(Kind::kPress, "left"), Step(Kind::kLoaded), Step(Kind::kSet, "terms 1")},
             [&](size_t frame) { return frame < 3 + busy_frames; });
    ASSERT_EQ(played.requests.size(), 2u);
    EXPECT_GE(played.requests[0].first, 3 + busy_frames);
    EXPECT_LE(played.requests[0].first, 3 + busy_frames + 2) << "and no longer";
    for (const ScriptedInput& frame : played.frames) {
      EXPECT_TRUE(frame.left) << "hands stay as they are";
    }
  }
  // Only that step waits.
  const Played busy =
      Play({Step(Kind::kKey, "M"), Step(Kind::kSet, "terms 1")}, [](size_t) { return true; });
  EXPECT_LT(busy.frames.size(), 10u);
}

TEST(ScriptPlayer, AtTheEndTheHandsRest) {
  ScriptPlayer player({Step(Kind::kMove, "", {7, 8})});
  EXPECT_FALSE(player.Request(false));
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(player.NextFrame().pointer, Eigen::Vector2d(7, 8));
    EXPECT_FALSE(player.Request(false));
  }
  ScriptPlayer none({});
  EXPECT_FALSE(none.Request(false));
  EXPECT_EQ(none.NextFrame().pointer, Eigen::Vector2d(-1, -1)) << "outside the window";
}

/// The names of scripts, and the numbers that GLFW's documentation gives these keys.
std::map<std::string, int> NamedKeys() {
  std::map<std::string, int> keys = {
      {"escape", 256}, {"enter", 257}, {"tab", 258},  {"delete", 261},  {"right", 262},
      {"left", 263},   {"down", 264},  {"up", 265},   {"page-up", 266}, {"page-down", 267},
      {"home", 268},   {"end", 269},   {"space", 32}, {"minus", 45},    {"plus", 61},
      {"[", 91},       {"]", 93}};
  for (char c = 'A'; c <= 'Z'; ++c) keys[std::string(1, c)] = c;
  for (char c = '0'; c <= '9'; ++c) keys[std::string(1, c)] = c;
  for (int f = 1; f <= 12; ++f) keys["F" + std::to_string(f)] = 289 + f;
  return keys;
}

TEST(KeyNumber, IsThatOfGlfwForAllNamesOfScripts) {
  const ScratchFolder scratch;
  const std::map<std::string, int> keys = NamedKeys();
  {
    std::ofstream script(scratch.folder / "keys.txt");
    for (const auto& [name, number] : keys) script << "key " << name << "\n";
    script << "key q\n";
  }
  const std::vector<ScriptStep> steps = ReadViewerScript(scratch.folder / "keys.txt");
  ASSERT_EQ(steps.size(), keys.size() + 2);
  size_t i = 0;
  for (const auto& [name, number] : keys) {
    EXPECT_EQ(KeyNumber(steps[i].text), number) << name;
    ++i;
  }
  EXPECT_EQ(KeyNumber(steps[i].text), 'Q') << "either case";
  for (const char* other :
       {"", "F0", "F13", "F01", "f1", "Home", "AB", "11", "ä", "-", " ", "ctrl"}) {
    EXPECT_FALSE(KeyNumber(other)) << other;
  }
}

TEST(ActionOfKey, IsWhatTheKeyStandsFor) {
  const std::pair<const char*, ViewerAction> actions[] = {
      {"M", ViewerAction::kToggleMeanOnly},   {"T", ViewerAction::kToggleTermAlone},
      {"W", ViewerAction::kToggleWireframe},  {"O", ViewerAction::kNextOverlay},
      {"]", ViewerAction::kMoreTerms},        {"[", ViewerAction::kFewerTerms},
      {"S", ViewerAction::kSaveScreenshot},   {"R", ViewerAction::kGoHome},
      {"home", ViewerAction::kGoHome},        {"P", ViewerAction::kTogglePanel},
      {"G", ViewerAction::kToggleFrameTimes}, {"C", ViewerAction::kToggleCameras},
      {"D", ViewerAction::kTogglePhotograph}, {"B", ViewerAction::kToggleTape},
      {"K", ViewerAction::kAddPathKey},       {"left", ViewerAction::kTurnLeft},
      {"right", ViewerAction::kTurnRight},    {"up", ViewerAction::kTurnUp},
      {"down", ViewerAction::kTurnDown},      {"plus", ViewerAction::kCloser},
      {"minus", ViewerAction::kFarther},      {"escape", ViewerAction::kQuit}};
  std::set<std::string> with_action;
  for (const auto& [name, action] : actions) {
    const int key = KeyNumber(name).value();
    EXPECT_EQ(ActionOfKey(key, false), action) << name;
    EXPECT_EQ(ActionOfKey(key, true), key == 'K' ? ViewerAction::kRemovePathKey : action) << name;
    with_action.insert(name);
  }
  for (const auto& [name, number] : NamedKeys()) {
    EXPECT_EQ(ActionOfKey(number, false).has_value(), with_action.contains(name)) << name;
  }
  EXPECT_EQ(ActionOfKey(334, false), ViewerAction::kCloser) << "of the keypad";
  EXPECT_EQ(ActionOfKey(333, false), ViewerAction::kFarther) << "of the keypad";
  EXPECT_FALSE(ActionOfKey(-1, false));
}

}  // namespace
}  // namespace lfm
