// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "scan/triangulate.h"

namespace lfm {

/// Limits are shares of a point's distance from the scanner, so that they fit small and large
/// objects alike; the usual ones are 0.35, 2, 1 and 0.1 mm at 0.46 m.
struct ConsensusOptions {
  double agree = 0.76e-3;      ///< nearer than this to another scan's surface: it agrees
  double contradict = 4.3e-3;  ///< farther than `agree`, but nearer than this: it contradicts
  double clear = 2.2e-3;       ///< another scan saw at least this far behind: it saw through
  double exact = 0.22e-3;      ///< points of a larger sigma are believed if another scan agrees
  int min_patch_px = 25;       ///< smaller connected patches of a scan are dropped
};

/// The usual limits, all scaled so that points agree within `agree`.
ConsensusOptions ConsensusWithin(double agree);

/// One scan to be compared with the others.
struct PosedRange {
  RangeMap map;
  Pose camera_from_world;
};

/// Clears the pixels (depth and confidence become 0) that the other scans contradict, then patches
/// of fewer than `min_patch_px` connected pixels.
///
/// Each point is projected into every other scan. There the surface found at that pixel agrees
/// (distance to its tangent plane within `agree`), contradicts (off by more, facing the same
/// way), or was seen through the point (it and its neighbours lie more than `clear` behind). It
/// says neither where a pixel beside it agrees (one pixel is too coarse for creases and slopes), or
/// within three sigma of the two. A voice weighs as much as its confidence, and the point has its
/// own; points with more against than for them go, so of two scans that contradict each other the
/// less certain yields.
///
/// Points that no other scan shows stay if they are exact (`sigma_mm` within `exact`), were
/// seen at more than 78 degrees from their normal (the edge of what the scans see together), or
/// there is no other scan. What is left is mostly what mirrors show: no two scans see the same
/// there.
///
/// All votes are taken before any pixel is cleared: the result does not depend on an order.
std::vector<PosedRange> KeepConsensus(std::vector<PosedRange> scans, const Camera& camera,
                                      const std::vector<Eigen::Vector2d>& rays,
                                      const ConsensusOptions& options);

}  // namespace lfm
