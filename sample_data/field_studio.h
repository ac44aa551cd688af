// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "core/capture.h"
#include "core/progress.h"
#include "sample_data/path_tracer.h"
#include "sample_data/scene_description.h"
#include "sample_data/studio_options.h"

namespace lfm {

/// Directions over the upper hemisphere, evenly spread (Fibonacci lattice), unit, z > 0; the first
/// is nearest to the zenith.
std::vector<Eigen::Vector3f> LightStageDirections(int count);

/// Eyes evenly spread over the sphere round `view.target` through `view.eye`; the first is
/// `view.eye` itself.
std::vector<Eigen::Vector3d> ViewSphere(const FixedView& view, int count);

/// The scene as `--tiny` records it: at most 64 pixels a side, 24 lights, a cube of 6 x 8 x 8, 4
/// views.
SceneDescription ShrinkField(SceneDescription scene);

/// The pinhole camera of a fixed view, and where it stands. Throws Error for a size outside
/// [1, 16384], a field of view outside (0, 170) degrees, or an eye at its target.
Camera FixedCamera(const FixedView& view);
Pose FixedPose(const FixedView& view);

/// Makes the capture folder of a scene without a platform, capture.json last:
///
/// - kReflectanceField: fields/light_NNN.EXT, one picture a light (white paint that faces the light
///   shows 0.8 of the sensor's full well), with the sensor's noise; every eighth light is held out.
/// - kTransportImage, kTransportMesh: transport.ltm (core/transport_matrix.h), float16, one channel
///   (the mean of R, G and B) or three; of a mesh also mesh.ply, the objects joined, of an image
///   preview.png, the scene in a dim room with a window.
///
/// ground_truth/mesh.ply is the scene; exports as sample_data/exports.h. The same options give the
/// same bytes whatever the number of threads. Throws Error for a kLightField scene.
/// Returns the rays that were traced.
RayCounts MakeFieldCapture(const SceneDescription& scene, const StudioOptions& options,
                           const std::filesystem::path& folder, Progress& progress);

}  // namespace lfm
