// SPDX-License-Identifier: BSD-3-Clause
#include "core/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/error.h"

namespace lfm {
namespace {

// A full disk may show only when the data reaches it.
void FlushToDisk(const std::filesystem::path& temporary, const std::filesystem::path& file) {
  const int descriptor = ::open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) FailWriting(file, errno);
  const int status = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  // EINVAL: the file system has nothing to flush.
  if (status != 0 && error != EINVAL) FailWriting(file, error);
}

std::filesystem::path TemporaryName(const std::filesystem::path& file) {
  static std::atomic<int> counter{0};
  return file.parent_path() / ("." + file.stem().string() + "." + std::to_string(::getpid()) + "." +
                               std::to_string(counter++) + ".tmp" + file.extension().string());
}

class Temporary {
 public:
  explicit Temporary(std::filesystem::path name) : name_(std::move(name)) {}
  ~Temporary() {
    std::error_code ignored;
    if (!name_.empty()) std::filesystem::remove_all(name_, ignored);
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  const std::filesystem::path& name() const { return name_; }
  void Release() { name_.clear(); }

 private:
  std::filesystem::path name_;
};

}  // namespace

void FailWriting(const std::filesystem::path& file, int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  throw Error(file.string() + ": cannot be written (" + std::strerror(error) + "); " +
                  (full ? "free some space and run again" : "check that the folder can be written"),
              ErrorKind::kSystem);
}

void WriteFileAtomically(const std::filesystem::path& file,
                         const std::function<void(const std::filesystem::path&)>& write) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  if (error) FailWriting(file, error.value());
  Temporary temporary(TemporaryName(file));
  write(temporary.name());
  FlushToDisk(temporary.name(), file);
  std::filesystem::rename(temporary.name(), file, error);
  if (error) FailWriting(file, error.value());
  temporary.Release();
}

void WriteFilesTogether(const std::filesystem::path& folder,
                        const std::function<void(const std::filesystem::path&)>& write) {
  const Temporary temporary(TemporaryName(folder / "files"));
  const std::string name = temporary.name().string();
  std::error_code error;
  std::filesystem::create_directories(temporary.name(), error);
  if (error) FailWriting(folder, error.value());
  try {
    write(temporary.name());
  } catch (const Error& failure) {
    std::string message = failure.what();
    const size_t at = message.find(name);
    if (at != std::string::npos) message.replace(at, name.size(), folder.string());
    throw Error(message, failure.kind());
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(temporary.name())) {
    files.push_back(entry.path().filename());
    // No file takes the place of a folder: before any takes its own.
    if (std::filesystem::is_directory(folder / files.back(), error)) {
      FailWriting(folder / files.back(), EISDIR);
    }
  }
  for (const std::filesystem::path& file : files) {
    std::filesystem::rename(temporary.name() / file, folder / file, error);
    if (error) FailWriting(folder / file, error.value());
  }
}

void WriteFileAtomically(const std::filesystem::path& file, std::string_view content) {
  WriteFileAtomically(file, [&](const std::filesystem::path& temporary) {
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) FailWriting(file, errno);
    size_t written = 0;
    while (written < content.size()) {
      const ssize_t n = ::write(descriptor, content.data() + written, content.size() - written);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        const int write_error = errno;
        ::close(descriptor);
        FailWriting(file, write_error);
      }
      written += static_cast<size_t>(n);
    }
    if (::close(descriptor) != 0) FailWriting(file, errno);
  });
}

std::string ReadFile(const std::filesystem::path& file, size_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    throw Error(file.string() + ": no such file; check the name, or run the stage that makes it");
  }
  if (!std::filesystem::is_regular_file(file, error)) {
    throw Error(file.string() + ": is not a file");
  }
  const uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw Error(file.string() + ": cannot be read (" + error.message() + ")");
  if (size > max_bytes) {
    throw Error(file.string() + ": is " + std::to_string(size) + " bytes long, more than the " +
                std::to_string(max_bytes) + " that such a file may have");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string content(size, '\0');
  if (!stream.read(content.data(), static_cast<std::streamsize>(size))) {
    throw Error(file.string() + ": cannot be read; check its permissions");
  }
  return content;
}

}  // namespace lfm
