// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "encode/light_field_source.h"
#include "pipeline/heldout.h"
#include "resample/resample.h"

namespace lfm {

/// Whose cameras and surface: those of calibration, scans and mesh, or the studio's truth.
enum class GeometryOf { kEstimate, kTruth };

/// An object of the studio with what the paper's tables need of it.
struct PaperObject {
  std::string name;
  std::filesystem::path folder;  ///< where results of intermediate steps go
  Capture capture;
  CalibResult calib;
  TriangleMesh surface;  ///< the dense one
};

/// The object whose capture is `folder/capture`. Stages up to the mesh run in `folder/work` where
/// they have not (kEstimate), or the truth of the capture is opened (kTruth).
PaperObject OpenPaperObject(const std::filesystem::path& folder, GeometryOf geometry,
                            Progress& progress);

/// A resampled light field on a mesh of triangles of about so many samples.
struct PaperLightField {
  LightField light_field;
  ResampleResult figures;
  std::vector<Eigen::Vector3d> eyes;  ///< of its photographs
  int64_t raw_bytes = 0;  ///< normalised triangles: 3 bytes x samples x photographs that see it
};

/// Decimates the surface, twice where the first mesh is off (what resampling takes of a triangle is
/// known only afterwards), and resamples the train photographs. samples_per_triangle = 0: the mesh
/// that lfm-mesh makes by default.
PaperLightField ResamplePaperObject(const PaperObject& object, double samples_per_triangle,
                                    const ResampleOptions& options, Progress& progress);

/// Held-out scores of a model, over the silhouette of the dense surface.
HeldoutScores ScorePaperModel(const PaperObject& object, const LightFieldModel& model,
                              Progress& progress);

/// A test photograph and what models show from its camera, cut to the object.
Image PhotographBeside(const PaperObject& object, int photograph,
                       const std::vector<const LightFieldModel*>& models);

}  // namespace lfm
