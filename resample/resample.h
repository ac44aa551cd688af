// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/options.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "resample/light_field.h"

namespace lfm {

struct ResampleOptions {
  int view_grid = 32;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  double max_grazing_deg = 80;
  double depth_margin_px = 1.5;
  int max_edge_samples = 65;
  void Declare(OptionVisitor& v) {
    v.Integer({"view-grid", "Directions a side of a view map: sharper highlights against bytes.",
               "", 2, 128},
              view_grid);
    v.Enumeration({"direction-map", "Layout of the hemisphere on a view map."},
                  {"hemi-octahedral", "orthographic"}, direction_map);
    v.Number({"max-grazing-deg",
              "A photograph that sees a triangle at a flatter angle is not used "
              "for it.",
              "deg", 1, 89.9},
             max_grazing_deg);
    v.Number({"depth-margin-px",
              "Keep this far from depth edges, so that no colour of what lies "
              "behind bleeds in.",
              "px", 0, 20},
             depth_margin_px);
    v.Integer({"max-edge-samples", "Largest patch: samples along a triangle's edge.", "", 3, 257},
              max_edge_samples);
  }
};

struct ResampleResult {
  double mean_visible_views = 0;
  double samples_per_triangle = 0;
  int64_t dense_bytes = 0;
  int unseen_triangles = 0;          ///< seen completely by no photograph
  double saturated_share = 0;        ///< of all samples
  double seen_directions_share = 0;  ///< of the view grids' entries: inside the hull of photographs
};

/// Resamples the train photographs onto `mesh` and writes `lfs_file`. Visibility is decided on
/// `surface`, the dense one.
ResampleResult Resample(const Capture& capture, const CalibResult& calib,
                        const TriangleMesh& surface, const TriangleMesh& mesh,
                        const ImageLoader& load_image, const ResampleOptions& options,
                        const std::filesystem::path& lfs_file, Progress& progress);

}  // namespace lfm
