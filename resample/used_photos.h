// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/progress.h"
#include "core/ray_scene.h"
#include "resample/patch_sampling.h"
#include "resample/resample.h"
#include "resample/visibility.h"

namespace lfm {

/// A photograph that feeds the light field.
struct UsedPhoto {
  std::string id, file, mask;  ///< files relative to the capture; the mask may be empty
  std::string camera_name;
  Camera camera;
  Pose camera_from_world;
};

/// The photographs of `calib` that `capture` marks as train, in the order of `calib`. Throws Error
/// when there is none or more than 65535, one is not in the capture, has no valid intrinsics, or a
/// pose that is not finite.
std::vector<UsedPhoto> FindUsedPhotos(const Capture& capture, const CalibResult& calib);

/// A photograph read and looked at.
struct SeenPhoto {
  PhotoPixels pixels;
  std::vector<VisibleTriangle> triangles;
};

/// Reads every photograph (and mask) once and finds what it shows, in parallel. Throws Error as
/// Resample does.
std::vector<SeenPhoto> LookAtPhotos(const std::vector<UsedPhoto>& photos,
                                    const TriangleMesh& surface, const RayScene& surface_scene,
                                    const TriangleMesh& mesh,
                                    const std::vector<double>& deviations_mm,
                                    const ImageLoader& load_image, const ResampleOptions& options,
                                    Progress& progress);

}  // namespace lfm
