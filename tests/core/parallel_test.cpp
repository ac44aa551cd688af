// SPDX-License-Identifier: BSD-3-Clause
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <thread>

#include "test_files.h"

namespace lfm {
namespace {

/// Restores the machine's number of threads.
struct ThreadCountGuard {
  ~ThreadCountGuard() { SetThreadCount(0); }
};

TEST(ParallelFor, VisitsEveryIndexOnce) {
  const ThreadCountGuard guard;
  for (const int threads : {1, 2, 16}) {
    SetThreadCount(threads);
    for (const int64_t grain : {1, 7, 5000, 0}) {
      std::vector<std::atomic<int>> visits(3001);
      ParallelFor(
          5, 3001, [&](int64_t i) { ++visits[i]; }, grain);
      for (int64_t i = 0; i < 3001; ++i) EXPECT_EQ(visits[i], i >= 5 ? 1 : 0);
    }
  }
}

TEST(ParallelFor, EmptyRangesDoNothing) {
  ParallelFor(3, 3, [](int64_t) { ADD_FAILURE(); });
  ParallelFor(3, -3, [](int64_t) { ADD_FAILURE(); });
  ParallelChunks(0, 4, [](int64_t, int64_t, int64_t) { ADD_FAILURE(); });
  ParallelChunks(-1, 4, [](int64_t, int64_t, int64_t) { ADD_FAILURE(); });
}

TEST(ParallelFor, RethrowsAnError) {
  const ThreadCountGuard guard;
  for (const int threads : {1, 2, 16}) {
    SetThreadCount(threads);
    ExpectError(
        [] {
          ParallelFor(0, 1000, [](int64_t i) {
            if (i == 500) throw Error("index 500");
          });
        },
        "index 500");
  }
  int64_t after = 0;
  ParallelFor(0, 1, [&](int64_t) { ++after; });
  EXPECT_EQ(after, 1);
}

TEST(ParallelChunks, SplitIsTheSameForEveryNumberOfThreads) {
  const ThreadCountGuard guard;
  for (const int threads : {1, 3, 16}) {
    SetThreadCount(threads);
    std::mutex mutex;
    std::set<std::vector<int64_t>> chunks;
    ParallelChunks(10, 4, [&](int64_t begin, int64_t end, int64_t index) {
      const std::lock_guard lock(mutex);
      chunks.insert({begin, end, index});
    });
    const std::set<std::vector<int64_t>> expected = {{0, 4, 0}, {4, 8, 1}, {8, 10, 2}};
    EXPECT_EQ(chunks, expected);
  }
}

// A float sum depends on its order; a sum over chunks in order may not depend on the threads.
TEST(ParallelChunks, SumsAreTheSameForEveryNumberOfThreads) {
  const ThreadCountGuard guard;
  std::vector<float> values(100000);
  for (size_t i = 0; i < values.size(); ++i) values[i] = std::sin(static_cast<float>(i)) * 1e3f;
  const auto sum = [&] {
    std::vector<float> partial(100);
    ParallelChunks(100000, 1000, [&](int64_t begin, int64_t end, int64_t index) {
      for (int64_t i = begin; i < end; ++i) partial[index] += values[i];
    });
    float total = 0;
    for (const float p : partial) total += p;
    return total;
  };
  SetThreadCount(1);
  const float one = sum();
  for (const int threads : {2, 5, 32}) {
    SetThreadCount(threads);
    EXPECT_EQ(sum(), one);
  }
}

TEST(SetThreadCount, BoundsTheThreadsThatWork) {
  const ThreadCountGuard guard;
  SetThreadCount(1);
  EXPECT_EQ(ThreadCount(), 1);
  std::mutex mutex;
  std::set<std::thread::id> threads;
  ParallelFor(0, 100, [&](int64_t) {
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(threads.size(), 1u);
  SetThreadCount(3);
  EXPECT_EQ(ThreadCount(), 3);
  SetThreadCount(0);
  EXPECT_GE(ThreadCount(), 1);
}

}  // namespace
}  // namespace lfm
