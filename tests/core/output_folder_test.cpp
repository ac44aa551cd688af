// SPDX-License-Identifier: BSD-3-Clause
#include "core/output_folder.h"

#include <gtest/gtest.h>

#include "test_files.h"

namespace lfm {
namespace {

TEST(OutputFolder, WhatCanBeWrittenIsLeftAsItIs) {
  const TestFolder folder;
  EXPECT_NO_THROW(RequireWritableFolder(folder.path()));
  EXPECT_NO_THROW(RequireWritableFolder(folder / "new"));
  EXPECT_NO_THROW(RequireWritableFolder(folder / "a/b/c/"));
  EXPECT_NO_THROW(RequireWritableFolder("no_such_folder_here/b"));
  EXPECT_NO_THROW(RequireWritableFolder(""));
  EXPECT_EQ(folder.FileCount(), 0);
  EXPECT_FALSE(std::filesystem::exists("no_such_folder_here"));
}

TEST(OutputFolder, AFileInTheWayIsNamed) {
  const TestFolder folder;
  Put(folder / "file", "");
  for (const char* name : {"file", "file/calib", "file/x/calib"}) {
    ExpectError([&] { RequireWritableFolder(folder / name); }, (folder / name).string());
    ExpectError([&] { RequireWritableFolder(folder / name); },
                (folder / "file").string() + " is no folder");
  }
  std::filesystem::create_symlink(folder / "nowhere", folder / "link");
  ExpectError([&] { RequireWritableFolder(folder / "link/calib"); }, "link is no folder");
}

TEST(OutputFolder, WhatTheSystemRefusesIsInputThatIsWrong) {
  ExpectError([] { RequireWritableFolder("/proc/x"); }, "/proc/x");
  const TestFolder folder;
  ExpectError([&] { RequireWritableFolder(folder / std::string(300, 'x')); }, "too long");
}

}  // namespace
}  // namespace lfm
