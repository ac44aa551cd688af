// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

namespace lfm {

/// What a stage tells while it works, and how it is stopped. Handed down by reference; called from
/// the loop that does the work, from any thread.
class Progress {
 public:
  virtual ~Progress() = default;
  /// Begins a named piece of work of `total` steps; ends the one before.
  virtual void Start(std::string_view what, int64_t total) = 0;
  /// Counts steps done. Throws Interrupted when the user asked to stop.
  virtual void Advance(int64_t steps = 1) = 0;
  /// One line for the user, beside the bar.
  virtual void Note(std::string_view line) = 0;
  /// One line for who asked to hear more (--verbose); by default nobody did.
  virtual void Detail(std::string_view /*line*/) {}
};

/// Shows nothing; never interrupts. For tests and inner calls.
Progress& SilentProgress();

/// How much a console says: nothing; progress and notes; details too.
enum class Verbosity { kQuiet, kNormal, kVerbose };

/// For work longer than two seconds: a bar with an estimate on a terminal; elsewhere plain lines,
/// the first after those two seconds, then at most one every ten. Everything goes to stderr.
/// Interrupts when `InterruptRequested()`.
std::unique_ptr<Progress> MakeConsoleProgress(Verbosity verbosity);

/// Set by the SIGINT and SIGTERM handlers that `CommandLine::Run` installs.
bool InterruptRequested();
/// Asks every Progress to stop (what the signal handlers call; async-signal-safe).
void RequestInterrupt();
/// For tests: forgets an earlier request.
void ClearInterruptRequest();

}  // namespace lfm
