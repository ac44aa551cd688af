// SPDX-License-Identifier: BSD-3-Clause
#include "core/process_memory.h"

#include <sys/resource.h>

namespace lfm {

double PeakMemoryMib() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts KiB.
}

}  // namespace lfm
