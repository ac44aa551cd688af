// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

namespace lfm {

/// Runs `body(i)` for every i in [begin, end) on the threads allowed by `SetThreadCount`.
///
/// Iterations must be independent and write to their own places; then results do not depend on the
/// number of threads. The first exception thrown by a body is rethrown here, the rest is abandoned.
/// `grain` iterations at least are done by one thread at a time.
void ParallelFor(int64_t begin, int64_t end, const std::function<void(int64_t)>& body,
                 int64_t grain = 1);

/// Runs `body(chunk_begin, chunk_end, chunk_index)` over chunks of exactly `chunk` items (the last
/// may be shorter): the split, and so any sum over chunks in order, is the same for every number
/// of threads.
void ParallelChunks(int64_t count, int64_t chunk,
                    const std::function<void(int64_t, int64_t, int64_t)>& body);

/// Bounds the number of threads of this process; 0 means all that the machine has.
void SetThreadCount(int count);
/// The bound that holds now: what SetThreadCount set, else all that the machine has.
int ThreadCount();

}  // namespace lfm
