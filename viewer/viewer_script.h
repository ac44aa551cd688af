// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lfm {

/// One line of a viewer script: what a user does, or what is asked of the viewer. Steps with two
/// words in their names are joined by a hyphen in the file (double-click, let-go).
struct ScriptStep {
  enum class Kind {
    kKey,          ///< text: a key's name (below); pressed and released
    kMove,         ///< numbers: x, y
    kPress,        ///< text: left, right or middle
    kRelease,      ///< the same
    kDrag,         ///< text: button; numbers: x0, y0, x1, y1; takes several frames
    kClick,        ///< text: button; numbers: x, y
    kDoubleClick,  ///< the same
    kScroll,       ///< numbers: steps to the right, steps forwards (away from the user)
    kHold,         ///< text: shift, ctrl or alt: held down from here on
    kLetGo,        ///< the same, let go
    kDrop,         ///< text: a file, dropped on the window
    kResize,       ///< numbers: width, height of the window, whole; 0 as when minimised
    kWait,         ///< numbers: frames, whole, 1 at least
    kLoaded,       ///< waits until nothing is being read or recorded any more
    kScreenshot,   ///< text: a .png file; the scene alone
    kWindowshot,   ///< text: a .png file; panels included
    kSet,          ///< text: a setting's name, one blank, its value (viewer_settings.h: SetByName)
    kState,        ///< text: a .json file that the viewer writes its state into
    kQuit,         ///< the last step, and only that
  };
  Kind kind;
  std::string text;
  std::vector<double> numbers;
  int line = 0;  ///< in the script, from 1; of a quit that was added, one behind its last
};

/// Reads a viewer script (docs/formats.md): one step a line, words apart by blanks, a '#' where a
/// word could begin makes the rest of the line a comment:
///
///   loaded
///   drag left 100 80 160 80
///   hold shift
///   scroll 0 -2
///   key M
///   screenshot mean.png
///   quit
///
/// The last word of steps with files, and of set, is the rest of the line. Keys: letters (in either
/// case; capital in `text`), digits, F1 to F12, home, end, left, right, up, down, page-up,
/// page-down, escape, space, enter, tab, delete, minus, plus, [ and ]. Files are relative to the
/// current folder. A script that does not end with quit ends with it. Throws Error, naming file and
/// line, for anything else, steps behind quit, numbers that are not finite or beyond 16384, scripts
/// of more than 100 000 lines or 16 MB. Names of settings are not looked at.
std::vector<ScriptStep> ReadViewerScript(const std::filesystem::path& file);

}  // namespace lfm
