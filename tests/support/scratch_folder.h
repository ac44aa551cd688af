// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>

namespace lfm {

/// A folder of its own for one test, removed at the end.
struct ScratchFolder {
  ScratchFolder() {
    static std::atomic<int> counter{0};
    folder = std::filesystem::temp_directory_path() /
             ("lfm-test-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
    std::filesystem::create_directories(folder);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path folder;
};

}  // namespace lfm
