// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "core/ray_scene.h"
#include "core/triangle_mesh.h"
#include "resample/photo_depth.h"

namespace lfm {

/// How far each triangle of the decimated mesh lies from the dense surface, mm: the largest
/// distance over ten points spread over it (corners, thirds of the edges, centroid), to which depth
/// comparisons must be tolerant. Parallel over triangles.
std::vector<double> TriangleDeviations(const TriangleMesh& mesh, const RayScene& surface);

/// What one photograph offers for the visibility test.
struct PhotoSight {
  Camera camera;
  Pose camera_from_world;
  DepthMap depth;                ///< of the dense surface
  std::vector<PixelUse> usable;  ///< FindUsablePixels, and the photograph's mask
};

struct VisibilityRule {
  double max_grazing_deg = 80;
  double min_data_share = 1;    ///< of a triangle's points, [0, 1]
  double max_hidden_share = 0;  ///< of a triangle's points, [0, 1]
};

struct VisibleTriangle {
  int triangle = 0;
  double area_px = 0;  ///< of the part of its projection that is not hidden
  /// 0: nothing of it is hidden. Else something is: by what a ray from the eye through a point must
  /// meet the surface away from that point, along the camera's Z, for the point to be hidden.
  double hidden_beyond_mm = 0;
};

/// The triangles of `mesh` for which a photograph is used (Chen 2002, section 5.2, which asks for
/// all of a triangle; here a share may lie near depth edges), ascending.
///
/// A triangle counts when the angle between its normal and the direction to the camera is at most
/// `max_grazing_deg`, its corners lie in front of the camera, at most `max_hidden_share` of it is
/// hidden - occluded, or outside the frame or the mask - and at least `min_data_share` of it is
/// data. This is tested at points no farther apart than about one pixel, corners and edges
/// included. A point is data when all four pixels around its projection are kData and the depth
/// that they show differs from the point's by no more than the tolerance: one pixel's size, the
/// depth step of the triangle's slope over one pixel, and twice the triangle's deviation seen along
/// the ray. A point near a depth edge is not data, but unoccluded when the nearest pixel shows
/// nothing in front of it beyond the tolerance. Degenerate triangles are never visible. Runs in the
/// calling thread.
///
/// Which samples of a patch are hidden in a photograph that something of it is hidden in is for
/// the caller to find, by rays (triangle_resampling).
std::vector<VisibleTriangle> FindVisibleTriangles(const TriangleMesh& mesh,
                                                  const std::vector<double>& deviations_mm,
                                                  const PhotoSight& sight,
                                                  const VisibilityRule& rule);

}  // namespace lfm
