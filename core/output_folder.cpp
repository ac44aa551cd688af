// SPDX-License-Identifier: BSD-3-Clause
#include "core/output_folder.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Refuse(const fs::path& folder, const std::string& why) {
  throw Error(folder.string() + ": nothing can be written there (" + why +
              "); name another folder, or check its permissions");
}

// A link that leads nowhere is there, too: no folder can be made in its place.
fs::path NearestThatExists(const fs::path& folder) {
  fs::path place = folder;
  while (true) {
    std::error_code error;
    const fs::file_status status = fs::symlink_status(place, error);
    if (fs::exists(status)) return place;
    if (status.type() != fs::file_type::not_found) Refuse(folder, error.message());
    const fs::path parent = place.parent_path();
    // A relative path ends in the current folder.
    if (parent.empty() || parent == place) return place.is_absolute() ? "/" : ".";
    place = parent;
  }
}

}  // namespace

void RequireWritableFolder(const fs::path& folder) {
  const fs::path place = NearestThatExists(folder);
  std::error_code ignored;
  if (!fs::is_directory(place, ignored)) Refuse(folder, place.string() + " is no folder");
  // Permissions alone do not tell: not of /proc, nor of a disk that is mounted read-only.
  std::string probe = place / ".lfm-probe-XXXXXX";
  if (::mkdtemp(probe.data()) == nullptr) {
    const int error = errno;
    if (error == ENOSPC || error == EDQUOT) FailWriting(folder, error);
    Refuse(folder, error == ENOENT ? place.string() + " takes no files" : std::strerror(error));
  }
  ::rmdir(probe.c_str());
}

}  // namespace lfm
