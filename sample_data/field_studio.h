// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/capture.h"
#include "core/progress.h"
#include "sample_data/fixed_view.h"
#include "sample_data/scene_description.h"
#include "sample_data/studio_options.h"
#include "sample_data/studio_report.h"

namespace lfm {

/// The scene as `--tiny` records it: at most 64 pixels a side, 24 lights, a cube of 6 x 8 x 8, 4
/// views.
SceneDescription ShrinkField(SceneDescription scene);

/// Makes the capture folder of a scene without a platform, capture.json last:
///
/// - kReflectanceField: fields/light_NNN.EXT, one picture a light (white paint that faces the light
///   shows 0.8 of the sensor's full well), with the sensor's noise; every eighth light is held out.
///   Below reference quality bounced light is limited (directional_response.h) to a quarter of
///   white's.
/// - kTransportImage, kTransportMesh: transport.ltm (core/transport_matrix.h), float16, one channel
///   (the mean of R, G and B) or three; of a mesh also mesh.ply, the objects joined; and
///   preview.png, the scene in a dim room with a window (transport_preview.h).
///
/// ground_truth/mesh.ply is the scene; exports as sample_data/exports.h. The same options give the
/// same bytes whatever the number of threads. Throws Error for a kLightField scene.
/// Rays and noise, the latter measured on some rows that are traced twice, go into
/// ground_truth/studio.json and are returned.
StageReport MakeFieldCapture(const SceneDescription& scene, const StudioOptions& options,
                             const std::filesystem::path& folder, Progress& progress);

}  // namespace lfm
