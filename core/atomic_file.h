// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lfm {

/// Calls `write` with a temporary name beside `file` (same ending), flushes to disk, and renames it
/// to `file`. Parent folders are made. When `write` throws, the temporary file is removed and
/// `file` is untouched. Throws Error (kSystem) when the disk is full or the folder not writable.
void WriteFileAtomically(const std::filesystem::path& file,
                         const std::function<void(const std::filesystem::path&)>& write);

/// The same for content in memory.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view content);

/// Files that say something together only: `write` puts them into the empty folder that it is
/// given; once all are flushed to disk they take their places in `folder`, which is made where it
/// is missing. When `write` throws, `folder` is as it was, and errors name files by where they
/// would have gone.
void WriteFilesTogether(const std::filesystem::path& folder,
                        const std::function<void(const std::filesystem::path&)>& write);

/// Throws the Error (kSystem) of a file or folder that cannot be written: `error` is the errno that
/// the system gave. A full disk, quota or file size limit is told from a folder without access.
[[noreturn]] void FailWriting(const std::filesystem::path& file, int error);

/// A whole file. Throws Error when it is missing, a folder, or longer than `max_bytes`.
std::string ReadFile(const std::filesystem::path& file, size_t max_bytes = size_t{1} << 34);

}  // namespace lfm
