// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/progress.h"
#include "core/ray_scene.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// How much detail photographs show at each vertex of a surface: the mean, over the train
/// photographs that see it, of the length of the picture's gradient there (green, sRGB levels a
/// pixel, central differences over the nearest pixel), in units of the median over all vertices
/// that are seen, and at most 8. Vertices that no photograph sees have 1; so have all where nothing
/// is to be seen but one colour.
///
/// Throws Error for a photograph of another size than its camera's, or of a camera that is not
/// there. Test photographs are not opened.
std::vector<double> MeasurePhotoDetail(const TriangleMesh& surface, const RayScene& scene,
                                       const CalibResult& calib, const ImageLoader& load_image,
                                       Progress& progress);

}  // namespace lfm
