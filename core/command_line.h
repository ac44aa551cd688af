// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/options.h"
#include "core/progress.h"

namespace lfm {

/// A command's surface. Every command has --help (with an example), --quiet, --verbose, --threads,
/// --config FILE (TOML) and --version besides what is added here.
class CommandLine {
 public:
  /// `example` is one full command line that works.
  CommandLine(std::string name, std::string description, std::string example);
  ~CommandLine();

  /// Adds a required positional argument.
  void Positional(const std::string& name, const std::string& help, std::string& value);
  /// Adds every declared option of a struct, under an optional group title shown by --help.
  void Options(AnyOptions options, const std::string& group = "");

  /// Sets the declared values from the arguments and the config file without acting on them:
  /// presets look at one option before the others get their defaults. Faults are left to Run.
  void Peek(int argc, char** argv);

  /// Whether the option, named without "--", stood among the arguments or in the config file, with
  /// whatever value. Meant for the body that Run runs; no option of that name is a mistake of ours.
  bool Given(const std::string& option) const;

  /// Parses, installs signal handlers, runs `body`, and turns exceptions into one line on stderr
  /// ("lfm-scan: error: ...") and the exit status: 0; 2 for bad input or usage; 1 for our own
  /// failure or a full disk; 130 when interrupted. Also used for --help and --version (status 0).
  int Run(int argc, char** argv, const std::function<void(Progress&)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
