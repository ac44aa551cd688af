// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/capture.h"
#include "scan/plate_correspondences.h"
#include "scan/scan.h"

namespace lfm {

/// The rig that a capture's manifest states: projector and projector_from_camera; the camera is
/// `camera`, which the calibration took from the manifest or found. None when either is missing.
std::optional<KnownRig> RigOfManifest(const Capture& capture, const Camera& camera);

/// A known rig as a calibration. Throws Error when its camera or projector has another size than
/// the capture's.
RigCalibration RigFromKnown(const KnownRig& known, const Capture& capture);

/// How a known rig agrees with what it shows on the platform.
struct RigAgreement {
  int points = 0;        ///< plate points that could speak
  double share = 0;      ///< of them within two projector pixels of where the rig says
  double median_px = 0;  ///< of those, after the adjustment of all poses
};

/// Throws Error, naming the rig's source, when fewer than a tenth of the points agree, or those
/// that do are off by half a projector pixel in the median: it is not this rig, or it has moved.
void RequireAgreement(const RigAgreement& agreement, const KnownRig& known);

}  // namespace lfm
