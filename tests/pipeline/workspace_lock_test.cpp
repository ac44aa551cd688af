// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/workspace_lock.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

TEST(WorkspaceLock, KeepsASecondRunOutUntilTheFirstEnds) {
  const ScratchFolder scratch;
  const fs::path work = scratch.folder / "new" / "work";
  std::optional<WorkspaceLock> first(std::in_place, work);
  try {
    const WorkspaceLock second(work);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(work.string() + ": another run"), std::string::npos)
        << e.what();
    EXPECT_EQ(e.kind(), ErrorKind::kInput);
  }
  EXPECT_NO_THROW(WorkspaceLock(scratch.folder / "other"));
  first.reset();
  EXPECT_NO_THROW(WorkspaceLock{work});
  EXPECT_TRUE(fs::is_empty(work));
}

TEST(WorkspaceLock, AFolderThatCannotBeMadeIsASystemError) {
  const ScratchFolder scratch;
  WriteFileAtomically(scratch.folder / "file", "");
  for (const char* name : {"file", "file/work"}) {
    try {
      const WorkspaceLock lock(scratch.folder / name);
      FAIL() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kSystem) << e.what();
    }
  }
}

}  // namespace
}  // namespace lfm
