// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/thinning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int64_t kLookedAt = 100000;
constexpr int kBitsPerAxis = 21;

struct Sum {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< of offsets from the cube's corner
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float weight = 0, count = 0;
};
struct Cube {
  Eigen::Vector3i cell = Eigen::Vector3i::Zero();
  Eigen::Vector3f facing = Eigen::Vector3f::Zero();
  std::array<Sum, 2> sides;
};

uint64_t Key(const Eigen::Vector3i& cell) {
  constexpr int kMiddle = 1 << (kBitsPerAxis - 1), kLargest = (1 << kBitsPerAxis) - 1;
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    key =
        key << kBitsPerAxis | static_cast<uint64_t>(std::clamp(cell[axis] + kMiddle, 0, kLargest));
  }
  return key;
}

Eigen::Vector3i CellOf(const Eigen::Vector3d& offset, double size_mm) {
  const Eigen::Array3d cell = (offset / size_mm).array().floor().max(-1e6).min(1e6);
  return cell.cast<int>().matrix();
}

void Check(const PointCloud& cloud, const std::string& where) {
  const size_t n = cloud.points.size();
  if ((!cloud.normals.empty() && cloud.normals.size() != n) ||
      (!cloud.confidence.empty() && cloud.confidence.size() != n)) {
    throw Error(where + ": every point needs a normal and a confidence, if any has one");
  }
  for (size_t i = 0; i < n; ++i) {
    if (!cloud.points[i].allFinite() || (!cloud.normals.empty() && !cloud.normals[i].allFinite())) {
      throw Error(where + ": point " + std::to_string(i) + " is not finite; check the scans");
    }
  }
}

// The middle and a cube size that leaves about `most` cubes. A patch of area A meets about
// 1.5 A / h^2 cubes of side h.
struct Plan {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double size_mm = 0;
};

Plan MakePlan(const PointCloud& cloud, int64_t most) {
  const auto n = static_cast<int64_t>(cloud.points.size());
  const int64_t stride = std::max<int64_t>(1, n / kLookedAt);
  std::vector<Eigen::Vector3d> some;
  for (int64_t i = 0; i < n; i += stride) some.push_back(cloud.points[i]);
  Plan plan;
  double extent = 0;
  std::vector<double> values(some.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < some.size(); ++i) values[i] = some[i][axis];
    std::sort(values.begin(), values.end());
    plan.middle[axis] = values[values.size() / 2];
    extent = std::max(extent,
                      values[values.size() - 1 - values.size() / 50] - values[values.size() / 50]);
  }
  if (!(extent > 0)) extent = 1;
  const double probe_mm = extent / 48;
  std::unordered_set<uint64_t> occupied;
  for (const Eigen::Vector3d& p : some) occupied.insert(Key(CellOf(p - plan.middle, probe_mm)));
  plan.size_mm = probe_mm * std::sqrt(static_cast<double>(occupied.size()) / most);
  return plan;
}

}  // namespace

PointCloud ThinPoints(const PointCloud& cloud, int64_t most, const std::string& where) {
  if (static_cast<int64_t>(cloud.points.size()) <= most) return cloud;
  Check(cloud, where);
  const Plan plan = MakePlan(cloud, most);
  const bool has_normals = !cloud.normals.empty();
  std::unordered_map<uint64_t, int> index;
  std::vector<Cube> cubes;
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d offset = cloud.points[i] - plan.middle;
    const Eigen::Vector3i cell = CellOf(offset, plan.size_mm);
    const auto [place, is_new] = index.try_emplace(Key(cell), static_cast<int>(cubes.size()));
    const Eigen::Vector3f normal =
        has_normals ? cloud.normals[i].cast<float>().eval() : Eigen::Vector3f::Zero().eval();
    if (is_new) cubes.push_back({cell, normal, {}});
    Cube& cube = cubes[place->second];
    Sum& side = cube.sides[has_normals && normal.dot(cube.facing) < 0];
    const float given = cloud.confidence.empty() ? 1.0F : cloud.confidence[i];
    const float weight = given > 1e-3F ? std::min(given, 1.0F) : 1e-3F;
    const Eigen::Vector3d in_cube = offset - plan.size_mm * cube.cell.cast<double>();
    side.point += weight * in_cube.cast<float>();
    side.normal += weight * normal;
    side.weight += weight;
    side.count += 1;
  }
  PointCloud thin;
  for (const Cube& cube : cubes) {
    for (const Sum& side : cube.sides) {
      if (side.count == 0) continue;
      const Eigen::Vector3d corner = plan.middle + plan.size_mm * cube.cell.cast<double>();
      thin.points.push_back(corner + (side.point / side.weight).cast<double>());
      thin.confidence.push_back(side.weight / side.count);
      if (!has_normals) continue;
      const double length = side.normal.norm();
      thin.normals.push_back(length > 0 ? (side.normal.cast<double>() / length).eval()
                                        : Eigen::Vector3d::Zero().eval());
    }
  }
  return thin;
}

}  // namespace lfm
