// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lfm {

/// Keeps a workspace for one run at a time while it lives; the folder is made when absent. The
/// lock is the system's (flock on the folder): it leaves no file and ends with the process.
///
/// Throws Error when another run holds the folder, or (kSystem) when the folder cannot be made. A
/// file system without locks goes unguarded.
class WorkspaceLock {
 public:
  explicit WorkspaceLock(const std::filesystem::path& folder);
  ~WorkspaceLock();
  WorkspaceLock(const WorkspaceLock&) = delete;
  WorkspaceLock& operator=(const WorkspaceLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace lfm
