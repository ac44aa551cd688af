// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace lfm {

/// A file's content mapped into memory, read-only, until destruction.
///
/// Files of this program appear under their names complete and are replaced, never changed, so a
/// mapping stays valid. Throws Error when the file is missing, not a regular file, or unreadable.
class MappedFile {
 public:
  MappedFile() = default;
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;

  std::span<const std::byte> bytes() const { return {data_, size_}; }
  /// Takes pages that were read out of this process's resident memory; they come back (from the
  /// system's cache, or the disk) when they are read again, by any thread at any time. All of
  /// them, or those wholly within `part` of bytes().
  void Release() const { Release(bytes()); }
  void Release(std::span<const std::byte> part) const;

 private:
  friend class ScratchFile;
  /// Of an open file, which stays open; `name` stands for it in messages.
  MappedFile(int descriptor, const std::string& name);

  const std::byte* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace lfm
