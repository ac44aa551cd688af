// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/point_selection.h"

namespace lfm {

PointCloud SelectPoints(const PointCloud& cloud, const std::vector<char>& keep) {
  PointCloud kept;
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    if (!keep[i]) continue;
    kept.points.push_back(cloud.points[i]);
    kept.normals.push_back(cloud.normals[i]);
    kept.confidence.push_back(cloud.confidence[i]);
  }
  return kept;
}

}  // namespace lfm
