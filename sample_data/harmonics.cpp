// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/harmonics.h"

namespace lfm {

std::array<float, kHarmonics> EvaluateHarmonics(const Eigen::Vector3f& direction) {
  const float x = direction.x(), y = direction.y(), z = direction.z();
  const float x2 = x * x, y2 = y * y, z2 = z * z;
  return {0.28209479f,
          0.48860251f * y,
          0.48860251f * z,
          0.48860251f * x,
          1.09254843f * x * y,
          1.09254843f * y * z,
          0.31539157f * (3 * z2 - 1),
          1.09254843f * x * z,
          0.54627422f * (x2 - y2),
          0.59004359f * y * (3 * x2 - y2),
          2.89061144f * x * y * z,
          0.45704579f * y * (5 * z2 - 1),
          0.37317633f * z * (5 * z2 - 3),
          0.45704579f * x * (5 * z2 - 1),
          1.44530572f * z * (x2 - y2),
          0.59004359f * x * (x2 - 3 * y2),
          2.50334294f * x * y * (x2 - y2),
          1.77013077f * y * z * (3 * x2 - y2),
          0.94617470f * x * y * (7 * z2 - 1),
          0.66904654f * y * z * (7 * z2 - 3),
          0.10578555f * (35 * z2 * z2 - 30 * z2 + 3),
          0.66904654f * x * z * (7 * z2 - 3),
          0.47308735f * (x2 - y2) * (7 * z2 - 1),
          1.77013077f * x * z * (x2 - 3 * y2),
          0.62583574f * (x2 * (x2 - 3 * y2) - y2 * (3 * x2 - y2))};
}

}  // namespace lfm
