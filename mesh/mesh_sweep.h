// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// One mesh of a sweep over the size of triangles.
struct SweepRow {
  int64_t triangles = 0;
  double samples_per_triangle = 0;  ///< that resampling is expected to take, mean
  double error_mean_mm = 0, error_p95_mm = 0, error_max_mm = 0;  ///< sampled, both directions
  double error_p95_px = 0;                                       ///< in pixels of the photographs
  /// What is resampled to what three terms hold, both in values a channel (Chen 2002, Figure 8,
  /// before vector quantisation): 3 M N / (3 M + K (3 M + 3 N / 2)) for M samples a triangle,
  /// N = 32^2 view directions, K = 3 terms: a mean texture, and for each term a monochrome surface
  /// map for each corner of a triangle and a view map of three channels a vertex, of which there
  /// are half as many as triangles.
  double compression = 0;
};

/// The ratio above; 0 without samples.
double SweepCompression(double samples_per_triangle);

/// Decimates `surface` to 20, 40, ... 1280 pixels a triangle (those counts that it has more than 16
/// of and fewer than all), largest triangles last. Throws Error when nothing remains to try.
std::vector<SweepRow> SweepDecimation(const TriangleMesh& surface, const CalibResult& calib,
                                      Progress& progress);

/// A table with a header line, one row a line.
std::string SweepToCsv(const std::vector<SweepRow>& rows);
/// The trade as a picture: geometric error (95 %, left axis) and compression (right axis) against
/// samples a triangle, logarithmic. Needs at least one row with positive figures.
std::string SweepToSvg(const std::vector<SweepRow>& rows);

}  // namespace lfm
