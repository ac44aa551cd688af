// SPDX-License-Identifier: BSD-3-Clause
#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <mutex>

namespace lfm {
namespace {

// The process-wide bound is TBB's own; this only keeps it alive.
struct ThreadBound {
  std::mutex mutex;
  std::unique_ptr<tbb::global_control> control;
};

ThreadBound& Bound() {
  static ThreadBound bound;
  return bound;
}

}  // namespace

void ParallelFor(int64_t begin, int64_t end, const std::function<void(int64_t)>& body,
                 int64_t grain) {
  if (end <= begin) return;
  tbb::parallel_for(tbb::blocked_range<int64_t>(begin, end, std::max<int64_t>(1, grain)),
                    [&body](const tbb::blocked_range<int64_t>& range) {
                      for (int64_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

void ParallelChunks(int64_t count, int64_t chunk,
                    const std::function<void(int64_t, int64_t, int64_t)>& body) {
  if (count <= 0) return;
  chunk = std::max<int64_t>(1, chunk);
  const int64_t chunks = (count + chunk - 1) / chunk;
  ParallelFor(0, chunks, [&](int64_t c) { body(c * chunk, std::min(count, (c + 1) * chunk), c); });
}

void SetThreadCount(int count) {
  ThreadBound& bound = Bound();
  const std::lock_guard lock(bound.mutex);
  bound.control.reset();
  if (count > 0) {
    bound.control = std::make_unique<tbb::global_control>(
        tbb::global_control::max_allowed_parallelism, static_cast<size_t>(count));
  }
}

int ThreadCount() {
  return static_cast<int>(std::min<size_t>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
      static_cast<size_t>(std::max(tbb::info::default_concurrency(), 1)) * 64));
}

}  // namespace lfm
