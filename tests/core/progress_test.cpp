// SPDX-License-Identifier: BSD-3-Clause
#include "core/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/process_memory.h"
#include "test_files.h"

namespace lfm {
namespace {

TEST(Progress, InterruptsWhenAskedTo) {
  const std::unique_ptr<Progress> progress = MakeConsoleProgress(Verbosity::kQuiet);
  progress->Start("work", 3);
  EXPECT_NO_THROW(progress->Advance());
  RequestInterrupt();
  EXPECT_TRUE(InterruptRequested());
  EXPECT_THROW(progress->Advance(), Interrupted);
  EXPECT_THROW(progress->Start("more", 3), Interrupted);
  EXPECT_NO_THROW(SilentProgress().Advance());
  ClearInterruptRequest();
  EXPECT_FALSE(InterruptRequested());
  EXPECT_NO_THROW(progress->Advance(5));
}

TEST(Progress, ShortWorkSaysNothing) {
  testing::internal::CaptureStderr();
  {
    const std::unique_ptr<Progress> progress = MakeConsoleProgress(Verbosity::kNormal);
    progress->Start("work", 0);
    progress->Advance();
    progress->Start("other", 5);
    progress->Advance(5);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, WorkLongerThanTwoSecondsSaysAPlainLineAndNotTwo) {
  testing::internal::CaptureStderr();
  {
    const std::unique_ptr<Progress> progress = MakeConsoleProgress(Verbosity::kNormal);
    progress->Start("work", 4);
    progress->Advance();
    std::this_thread::sleep_for(std::chrono::milliseconds(2050));
    progress->Advance();
    progress->Advance();
  }
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(said.rfind("work: 50 %", 0), 0u) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST(ProcessMemory, GrowsWithUse) {
  const double before = PeakMemoryMib();
  EXPECT_GT(before, 1);
  std::vector<char> block(size_t{64} << 20);
  for (size_t i = 0; i < block.size(); i += 4096) block[i] = 1;
  EXPECT_GE(PeakMemoryMib(), std::max(before, 64.0));
  EXPECT_EQ(block[4096], 1);
}

}  // namespace
}  // namespace lfm
