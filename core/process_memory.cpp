// SPDX-License-Identifier: BSD-3-Clause
#include "core/process_memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <sstream>

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

int64_t AvailableMemoryBytes() {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    int64_t kib = 0;
    if (words >> name >> kib && name == "MemAvailable:") return kib * 1024;
  }
  return std::numeric_limits<int64_t>::max();
}

int64_t MemoryLimit::BytesLeft() const {
  if (limit_mib_ == 0) return AvailableMemoryBytes();
  return limit_mib_ * kMib - ResidentMemoryBytes();
}

void MemoryLimit::Require(int64_t bytes, const std::string& what, const std::string& cure) const {
  const int64_t left = BytesLeft(), lacking = bytes - left;
  if (lacking <= 0) return;
  if (limit_mib_ == 0) {
    throw Error(what + " takes some " + std::to_string(bytes / kMib) +
                " MiB, and the machine has " + std::to_string(left / kMib) + " free; free some, " +
                cure);
  }
  throw Error(option_ + (" " + std::to_string(limit_mib_)) + ": " + what + " takes some " +
              std::to_string(limit_mib_ + lacking / kMib + 1) + " MiB in all; allow that much, " +
              cure);
}

}  // namespace lfm
