// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>

#include "core/mapped_file.h"

namespace lfm {

/// Bytes that lie on disk while a piece of work lasts, for what memory would not hold: a file
/// without a name, gone with this object (and any mapping of it) however the process ends (of a
/// file system without such files: unless it is killed between making it and taking its name away).
///
/// Throws Error (kSystem) naming the result when its folder is not writable or its disk is full.
class ScratchFile {
 public:
  /// Lies in the folder of `result`, the file that the work is to make.
  explicit ScratchFile(const std::filesystem::path& result);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// Writes behind what is there and returns where it begins. Safe to call from many threads.
  uint64_t Append(const void* data, size_t size);
  /// Reads what was appended. Safe to call from many threads.
  void Read(uint64_t offset, void* data, size_t size) const;
  /// All that was appended so far.
  MappedFile Map() const;

 private:
  std::filesystem::path result_;
  int descriptor_ = -1;
  std::mutex mutex_;
  uint64_t end_ = 0;
};

}  // namespace lfm
