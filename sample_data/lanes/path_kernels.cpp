// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/lanes/path_kernels.h"

#include <vector>

namespace lfm {

extern const PathKernels kernels_of_lanes_baseline;
#ifdef LFM_LANES_X86
extern const PathKernels kernels_of_lanes_avx2;
#endif

std::span<const PathKernels> UsablePathKernels() {
  static const std::vector<PathKernels> usable = [] {
    std::vector<PathKernels> kernels;
#ifdef LFM_LANES_X86
    if (__builtin_cpu_supports("avx2")) kernels.push_back(kernels_of_lanes_avx2);
#endif
    kernels.push_back(kernels_of_lanes_baseline);
    return kernels;
  }();
  return usable;
}

}  // namespace lfm
