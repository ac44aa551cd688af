// SPDX-License-Identifier: BSD-3-Clause
#include "scan/neighbour_check.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace lfm {

void RejectContradicted(int width, int height, double reach_px, AxisCoordinates& axis) {
  const size_t w = static_cast<size_t>(width);
  std::vector<size_t> contradicted;
  for (size_t p = 0; p < axis.position.size(); ++p) {
    if (axis.confidence[p] <= 0) continue;
    int against = 0;
    bool confirmed = false;
    const auto ask = [&](size_t q) {
      if (axis.confidence[q] <= 0) return;
      const bool near = std::abs(axis.position[p] - axis.position[q]) <= reach_px;
      confirmed = confirmed || near;
      against += near ? 0 : 1;
    };
    if (p % w > 0) ask(p - 1);
    if (p % w + 1 < w) ask(p + 1);
    if (p >= w) ask(p - w);
    if (p / w + 1 < static_cast<size_t>(height)) ask(p + w);
    if (!confirmed && against >= 2) contradicted.push_back(p);
  }
  for (const size_t p : contradicted) {
    axis.position[p] = axis.sigma[p] = axis.confidence[p] = 0;
  }
}

}  // namespace lfm
