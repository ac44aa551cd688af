// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/triangle_mesh.h"

namespace lfm {

enum class MeshWires { kHidden, kDrawn };

struct MeshPictureOptions {
  MeshWires wires = MeshWires::kHidden;
  /// A value for each vertex, shown from dark blue (`value_low`) over green to yellow
  /// (`value_high`), or empty for plain gray. Values that are not finite are shown in red.
  std::vector<float> values;
  double value_low = 0, value_high = 1;
};

/// A shaded picture of a mesh, 8-bit sRGB, lit from the camera; white background. Smooth where the
/// mesh has vertex normals, else faceted. Each pixel is the mean of four rays. Throws Error for an
/// invalid mesh or camera, or values of the wrong number or range.
Image DrawMesh(const TriangleMesh& mesh, const Camera& camera, const Pose& camera_from_world,
               const MeshPictureOptions& options = {});

/// A camera that shows all of a mesh.
struct MeshView {
  Camera camera;
  Pose camera_from_world;
};
/// Looks at the middle of the mesh's box from a direction: azimuth counter-clockwise from +x,
/// elevation above the horizon, z upwards in the picture.
MeshView ViewMeshFrom(const TriangleMesh& mesh, double azimuth, double elevation, int width,
                      int height);

}  // namespace lfm
