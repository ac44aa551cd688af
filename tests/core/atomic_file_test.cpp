// SPDX-License-Identifier: BSD-3-Clause
#include "core/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>

#include "core/error.h"
#include "test_files.h"

namespace lfm {
namespace {

/// A limit on the size of files: writing past it fails as it does on a full disk.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int);
};

TEST(AtomicFile, WritesMakesFoldersAndReplaces) {
  const TestFolder folder;
  WriteFileAtomically(folder / "a/b/c.txt", "first");
  WriteFileAtomically(folder / "a/b/c.txt", std::string_view("sec\0nd", 6));
  EXPECT_EQ(Get(folder / "a/b/c.txt"), std::string("sec\0nd", 6));
  EXPECT_EQ(folder.FileCount(), 3);
  WriteFileAtomically(folder / "empty", "");
  EXPECT_EQ(Get(folder / "empty"), "");
}

TEST(AtomicFile, WriterGetsAnotherNameWithTheSameEnding) {
  const TestFolder folder;
  std::filesystem::path seen;
  WriteFileAtomically(folder / "picture.png", [&](const std::filesystem::path& temporary) {
    seen = temporary;
    EXPECT_FALSE(std::filesystem::exists(folder / "picture.png"));
    Put(temporary, "pixels");
  });
  EXPECT_EQ(seen.extension(), ".png");
  EXPECT_EQ(seen.parent_path(), folder.path());
  EXPECT_NE(seen, folder / "picture.png");
  EXPECT_EQ(Get(folder / "picture.png"), "pixels");
  EXPECT_EQ(folder.FileCount(), 1);
}

TEST(AtomicFile, FailingWriterLeavesNothingBehind) {
  const TestFolder folder;
  Put(folder / "a.txt", "old");
  ExpectError(
      [&] {
        WriteFileAtomically(folder / "a.txt", [](const std::filesystem::path& temporary) {
          Put(temporary, "half");
          throw Error("no more");
        });
      },
      "no more");
  EXPECT_EQ(Get(folder / "a.txt"), "old");
  EXPECT_EQ(folder.FileCount(), 1);
}

TEST(AtomicFile, FullDiskIsASystemErrorAndKeepsTheOldFile) {
  const TestFolder folder;
  Put(folder / "a.txt", "old");
  {
    const SmallDisk disk(4096);
    const auto write = [&] { WriteFileAtomically(folder / "a.txt", std::string(100000, 'x')); };
    ExpectError(write, "a.txt", ErrorKind::kSystem);
    ExpectError(write, "free some space", ErrorKind::kSystem);
  }
  EXPECT_EQ(Get(folder / "a.txt"), "old");
  EXPECT_EQ(folder.FileCount(), 1);
}

TEST(AtomicFile, WriterThatMakesNoFileIsAnError) {
  const TestFolder folder;
  ExpectError([&] { WriteFileAtomically(folder / "a.txt", [](const std::filesystem::path&) {}); },
              "a.txt", ErrorKind::kSystem);
  EXPECT_EQ(folder.FileCount(), 0);
}

TEST(AtomicFile, FolderThatCannotBeMadeIsASystemError) {
  const TestFolder folder;
  Put(folder / "file", "");
  ExpectError([&] { WriteFileAtomically(folder / "file/a.txt", "x"); }, "a.txt",
              ErrorKind::kSystem);
  std::filesystem::create_directory(folder / "target");
  Put(folder / "target/inside", "");
  ExpectError([&] { WriteFileAtomically(folder / "target", "x"); }, "target", ErrorKind::kSystem);
  EXPECT_EQ(folder.FileCount(), 3);
}

TEST(FailWriting, TellsAFullDiskFromAFolderWithoutAccess) {
  for (int full : {ENOSPC, EDQUOT, EFBIG}) {
    ExpectError([&] { FailWriting("a.txt", full); }, "free some space", ErrorKind::kSystem);
  }
  ExpectError([] { FailWriting("a.txt", EACCES); }, "check that the folder can be written",
              ErrorKind::kSystem);
}

TEST(ReadFile, ReadsAllBytesAndRefusesTheRest) {
  const TestFolder folder;
  const std::string bytes("a\0b\nc\r\n", 7);
  Put(folder / "a", bytes);
  EXPECT_EQ(ReadFile(folder / "a"), bytes);
  EXPECT_EQ(ReadFile(folder / "a", 7), bytes);
  ExpectError([&] { ReadFile(folder / "a", 6); }, "7 bytes long");
  ExpectError([&] { ReadFile(folder / "none"); }, "none: no such file");
  ExpectError([&] { ReadFile(folder.path()); }, "is not a file");
  ExpectError([&] { ReadFile("/dev/zero"); }, "is not a file");
  Put(folder / "empty", "");
  EXPECT_EQ(ReadFile(folder / "empty"), "");
}

TEST(AtomicFile, FilesWrittenTogetherReplaceAllOrNone) {
  const TestFolder folder;
  const auto write = [](const std::string& content, size_t bytes) {
    return [=](const std::filesystem::path& together) {
      WriteFileAtomically(together / "a.txt", content);
      WriteFileAtomically(together / "b.txt", content + std::string(bytes, '.'));
    };
  };
  WriteFilesTogether(folder / "made/here", write("first", 0));
  WriteFileAtomically(folder / "made/here/other.txt", "kept");
  {
    const SmallDisk small(1000);
    try {
      WriteFilesTogether(folder / "made/here", write("second", 2000));
      FAIL() << "a full disk went unnoticed";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kSystem);
      EXPECT_NE(std::string(error.what()).find((folder / "made/here/b.txt").string()),
                std::string::npos);
    }
  }
  EXPECT_EQ(ReadFile(folder / "made/here/a.txt"), "first");
  EXPECT_EQ(ReadFile(folder / "made/here/b.txt"), "first");
  WriteFilesTogether(folder / "made/here", write("third", 1));
  EXPECT_EQ(ReadFile(folder / "made/here/a.txt"), "third");
  EXPECT_EQ(ReadFile(folder / "made/here/b.txt"), "third.");
  EXPECT_EQ(ReadFile(folder / "made/here/other.txt"), "kept");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "made/here")) {
    files += entry.is_regular_file() ? 1 : 100;
  }
  EXPECT_EQ(files, 3);
}

}  // namespace
}  // namespace lfm
