// SPDX-License-Identifier: BSD-3-Clause
#include "core/progress.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

// A signal handler may touch nothing else.
volatile std::sig_atomic_t interrupt_requested = 0;

class Silent : public Progress {
 public:
  void Start(std::string_view, int64_t) override {}
  void Advance(int64_t) override {}
  void Note(std::string_view) override {}
};

using Clock = std::chrono::steady_clock;

std::string Duration(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  if (whole < 60) return std::to_string(whole) + " s";
  return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
}

class Console : public Progress {
 public:
  explicit Console(Verbosity verbosity)
      : verbosity_(verbosity), terminal_(isatty(STDERR_FILENO) == 1) {}
  ~Console() override { EndTask(); }

  void Start(std::string_view what, int64_t total) override {
    const std::lock_guard lock(mutex_);
    ThrowIfInterrupted();
    EndTask();
    what_ = what;
    total_ = std::max<int64_t>(1, total);
    done_ = 0;
    started_ = Clock::now();
    last_shown_.reset();
  }

  void Advance(int64_t steps) override {
    ThrowIfInterrupted();
    const std::lock_guard lock(mutex_);
    done_ += steps;
    if (verbosity_ != Verbosity::kQuiet && !what_.empty()) Show();
  }

  void Note(std::string_view line) override {
    if (verbosity_ != Verbosity::kQuiet) Say(line);
  }

  void Detail(std::string_view line) override {
    if (verbosity_ == Verbosity::kVerbose) Say(line);
  }

 private:
  static void ThrowIfInterrupted() {
    if (InterruptRequested()) throw Interrupted();
  }

  void Say(std::string_view line) {
    const std::lock_guard lock(mutex_);
    ClearBar();
    std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
  }

  static double Since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  void Show() {
    constexpr double kShortTask_s = 2, kRedraw_s = 0.2, kPlainLine_s = 10;
    const double elapsed = Since(started_);
    const double pause = terminal_ ? kRedraw_s : kPlainLine_s;
    if (elapsed < kShortTask_s || (last_shown_ && Since(*last_shown_) < pause)) return;
    last_shown_ = Clock::now();
    const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
    const std::string rest =
        share > 0.02 ? ", about " + Duration(elapsed / share * (1 - share)) + " left" : "";
    if (!terminal_) {
      std::fprintf(stderr, "%s: %.0f %%%s\n", what_.c_str(), 100 * share, rest.c_str());
      return;
    }
    constexpr int kBarWidth = 30;
    const int filled = static_cast<int>(share * kBarWidth);
    const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
    std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%%s", what_.c_str(), bar.c_str(), 100 * share,
                 rest.c_str());
    std::fflush(stderr);
    bar_shown_ = true;
  }

  void ClearBar() {
    if (bar_shown_) std::fprintf(stderr, "\r\033[K");
    bar_shown_ = false;
  }

  void EndTask() {
    ClearBar();
    what_.clear();
  }

  const Verbosity verbosity_;
  const bool terminal_;
  std::mutex mutex_;
  std::string what_;
  int64_t total_ = 1, done_ = 0;
  Clock::time_point started_;
  std::optional<Clock::time_point> last_shown_;
  bool bar_shown_ = false;
};

}  // namespace

Progress& SilentProgress() {
  static Silent silent;
  return silent;
}

std::unique_ptr<Progress> MakeConsoleProgress(Verbosity verbosity) {
  return std::make_unique<Console>(verbosity);
}

bool InterruptRequested() { return interrupt_requested != 0; }
void RequestInterrupt() { interrupt_requested = 1; }
void ClearInterruptRequest() { interrupt_requested = 0; }

}  // namespace lfm
