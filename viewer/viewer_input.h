// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "viewer/viewer_script.h"
#include "viewer/viewer_state.h"

namespace lfm {

/// What a user does within a frame, as a script has it.
struct ScriptedInput {
  Eigen::Vector2d pointer = {-1, -1};  ///< from the window's upper left corner
  bool left = false, right = false, middle = false;
  bool shift = false, ctrl = false, alt = false;
  Eigen::Vector2d scroll = {0, 0};
  std::optional<int> key;  ///< GLFW's number
};

/// Plays a script: turns its steps into what a user does frame by frame.
class ScriptPlayer {
 public:
  explicit ScriptPlayer(std::vector<ScriptStep> steps);

  /// What is to be done before the next frame that no hands do (drop, resize, screenshot, set,
  /// ...); one step at most: what was done before has been drawn by then. `busy`: something is
  /// being read or recorded, for which "loaded" waits.
  std::optional<ScriptStep> Request(bool busy);
  /// The user's hands in the next frame. Call once a frame, after Request.
  ScriptedInput NextFrame();

 private:
  void Play(const ScriptStep& step);
  void Press(const std::string& button, bool down);
  void AddFrame();
  std::vector<ScriptStep> steps_;
  size_t next_ = 0;
  std::deque<ScriptedInput> frames_;  ///< still to come of the step that is being played
  ScriptedInput hands_;               ///< as the last of them leaves them
};

/// GLFW's number of a key named as in scripts; none for other names.
std::optional<int> KeyNumber(const std::string& name);

/// The action of a key; none for keys without one.
std::optional<ViewerAction> ActionOfKey(int key, bool shift);

}  // namespace lfm
