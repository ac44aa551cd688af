// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <map>
#include <utility>

namespace lfm {
namespace {

constexpr int kDragFrames = 6;

struct KeyAction {
  int key;
  ViewerAction action;
};
constexpr KeyAction kActions[] = {{GLFW_KEY_M, ViewerAction::kToggleMeanOnly},
                                  {GLFW_KEY_T, ViewerAction::kToggleTermAlone},
                                  {GLFW_KEY_W, ViewerAction::kToggleWireframe},
                                  {GLFW_KEY_O, ViewerAction::kNextOverlay},
                                  {GLFW_KEY_RIGHT_BRACKET, ViewerAction::kMoreTerms},
                                  {GLFW_KEY_LEFT_BRACKET, ViewerAction::kFewerTerms},
                                  {GLFW_KEY_S, ViewerAction::kSaveScreenshot},
                                  {GLFW_KEY_R, ViewerAction::kGoHome},
                                  {GLFW_KEY_HOME, ViewerAction::kGoHome},
                                  {GLFW_KEY_P, ViewerAction::kTogglePanel},
                                  {GLFW_KEY_G, ViewerAction::kToggleFrameTimes},
                                  {GLFW_KEY_C, ViewerAction::kToggleCameras},
                                  {GLFW_KEY_D, ViewerAction::kTogglePhotograph},
                                  {GLFW_KEY_B, ViewerAction::kToggleTape},
                                  {GLFW_KEY_K, ViewerAction::kAddPathKey},
                                  {GLFW_KEY_LEFT, ViewerAction::kTurnLeft},
                                  {GLFW_KEY_RIGHT, ViewerAction::kTurnRight},
                                  {GLFW_KEY_UP, ViewerAction::kTurnUp},
                                  {GLFW_KEY_DOWN, ViewerAction::kTurnDown},
                                  {GLFW_KEY_EQUAL, ViewerAction::kCloser},
                                  {GLFW_KEY_KP_ADD, ViewerAction::kCloser},
                                  {GLFW_KEY_MINUS, ViewerAction::kFarther},
                                  {GLFW_KEY_KP_SUBTRACT, ViewerAction::kFarther},
                                  {GLFW_KEY_ESCAPE, ViewerAction::kQuit}};

const std::map<std::string, int> kNamedKeys = {
    {"home", GLFW_KEY_HOME},       {"end", GLFW_KEY_END},
    {"left", GLFW_KEY_LEFT},       {"right", GLFW_KEY_RIGHT},
    {"up", GLFW_KEY_UP},           {"down", GLFW_KEY_DOWN},
    {"page-up", GLFW_KEY_PAGE_UP}, {"page-down", GLFW_KEY_PAGE_DOWN},
    {"escape", GLFW_KEY_ESCAPE},   {"space", GLFW_KEY_SPACE},
    {"enter", GLFW_KEY_ENTER},     {"tab", GLFW_KEY_TAB},
    {"delete", GLFW_KEY_DELETE},   {"minus", GLFW_KEY_MINUS},
    {"plus", GLFW_KEY_EQUAL},      {"[", GLFW_KEY_LEFT_BRACKET},
    {"]", GLFW_KEY_RIGHT_BRACKET}};

}  // namespace

std::optional<int> KeyNumber(const std::string& name) {
  if (const auto named = kNamedKeys.find(name); named != kNamedKeys.end()) return named->second;
  if (name.size() == 1) {
    const char letter = name[0];
    if (letter >= '0' && letter <= '9') return GLFW_KEY_0 + (letter - '0');
    if (letter >= 'A' && letter <= 'Z') return GLFW_KEY_A + (letter - 'A');
    if (letter >= 'a' && letter <= 'z') return GLFW_KEY_A + (letter - 'a');
  }
  for (int number = 1; number <= 12; ++number) {
    if (name == "F" + std::to_string(number)) return GLFW_KEY_F1 + number - 1;
  }
  return std::nullopt;
}

std::optional<ViewerAction> ActionOfKey(int key, bool shift) {
  if (shift && key == GLFW_KEY_K) return ViewerAction::kRemovePathKey;
  for (const KeyAction& entry : kActions) {
    if (entry.key == key) return entry.action;
  }
  return std::nullopt;
}

ScriptPlayer::ScriptPlayer(std::vector<ScriptStep> steps) : steps_(std::move(steps)) {}

std::optional<ScriptStep> ScriptPlayer::Request(bool busy) {
  if (!frames_.empty() || next_ >= steps_.size()) return std::nullopt;
  const ScriptStep& step = steps_[next_];
  using Kind = ScriptStep::Kind;
  switch (step.kind) {
    case Kind::kLoaded:
      if (!busy) ++next_;
      return std::nullopt;
    case Kind::kDrop:
    case Kind::kResize:
    case Kind::kScreenshot:
    case Kind::kWindowshot:
    case Kind::kSet:
    case Kind::kState:
    case Kind::kQuit:
      ++next_;
      return step;
    default:
      ++next_;
      Play(step);
      return std::nullopt;
  }
}

ScriptedInput ScriptPlayer::NextFrame() {
  if (frames_.empty()) return hands_;
  const ScriptedInput frame = frames_.front();
  frames_.pop_front();
  return frame;
}

// The hands as they are now, for one frame; what lasts no longer than that is over then.
void ScriptPlayer::AddFrame() {
  frames_.push_back(hands_);
  hands_.scroll = {0, 0};
  hands_.key.reset();
}

void ScriptPlayer::Press(const std::string& button, bool down) {
  (button == "left" ? hands_.left : button == "right" ? hands_.right : hands_.middle) = down;
  AddFrame();
}

void ScriptPlayer::Play(const ScriptStep& step) {
  using Kind = ScriptStep::Kind;
  const auto move = [&](size_t first) {
    hands_.pointer = {step.numbers[first], step.numbers[first + 1]};
    AddFrame();
  };
  const auto hold = [&](bool down) {
    (step.text == "shift" ? hands_.shift : step.text == "ctrl" ? hands_.ctrl : hands_.alt) = down;
    AddFrame();
  };
  switch (step.kind) {
    case Kind::kKey:
      hands_.key = KeyNumber(step.text);
      AddFrame();
      AddFrame();  // let go
      break;
    case Kind::kMove:
      move(0);
      break;
    case Kind::kPress:
      Press(step.text, true);
      break;
    case Kind::kRelease:
      Press(step.text, false);
      break;
    case Kind::kDrag: {
      move(0);
      Press(step.text, true);
      const Eigen::Vector2d from(step.numbers[0], step.numbers[1]);
      const Eigen::Vector2d to(step.numbers[2], step.numbers[3]);
      for (int i = 1; i <= kDragFrames; ++i) {
        hands_.pointer = from + (to - from) * i / kDragFrames;
        AddFrame();
      }
      Press(step.text, false);
      break;
    }
    case Kind::kClick:
    case Kind::kDoubleClick:
      move(0);
      for (int i = 0; i < (step.kind == Kind::kClick ? 1 : 2); ++i) {
        Press(step.text, true);
        Press(step.text, false);
      }
      break;
    case Kind::kScroll:
      hands_.scroll = {step.numbers[0], step.numbers[1]};
      AddFrame();
      break;
    case Kind::kHold:
    case Kind::kLetGo:
      hold(step.kind == Kind::kHold);
      break;
    case Kind::kWait:
      for (int i = 0; i < step.numbers[0]; ++i) AddFrame();
      break;
    default:  // the viewer's, not the hands'
      break;
  }
}

}  // namespace lfm
