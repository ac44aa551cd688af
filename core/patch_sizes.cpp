// SPDX-License-Identifier: BSD-3-Clause
#include "core/patch_sizes.h"

#include <algorithm>

namespace lfm {

int ChooseEdgeSamples(double samples, int max_edge_samples) {
  constexpr int kSmallest = 4, kLargest = 193;
  int n = kSmallest;
  while (PatchSampleCount(n) < samples && 2 * n - 1 <= std::min(max_edge_samples, kLargest)) {
    n = 2 * n - 1;
  }
  return n;
}

}  // namespace lfm
