// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/workspace_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {

WorkspaceLock::WorkspaceLock(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) FailWriting(folder, error.value());
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) FailWriting(folder, errno);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw Error(
        folder.string() +
        ": another run is at work in this folder; wait for its end, or name another folder");
  }
}

WorkspaceLock::~WorkspaceLock() { ::close(descriptor_); }

}  // namespace lfm
