// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calib/calib.h"
#include "core/options.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"

namespace lfm {

struct MeshOptions {
  double platform_margin_mm = 0.6;
  int poisson_depth = 8;
  double tolerance_px = 0.5;
  double samples_per_triangle = 0;
  int triangle_count = 0;
  void Declare(OptionVisitor& v) {
    v.Number({"platform-margin-mm", "Points lower than this above the platform belong to it.", "mm",
              0, 100},
             platform_margin_mm);
    v.Integer({"poisson-depth",
               "Finest octree depth of the reconstruction (coarser where points are sparse): "
               "detail against time and "
               "memory.",
               "", 5, 12},
              poisson_depth);
    v.Number({"tolerance-px",
              "Default target: the coarsest mesh within this many photograph "
              "pixels of the dense surface (95 %).",
              "px", 0.01, 100},
             tolerance_px);
    v.Number({"samples-per-triangle",
              "Target instead: photograph pixels a triangle in its largest "
              "view (the paper: 314); 0 = off.",
              "", 0, 1e6},
             samples_per_triangle);
    v.Integer({"triangle-count", "Target instead: this many triangles; 0 = off.", "", 0, 10000000},
              triangle_count);
  }
};

struct MeshResult {
  TriangleMesh surface;  ///< dense, closed 2-manifold; confidence 0 where closed without data
  TriangleMesh mesh;     ///< decimated, closed 2-manifold: carries the light field
  double pixel_mm = 0;  ///< size of a photograph pixel at the object: median over train photographs
  double deviation_mean_mm = 0, deviation_p95_mm = 0;  ///< between the two, both directions
};

/// Reconstructs a closed surface from oriented points and decimates it. `calib` supplies the pixel
/// footprint and how far from the platform points may lie; its test photographs have no say in
/// either. Throws Error for an empty cloud, too few points, no train photograph, or a
/// reconstruction that cannot be made closed and manifold.
MeshResult BuildMesh(const PointCloud& points, const CalibResult& calib, const MeshOptions& options,
                     Progress& progress);

/// The same result from a mesh that a capture brings along: it becomes the dense surface; it also
/// carries the light field as it is when its triangles already hold at least as many photograph
/// pixels as the target asks (or 40 by default), and is decimated otherwise. An open mesh is
/// allowed here; a non-manifold one throws Error.
MeshResult PrepareGivenMesh(const TriangleMesh& given, const CalibResult& calib,
                            const MeshOptions& options, Progress& progress);

}  // namespace lfm
