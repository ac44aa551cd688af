// SPDX-License-Identifier: BSD-3-Clause
#include "core/process_memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int64_t kMib = int64_t{1} << 20;

}  // namespace

double PeakMemoryMib() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts KiB.
}

int64_t ResidentMemoryBytes() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ifstream pages("/proc/self/statm");
  int64_t size = 0, resident = 0;
  pages >> size >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

int64_t MemoryLimit::BytesLeft() const { return limit_mib_ * kMib - ResidentMemoryBytes(); }

void MemoryLimit::Require(int64_t bytes, const std::string& what, const std::string& cure) const {
  const int64_t lacking = bytes - BytesLeft();
  if (lacking <= 0) return;
  throw Error("--memory-mib " + std::to_string(limit_mib_) + ": " + what + " takes some " +
              std::to_string(limit_mib_ + lacking / kMib + 1) + " MiB in all; allow that much, " +
              cure);
}

}  // namespace lfm
