// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>
#include <optional>
#include <string>
#include <vector>

namespace lfm {

/// What a finished command left.
struct CommandOutcome {
  int status = -1;  ///< exit status, or 128 + signal
  std::string out, err;
  double elapsed_in_seconds = 0;
};

struct CommandSettings {
  /// No file may grow beyond this: what a full disk looks like to the program.
  std::optional<long> max_file_bytes;
  /// Sends `signal` after so long.
  std::optional<double> signal_after_seconds;
  int signal = SIGINT;
  /// "NAME=value" added to the environment.
  std::vector<std::string> environment;
};

/// Runs a program with arguments (no shell) and waits for it.
CommandOutcome RunCommand(const std::vector<std::string>& arguments,
                          const CommandSettings& settings = {});

/// True when `text` is exactly one line (ended by a newline) that holds each of `parts`.
bool IsOneLineWith(const std::string& text, const std::vector<std::string>& parts);

}  // namespace lfm
