// SPDX-License-Identifier: BSD-3-Clause
#include "core/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {

ScratchFile::ScratchFile(const std::filesystem::path& result) : result_(result) {
  const std::filesystem::path folder = result.has_parent_path() ? result.parent_path() : ".";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) FailWriting(result_, error.value());
  descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor_ >= 0) return;
  // Not every file system knows files without a name.
  std::string name = (folder / ".scratch_XXXXXX").string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) FailWriting(result_, errno);
  ::unlink(name.c_str());
}

ScratchFile::~ScratchFile() { ::close(descriptor_); }

uint64_t ScratchFile::Append(const void* data, size_t size) {
  uint64_t begin = 0;
  {
    const std::lock_guard lock(mutex_);
    begin = end_;
    end_ += size;
  }
  const char* rest = static_cast<const char*>(data);
  for (uint64_t at = begin; at < begin + size;) {
    const ssize_t written = ::pwrite(descriptor_, rest, begin + size - at, static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) FailWriting(result_, errno);
    rest += written;
    at += static_cast<uint64_t>(written);
  }
  return begin;
}

void ScratchFile::Read(uint64_t offset, void* data, size_t size) const {
  char* rest = static_cast<char*>(data);
  for (uint64_t at = offset; at < offset + size;) {
    const ssize_t got = ::pread(descriptor_, rest, offset + size - at, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      throw Error(result_.string() + ": what was put aside beside it cannot be read back",
                  ErrorKind::kSystem);
    }
    rest += got;
    at += static_cast<uint64_t>(got);
  }
}

MappedFile ScratchFile::Map() const { return {descriptor_, result_.string()}; }

}  // namespace lfm
