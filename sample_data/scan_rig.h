// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "sample_data/random.h"

namespace lfm {

/// The structured-light rig: a camera and a projector fixed to each other.
struct ScanRig {
  Camera camera, projector;
  Pose projector_from_camera;
};

/// The rig stands about 430 mm from its target; camera and projector are 22 degrees apart, seen
/// from there. The camera has 0.36 mm a pixel there (at 640 columns); the projector's picture is
/// about 250 mm wide.
ScanRig MakeScanRig(int camera_width, int camera_height, int projector_width, int projector_height);

/// Poses (camera_from_world) of `count` scans: the platform makes one full turn in equal steps (18
/// scans: 20 degrees), and the rig stands high for every even scan and low for every odd one, so
/// that each height sees the object from all round.
std::vector<Pose> MakeScanPoses(int count, double low_deg, double high_deg);

/// How a platform stands wobble_mm N(0, 1) off along each axis, and tilted about x and y so that
/// its rim, 100 mm out, is as far off again: where it stands from where it should.
Pose Wobble(double wobble_mm, RandomStream& random);

/// The same scans on a bad turntable. The platform turns, from its place in the first scan on,
/// about an axis through its origin that leans by `axis_tilt_deg` from its normal (in a random
/// direction); and in every scan it stands off by a Wobble. Poses are those of the platform as it
/// stood. Without trouble the poses as they are.
std::vector<Pose> TroubleScanPoses(const std::vector<Pose>& poses, double axis_tilt_deg,
                                   double wobble_mm, uint64_t seed);

/// One placement of the empty platform before the fixed rig.
struct PlatformPlacement {
  Pose camera_from_world;
  Pose world_from_table;  ///< the table's frame (z = 0 its surface) in the platform's
  double tilt_deg = 0;
};

/// `count` placements tilted by 15 to 40 degrees, each in another direction, and raised so that
/// the plate clears the table.
std::vector<PlatformPlacement> MakePlacements(int count);

}  // namespace lfm
