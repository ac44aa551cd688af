// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace lfm {

/// 64-bit XXH3 of bytes; for checksums of file chunks.
uint64_t Checksum(const void* data, size_t size);

/// Tells a file from others that bear its name: a 128-bit XXH3 over its size and 4 KiB each from
/// its start, middle and end, so its cost does not grow with the file. Empty when there is no
/// regular file or it cannot be read. It cannot prove that two files are the same (Hasher::AddFile
/// can).
std::string FileFingerprint(const std::filesystem::path& file);

/// A 128-bit XXH3 built up from pieces; each piece is delimited, so that {"ab", "c"} and
/// {"a", "bc"} differ. For "has this input changed", not for security.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;
  Hasher& Add(std::string_view piece);
  /// Adds a file's content. Throws Error when it cannot be read.
  Hasher& AddFile(const std::filesystem::path& file);
  /// 32 hexadecimal digits.
  std::string HexDigest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
