// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "scan/triangulate.h"

namespace lfm {

struct ConsensusOptions {
  double agree_mm = 0.35;      ///< nearer than this to another scan's surface: it agrees
  double contradict_mm = 2.0;  ///< farther than agree_mm, but nearer than this: it contradicts
  double clear_mm = 1.0;       ///< another scan saw at least this far behind: it saw through
  double exact_mm = 0.1;       ///< points of a larger sigma are believed if another scan agrees
  int min_patch_px = 25;       ///< smaller connected patches of a scan are dropped
};

/// One scan to be compared with the others.
struct PosedRange {
  RangeMap map;
  Pose camera_from_world;
};

/// Clears the pixels (depth and confidence become 0) that the other scans contradict, then patches
/// of fewer than `min_patch_px` connected pixels.
///
/// Each point is projected into every other scan. There the surface found at that pixel agrees
/// (distance to its tangent plane within `agree_mm`), contradicts (off by more, facing the same
/// way), or was seen through the point (it and its neighbours lie more than `clear_mm` behind). It
/// says neither where a pixel beside it agrees: one pixel is too coarse for creases and slopes. A
/// voice weighs as much as its confidence, and the point has its own; points with more against than
/// for them go, so of two scans that contradict each other the less certain yields.
///
/// Points that no other scan shows stay if they are exact (`sigma_mm` at most `exact_mm`), were
/// seen at more than 78 degrees from their normal (the edge of what the scans see together), or
/// there is no other scan. What is left is mostly what mirrors show: no two scans see the same
/// there.
///
/// All votes are taken before any pixel is cleared: the result does not depend on an order.
std::vector<PosedRange> KeepConsensus(std::vector<PosedRange> scans, const Camera& camera,
                                      const std::vector<Eigen::Vector2d>& rays,
                                      const ConsensusOptions& options);

}  // namespace lfm
