// SPDX-License-Identifier: BSD-3-Clause
#include "scan/consensus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/parallel.h"

namespace lfm {
namespace {

/// What another scan says of a point.
struct Voice {
  double weight = 0;     ///< confidence of its pixel, negative when it speaks against the point
  bool witness = false;  ///< it, or the pixel beside it, shows the surface there
};

/// One point to be judged.
struct Judged {
  Eigen::Vector3d point, normal;  ///< in the world
  double sigma_mm;
};

bool SeenThrough(const RangeMap& map, int x, int y, double depth, double clear_mm) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const size_t q = static_cast<size_t>(y + dy) * map.width + x + dx;
      if (!(map.depth[q] > depth + clear_mm)) return false;
    }
  }
  return true;
}

bool NeighbourAgrees(const RangeMap& map, const std::vector<Eigen::Vector2d>& rays, int x, int y,
                     const Eigen::Vector3d& point, double agree_mm) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const size_t q = static_cast<size_t>(y + dy) * map.width + x + dx;
      if (map.depth[q] <= 0) continue;
      const Eigen::Vector3d there = map.depth[q] * rays[q].homogeneous();
      if (std::abs(map.normal[q].cast<double>().dot(point - there)) <= agree_mm) return true;
    }
  }
  return false;
}

Voice Ask(const PosedRange& other, const Camera& camera, const std::vector<Eigen::Vector2d>& rays,
          const Judged& judged, const ConsensusOptions& options) {
  constexpr double kSigmas = 3;
  const Eigen::Vector3d point = other.camera_from_world * judged.point;
  const std::optional<Eigen::Vector2d> pixel = Project(camera, point);
  if (!pixel) return {};
  const int x = static_cast<int>(std::lround(pixel->x()));
  const int y = static_cast<int>(std::lround(pixel->y()));
  const RangeMap& map = other.map;
  if (x < 1 || y < 1 || x + 1 >= map.width || y + 1 >= map.height) return {};
  const size_t q = static_cast<size_t>(y) * map.width + x;
  if (map.depth[q] <= 0) return {};
  const Eigen::Vector3d there = map.depth[q] * rays[q].homogeneous();
  const Eigen::Vector3d normal = map.normal[q].cast<double>();
  const double distance = normal.dot(point - there);
  const double agree_mm = options.agree * point.z();
  if (std::abs(distance) <= agree_mm) return {map.confidence[q], true};
  // The pixel beside it may show what this one is too coarse for: a crease, a slope.
  if (NeighbourAgrees(map, rays, x, y, point, agree_mm)) return {0, true};
  if (std::abs(distance) <= kSigmas * std::hypot(judged.sigma_mm, map.sigma_mm[q])) return {};
  const bool same_side = normal.dot(other.camera_from_world.rotation * judged.normal) > 0.5;
  if (same_side && std::abs(distance) <= options.contradict * point.z()) {
    return {-map.confidence[q], false};
  }
  const bool through = SeenThrough(map, x, y, point.z(), options.clear * point.z());
  return {through ? -map.confidence[q] : 0.0, false};
}

// What no other scan shows is believed where it is exact, or where this scan saw it so obliquely
// that the others need not have seen it at all.
bool InDoubt(const RangeMap& map, size_t pixel, const Eigen::Vector2d& ray,
             const ConsensusOptions& options) {
  constexpr double kObliqueCosine = 0.2;
  const double seen = -map.normal[pixel].cast<double>().dot(ray.homogeneous().normalized());
  return map.sigma_mm[pixel] > options.exact * map.depth[pixel] && seen > kObliqueCosine;
}

bool Outvoted(const std::vector<PosedRange>& scans, size_t scan, size_t pixel, const Camera& camera,
              const std::vector<Eigen::Vector2d>& rays, const ConsensusOptions& options) {
  const PosedRange& own = scans[scan];
  const Pose world_from_camera = own.camera_from_world.Inverse();
  const Judged judged = {world_from_camera * (own.map.depth[pixel] * rays[pixel].homogeneous()),
                         world_from_camera.rotation * own.map.normal[pixel].cast<double>(),
                         own.map.sigma_mm[pixel]};
  double balance = own.map.confidence[pixel];
  bool witnessed = scans.size() == 1;
  for (size_t other = 0; other < scans.size(); ++other) {
    if (other == scan) continue;
    const Voice voice = Ask(scans[other], camera, rays, judged, options);
    balance += voice.weight;
    witnessed |= voice.witness;
  }
  if (!witnessed && InDoubt(own.map, pixel, rays[pixel], options)) return true;
  return balance < 0;
}

void Clear(RangeMap& map, size_t pixel) {
  map.depth[pixel] = 0;
  map.confidence[pixel] = 0;
  map.sigma_mm[pixel] = 0;
}

/// Pixels of the 4-connected patch about `start`; marks them in `visited`.
std::vector<size_t> CollectPatch(const RangeMap& map, size_t start, double step_mm,
                                 std::vector<uint8_t>& visited) {
  std::vector<size_t> patch = {start};
  visited[start] = 1;
  const int64_t width = map.width;
  for (size_t i = 0; i < patch.size(); ++i) {
    const int64_t p = static_cast<int64_t>(patch[i]);
    const int64_t column = p % width;
    const std::array<std::pair<int64_t, bool>, 4> neighbours = {
        {{p - 1, column > 0},
         {p + 1, column + 1 < width},
         {p - width, p >= width},
         {p + width, p + width < static_cast<int64_t>(map.depth.size())}}};
    for (const auto& [q, exists] : neighbours) {
      if (!exists) continue;
      const size_t n = static_cast<size_t>(q);
      if (visited[n] || map.depth[n] <= 0) continue;
      if (std::abs(map.depth[n] - map.depth[patch[i]]) > step_mm) continue;
      visited[n] = 1;
      patch.push_back(n);
    }
  }
  return patch;
}

void DropSpecks(RangeMap& map, const ConsensusOptions& options) {
  constexpr double kStepMm = 5;
  std::vector<uint8_t> visited(map.depth.size(), 0);
  for (size_t p = 0; p < map.depth.size(); ++p) {
    if (visited[p] || map.depth[p] <= 0) continue;
    const std::vector<size_t> patch = CollectPatch(map, p, kStepMm, visited);
    if (static_cast<int>(patch.size()) >= options.min_patch_px) continue;
    for (size_t q : patch) Clear(map, q);
  }
}

}  // namespace

ConsensusOptions ConsensusWithin(double agree) {
  ConsensusOptions options;
  const double scale = agree / options.agree;
  options.agree = agree;
  options.contradict *= scale;
  options.clear *= scale;
  options.exact *= scale;
  return options;
}

std::vector<PosedRange> KeepConsensus(std::vector<PosedRange> scans, const Camera& camera,
                                      const std::vector<Eigen::Vector2d>& rays,
                                      const ConsensusOptions& options) {
  std::vector<std::vector<uint8_t>> outvoted(scans.size());
  for (size_t scan = 0; scan < scans.size(); ++scan) {
    const RangeMap& map = scans[scan].map;
    outvoted[scan].assign(map.depth.size(), 0);
    ParallelFor(
        0, map.height,
        [&](int64_t y) {
          for (int x = 0; x < map.width; ++x) {
            const size_t p = static_cast<size_t>(y) * map.width + x;
            if (map.depth[p] <= 0) continue;
            outvoted[scan][p] = Outvoted(scans, scan, p, camera, rays, options) ? 1 : 0;
          }
        },
        8);
  }
  for (size_t scan = 0; scan < scans.size(); ++scan) {
    for (size_t p = 0; p < outvoted[scan].size(); ++p) {
      if (outvoted[scan][p]) Clear(scans[scan].map, p);
    }
    DropSpecks(scans[scan].map, options);
  }
  return scans;
}

}  // namespace lfm
