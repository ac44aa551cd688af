// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/run_command.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "core/atomic_file.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

[[noreturn]] void Exec(const std::vector<std::string>& arguments, const CommandSettings& settings,
                       const std::string& out, const std::string& err) {
  if (std::freopen(out.c_str(), "w", stdout) == nullptr ||
      std::freopen(err.c_str(), "w", stderr) == nullptr) {
    _exit(126);
  }
  if (settings.max_file_bytes) {
    // Ignored, the signal becomes the error that a full disk gives.
    std::signal(SIGXFSZ, SIG_IGN);
    const auto bytes = static_cast<rlim_t>(*settings.max_file_bytes);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  for (const std::string& entry : settings.environment) {
    const size_t equals = entry.find('=');
    setenv(entry.substr(0, equals).c_str(), entry.substr(equals + 1).c_str(), 1);
  }
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  _exit(127);
}

}  // namespace

CommandOutcome RunCommand(const std::vector<std::string>& arguments,
                          const CommandSettings& settings) {
  const ScratchFolder scratch;
  const std::string out = scratch.folder / "out", err = scratch.folder / "err";
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) Exec(arguments, settings, out, err);
  if (settings.signal_after_seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(*settings.signal_after_seconds));
    kill(child, settings.signal);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CommandOutcome outcome;
  outcome.elapsed_in_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = ReadFile(out);
  outcome.err = ReadFile(err);
  return outcome;
}

bool IsOneLineWith(const std::string& text, const std::vector<std::string>& parts) {
  if (std::count(text.begin(), text.end(), '\n') != 1 || text.back() != '\n') return false;
  return std::all_of(parts.begin(), parts.end(), [&text](const std::string& part) {
    return text.find(part) != std::string::npos;
  });
}

}  // namespace lfm
