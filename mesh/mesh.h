// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/options.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "mesh/free_space.h"
#include "mesh/method_choice.h"

namespace lfm {

struct MeshOptions {
  double platform_margin_mm = 0.6;
  int poisson_depth = 8;
  double tolerance_px = 0.5;
  double samples_per_triangle = 0;
  int triangle_count = 0;
  double max_error_mm = 0;
  double texture_weight = 0;
  SurfaceMethod method = SurfaceMethod::kAuto;
  void Declare(OptionVisitor& v) {
    v.Number({"platform-margin-mm", "Points lower than this above the platform belong to it.", "mm",
              0, 100},
             platform_margin_mm);
    v.Enumeration({"method",
                   "How points become a surface: screened Poisson, alpha wrapping, or what suits "
                   "the data (mesh.json says why)."},
                  {"auto", "poisson", "wrap"}, method);
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
              "Target instead: samples that resampling takes of a triangle, in the mean (the "
              "paper: 314); 0 = off.",
              "", 0, 1e6},
             samples_per_triangle);
    v.Integer({"triangle-count", "Target instead: this many triangles; 0 = off.", "", 0, 10000000},
              triangle_count);
    v.Number({"max-error-mm",
              "Target instead: the coarsest mesh no point of which lies farther from the dense "
              "surface, and the other way, proven; 0 = off.",
              "mm", 0, 1e6},
             max_error_mm);
    v.Number({"texture-weight",
              "Keep triangles smaller where photographs show more detail: the cost of taking one "
              "away grows by this share for each median of detail; 0 = shape alone.",
              "", 0, 1000},
             texture_weight);
    CheckTargets();
  }
  /// Throws Error, naming them, when more than one of the targets that stand in for the default is
  /// set. No range of a single option can say so: every visit of the options does.
  void CheckTargets() const;
};

struct MeshResult {
  TriangleMesh surface;  ///< dense, closed 2-manifold; confidence 0 where closed without data
  TriangleMesh mesh;     ///< decimated, closed 2-manifold: carries the light field
  double pixel_mm = 0;  ///< size of a photograph pixel at the object: median over train photographs
  /// Between the two, both directions.
  double deviation_mean_mm = 0, deviation_p95_mm = 0, deviation_max_mm = 0;
  double samples_per_triangle = 0;   ///< that resampling is expected to take, mean
  std::string method = "given";      ///< that made the surface: "poisson", "wrap" or "given"
  std::vector<std::string> reasons;  ///< why, one line each
  int64_t carved_points = 0;         ///< of the border of what scans saw through
  int surface_self_intersections = 0, mesh_self_intersections = 0;  ///< pairs of triangles left
};

/// Reconstructs a closed surface from points and decimates it. Normals are estimated when there are
/// none. `sights` say which points were measured from where (SightsOf; may be empty): what scans
/// saw through is not closed over. `load_image` opens photographs when texture has a weight.
/// `calib` supplies the pixel footprint and how far from the platform points may lie; its test
/// photographs have no say in either. Clouds of more than four million points are thinned first
/// (ThinPoints). Throws Error for an empty cloud, too few points (naming `where`: the points'
/// file), no train photograph, or a reconstruction that cannot be made closed and manifold.
MeshResult BuildMesh(const PointCloud& points, const std::vector<ScanSight>& sights,
                     const CalibResult& calib, const MeshOptions& options, Progress& progress,
                     const ImageLoader& load_image = {}, const std::string& where = "point cloud");

/// The same result from a mesh that a capture brings along: it becomes the dense surface; it also
/// carries the light field as it is when its triangles already hold at least as many photograph
/// pixels as the target asks (or 40 by default), and is decimated otherwise; closed parts that
/// cross each other then become one outer surface first (UniteParts), without colours. An open mesh
/// is allowed here; a non-manifold one throws Error, as one does that no photograph sees (naming
/// `where`: the mesh's file).
MeshResult PrepareGivenMesh(const TriangleMesh& given, const CalibResult& calib,
                            const MeshOptions& options, Progress& progress,
                            const ImageLoader& load_image = {},
                            const std::string& where = "the capture's mesh");

}  // namespace lfm
