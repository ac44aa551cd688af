// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calib/calib.h"
#include "core/ray_scene.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// Samples that resampling will take of a triangle of `mesh`, in the mean over all triangles.
///
/// Resampling gives a triangle n (n + 1) / 2 samples, with n the first of 4, 7, 13, 25, 49 that
/// gives at least two samples for three pixels of the train photograph that shows it largest, and
/// the fewest to a triangle that none shows. Here a photograph counts when the triangle's middle
/// and three places near its corners are in the picture, within 80 degrees of the view and not
/// occluded by the dense surface, of which `surface` is a scene. No triangles give 0.
double PredictSamplesPerTriangle(const TriangleMesh& mesh, const RayScene& surface,
                                 const CalibResult& calib);

/// Samples of a triangle that covers that many pixels where it is seen largest.
int PatchSamples(double largest_px);

}  // namespace lfm
