// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/options.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "resample/imputation.h"
#include "resample/light_field.h"

namespace lfm {

/// Which points of the object a patch's samples show.
enum class SampleOn {
  kMesh,     ///< points of the decimated mesh: what a renderer's rays hit
  kSurface,  ///< the dense surface above them, along the interpolated normal
};

/// How photographs are read at a sample.
enum class Sampling {
  kBilinear,  ///< at its projection
  kEwa,       ///< over the area that the sample stands for (area_sampling.h)
};

/// Whether differences of exposure and white balance between photographs are taken out.
enum class PhotoGainUse {
  kAuto,  ///< where triangles that were kept out of the fit say that they are needed
  kOff,
  kOn,
};

struct ResampleOptions {
  int view_grid = 16;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  double max_grazing_deg = 83;
  double depth_margin_px = 1.5;
  double min_data_share = 0.1;
  double hull_margin = 0.08;
  double max_hidden_share = 0.85;
  int impute_terms = 3;
  double sample_density = 2.0 / 3.0;
  int max_edge_samples = 65;
  SampleOn sample_on = SampleOn::kMesh;
  Sampling sampling = Sampling::kBilinear;
  PhotoGainUse photo_gains = PhotoGainUse::kAuto;
  int memory_mib = 4096;
  void Declare(OptionVisitor& v) {
    v.Integer({"view-grid", "Directions a side of a view map: sharper highlights against bytes.",
               "", 2, 128},
              view_grid);
    v.Enumeration({"direction-map",
                   "Layout of the hemisphere on a view map: square, the paper's disc, or square "
                   "with directions down to 20 degrees below a vertex's horizon, from where "
                   "triangles of a curved surface are seen."},
                  {"hemi-octahedral", "orthographic", "hemi-octahedral-skirt"}, direction_map);
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
    v.Number(
        {"min-data-share",
         "Use a photograph for a triangle when at least this share of it is in sight and keeps the "
         "margin (the rest is estimated from the other photographs); 1 = all.",
         "", 0.05, 1},
        min_data_share);
    v.Number(
        {"hull-margin",
         "Directions outside the hull of the photographs', or inside it near its border, show "
         "what lies this share of the hull's size inside it: there near photographs are mixed, "
         "on the border two that lie far apart; 0 = as it is.",
         "", 0, 0.9},
        hull_margin);
    v.Number({"max-hidden-share",
              "Use a photograph for a triangle of which at most this share is hidden, or outside "
              "frame and mask, too (estimated from the other photographs); 0 = only triangles "
              "wholly in sight.",
              "", 0, 0.95},
             max_hidden_share);
    v.Integer({"impute-terms",
               "Terms of the fit that estimates what a photograph does not tell of a triangle.", "",
               1, kMaxImputationTerms},
              impute_terms);
    v.Number(
        {"sample-density",
         "Samples that a patch has at least for each pixel of the photograph that sees most of "
         "its triangle; the next larger one of the sizes is taken, up to four times as many.",
         "", 0.1, 16},
        sample_density);
    v.Integer({"max-edge-samples",
               "Largest patch: samples along a triangle's edge (4, 7, 13, 25, 49, 97 or 193; the "
               "next smaller of these is taken).",
               "", 4, kMaxEdgeSamples},
              max_edge_samples);
    v.Enumeration({"sample-on",
                   "Points to sample: of the mesh (exact in each photograph's own view), or of the "
                   "dense surface above it (sharper where the mesh is coarse)."},
                  {"mesh", "surface"}, sample_on);
    v.Enumeration({"sampling",
                   "How photographs are read at a sample: between four pixels, or averaged over "
                   "the area that it stands for (against aliasing, of coarse patches)."},
                  {"bilinear", "ewa"}, sampling);
    v.Enumeration({"photo-gains",
                   "Bring photographs to one exposure and white balance, estimated where they show "
                   "the same triangles: where they need it (auto), never, or always."},
                  {"auto", "off", "on"}, photo_gains);
    v.Integer({"memory-mib",
               "Most memory to take, whatever the number of photographs and triangles: what does "
               "not fit is put aside in the output's folder, or done in smaller parts. The result "
               "is the same.",
               "MiB", 64, 1 << 24},
              memory_mib);
  }
};

struct ResampleResult {
  double mean_visible_views = 0;
  double samples_per_triangle = 0;
  int64_t dense_bytes = 0;
  int unseen_triangles = 0;          ///< no photograph shows enough of them (min_data_share)
  double saturated_share = 0;        ///< of all samples
  double near_edge_share = 0;        ///< of all samples: estimated, for they lie near a depth edge
  double hidden_share = 0;           ///< of all samples: estimated, for something hides them
  double seen_directions_share = 0;  ///< of the view grids' entries: inside the hull of photographs
  std::vector<std::string> photo_ids;  ///< photographs that were used
  /// As `photo_ids`: by which their linear RGB was divided; empty when none were needed.
  std::vector<Eigen::Vector3d> photo_gains;
  /// What says so (PhotoGains): relative errors without and with gains; 0 when not asked.
  double gain_error_without = 0, gain_error_with = 0;
};

/// Resamples the train photographs onto `mesh` and writes `lfs_file` (Chen 2002, section 5.2).
/// Visibility is decided on `surface`, the dense one.
///
/// Used are the photographs of `calib` whose split in `capture` is train. `load_image` is called
/// once for each (and once for its mask: pixels below half are no data), from several threads at
/// the same time. Photographs are held as 4 bytes a pixel until the end (288 MB for 104 of 960 x
/// 720), triangles only in batches of 256. Saturated values (a channel at 255) are lower bounds and
/// imputed, and so are samples that are hidden or too near a depth edge (imputation.h): decided for
/// each sample by a ray where something of its triangle is hidden. Pixels of float pictures that
/// are NaN are no data; infinite ones saturate. Where photographs differ in exposure or white
/// balance they are brought to one (photo_gains.h). Triangles that nobody sees are written without
/// views. The file does not depend on the number of threads.
///
/// Throws Error when no photograph can be used, a picture is missing or has another size than its
/// camera, a mask does not fit, an option is out of range, a mesh is invalid, or the file cannot be
/// written; then no file appears.
ResampleResult Resample(const Capture& capture, const CalibResult& calib,
                        const TriangleMesh& surface, const TriangleMesh& mesh,
                        const ImageLoader& load_image, const ResampleOptions& options,
                        const std::filesystem::path& lfs_file, Progress& progress);

}  // namespace lfm
