// SPDX-License-Identifier: BSD-3-Clause
#include "scan/known_rig.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMinPoints = 50;
constexpr double kMinShare = 0.1;
constexpr double kMaxMedianPx = 0.5;

std::string Size(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

std::optional<KnownRig> RigOfManifest(const Capture& capture, const Camera& camera) {
  if (!capture.scanner || !capture.scanner->projector || !capture.scanner->projector_from_camera) {
    return std::nullopt;
  }
  return KnownRig{camera, *capture.scanner->projector, *capture.scanner->projector_from_camera,
                  (capture.folder / "capture.json").string()};
}

RigCalibration RigFromKnown(const KnownRig& known, const Capture& capture) {
  const Scanner& scanner = *capture.scanner;
  const CaptureCamera& camera = capture.cameras.at(scanner.camera);
  if (known.camera.width != camera.width || known.camera.height != camera.height) {
    throw Error(known.source + ": the known rig's camera has " +
                Size(known.camera.width, known.camera.height) + " pixels, the capture's \"" +
                scanner.camera + "\" " + Size(camera.width, camera.height) +
                "; give the rig that took these scans");
  }
  if (known.projector.width != scanner.projector_width ||
      known.projector.height != scanner.projector_height) {
    throw Error(known.source + ": the known rig's projector has " +
                Size(known.projector.width, known.projector.height) + " pixels, the capture's " +
                Size(scanner.projector_width, scanner.projector_height) +
                "; give the rig that took these scans");
  }
  RigCalibration rig;
  rig.camera = known.camera;
  rig.projector = known.projector;
  rig.projector_from_camera = known.projector_from_camera;
  rig.source = RigSource::kGiven;
  return rig;
}

void RequireAgreement(const RigAgreement& agreement, const KnownRig& known) {
  if (agreement.points < kMinPoints) return;
  char problem[160];
  if (agreement.share < kMinShare) {
    std::snprintf(problem, sizeof problem,
                  "only %.1f %% of the platform's points lie within two projector pixels of where "
                  "it puts them",
                  100 * agreement.share);
  } else if (agreement.median_px > kMaxMedianPx) {
    std::snprintf(
        problem, sizeof problem,
        "the platform's points lie %.2f projector pixels (median) from where it puts them",
        agreement.median_px);
  } else {
    return;
  }
  throw Error(known.source + ": the known rig contradicts the scans: " + problem +
              "; it is another rig or has moved: leave it out, and scan tilted placements of the "
              "empty platform instead");
}

}  // namespace lfm
