// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/mapped_file.h"
#include "core/process_memory.h"
#include "core/progress.h"
#include "core/ray_scene.h"
#include "resample/patch_sampling.h"
#include "resample/resample.h"
#include "resample/triangle_views.h"
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

/// Photographs read, and what each shows.
struct SeenPhotos {
  std::vector<PhotoPixels> photos;
  VisibleLists lists;
  MappedFile file;  ///< the photographs' pixels, where memory does not hold them
};

/// What photographs are looked at with.
struct PhotoLook {
  const TriangleMesh& surface;
  const RayScene& surface_scene;
  const TriangleMesh& mesh;
  const std::vector<double>& deviations_mm;  ///< TriangleDeviations
  const ResampleOptions& options;
  std::filesystem::path
      result;  ///< the file that is made; what memory does not hold lies beside it
};

/// Reads every photograph (and mask) once and finds what it shows, in parallel: as many at a time
/// as `memory` allows. Their pixels stay in memory when they take half of what is left at most.
/// Throws Error as Resample does.
SeenPhotos LookAtPhotos(const std::vector<UsedPhoto>& photos, const PhotoLook& look,
                        const ImageLoader& load_image, const MemoryLimit& memory,
                        Progress& progress);

}  // namespace lfm
