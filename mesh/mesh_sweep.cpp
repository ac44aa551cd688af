// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_sweep.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/formatted_text.h"
#include "core/line_chart.h"
#include "core/ray_scene.h"
#include "mesh/decimation_target.h"
#include "mesh/patch_samples.h"
#include "mesh/pixel_footprint.h"

namespace lfm {
namespace {

constexpr double kPixelsATriangle[] = {20, 40, 80, 160, 320, 640, 1280};
constexpr double kFewestTriangles = 16;
constexpr double kTerms = 3, kViews = 32 * 32;

}  // namespace

double SweepCompression(double samples) {
  if (!(samples > 0)) return 0;
  return 3 * samples * kViews / (3 * samples + kTerms * (3 * samples + 1.5 * kViews));
}

std::vector<SweepRow> SweepDecimation(const TriangleMesh& surface, const CalibResult& calib,
                                      Progress& progress) {
  const RayScene scene(surface);
  const double pixel_mm = MedianPixelFootprint(surface, scene, calib);
  const double pixels = TotalArea(surface) / (pixel_mm * pixel_mm);
  std::vector<SweepRow> rows;
  progress.Start("sweeping the size of triangles", std::size(kPixelsATriangle));
  for (const double a_triangle : kPixelsATriangle) {
    const double count = pixels / a_triangle;
    progress.Advance();
    if (count < kFewestTriangles || count >= static_cast<double>(surface.triangles.size()))
      continue;
    const DecimatedMesh result = DecimateToCount(surface, std::llround(count));
    SweepRow row;
    row.triangles = static_cast<int64_t>(result.mesh.triangles.size());
    row.samples_per_triangle = PredictSamplesPerTriangle(result.mesh, scene, calib);
    row.error_mean_mm = result.deviation.both.mean;
    row.error_p95_mm = result.deviation.both.p95;
    row.error_max_mm = result.deviation.both.max;
    row.error_p95_px = row.error_p95_mm / pixel_mm;
    row.compression = SweepCompression(row.samples_per_triangle);
    rows.push_back(row);
  }
  if (rows.empty()) throw Error("mesh sweep: the surface has too few triangles to take any away");
  return rows;
}

std::string SweepToCsv(const std::vector<SweepRow>& rows) {
  std::string csv =
      "triangles,samples_per_triangle,error_mean_mm,error_p95_mm,error_max_mm,error_p95_px,"
      "compression\n";
  for (const SweepRow& row : rows) {
    csv +=
        FormattedText("%lld,%.2f,%.5f,%.5f,%.5f,%.4f,%.2f\n", static_cast<long long>(row.triangles),
                      row.samples_per_triangle, row.error_mean_mm, row.error_p95_mm,
                      row.error_max_mm, row.error_p95_px, row.compression);
  }
  return csv;
}

std::string SweepToSvg(const std::vector<SweepRow>& rows) {
  ChartCurve error{"error", {}, {}}, compression{"compression", {}, {}, ChartSide::kRight};
  for (const SweepRow& row : rows) {
    if (!(row.samples_per_triangle > 0 && row.error_p95_mm > 0 && row.compression > 0)) continue;
    for (ChartCurve* curve : {&error, &compression}) curve->x.push_back(row.samples_per_triangle);
    error.y.push_back(row.error_p95_mm);
    compression.y.push_back(row.compression);
  }
  if (error.x.empty()) throw Error("mesh sweep: there is nothing to draw");
  return ChartToSvg({.title = "Size of triangles",
                     .x_label = "samples a triangle",
                     .y_label = "error, 95 %, mm",
                     .x_scale = ChartScale::kLogarithmic,
                     .curves = {error, compression},
                     .y_scale = ChartScale::kLogarithmic,
                     .right_label = "compression, three terms"});
}

}  // namespace lfm
