// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/ray_scene.h"
#include "mesh/decimation_target.h"
#include "mesh/patch_samples.h"
#include "mesh/pixel_footprint.h"

namespace lfm {
namespace {

constexpr double kPixelsATriangle[] = {20, 40, 80, 160, 320, 640, 1280};
constexpr double kFewestTriangles = 16;
constexpr double kTerms = 3, kViews = 32 * 32;

std::string Print(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string Print(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

// A logarithmic axis over whole decades and their thirds.
struct Axis {
  double low = 0, high = 1;       // log10
  double from_px = 0, to_px = 1;  // where they stand
  double At(double value) const {
    return from_px + (std::log10(value) - low) / (high - low) * (to_px - from_px);
  }
};

Axis MakeAxis(const std::vector<SweepRow>& rows, const std::function<double(const SweepRow&)>& of,
              double from_px, double to_px) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const SweepRow& row : rows) {
    low = std::min(low, std::log10(of(row)));
    high = std::max(high, std::log10(of(row)));
  }
  const double margin = std::max(0.05 * (high - low), 0.05);
  return {low - margin, high + margin, from_px, to_px};
}

std::vector<double> Ticks(const Axis& axis) {
  std::vector<double> ticks;
  for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double value = step * std::pow(10.0, decade);
      if (std::log10(value) >= axis.low && std::log10(value) <= axis.high) ticks.push_back(value);
    }
  }
  return ticks;
}

constexpr double kLeft = 70, kRight = 570, kTop = 40, kBottom = 340;

std::string Curve(const std::vector<SweepRow>& rows, const Axis& x, const Axis& y,
                  const std::function<double(const SweepRow&)>& of, const char* color) {
  std::string line = "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"";
  line += std::string(color) + "\" points=\"";
  std::string dots;
  for (const SweepRow& row : rows) {
    const double px = x.At(row.samples_per_triangle), py = y.At(of(row));
    line += Print("%.1f,%.1f ", px, py);
    dots += Print("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" fill=\"%s\"/>\n", px, py, color);
  }
  return line + "\"/>\n" + dots;
}

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
    csv += Print("%lld,%.2f,%.5f,%.5f,%.5f,%.4f,%.2f\n", static_cast<long long>(row.triangles),
                 row.samples_per_triangle, row.error_mean_mm, row.error_p95_mm, row.error_max_mm,
                 row.error_p95_px, row.compression);
  }
  return csv;
}

std::string SweepToSvg(const std::vector<SweepRow>& all) {
  std::vector<SweepRow> rows;
  for (const SweepRow& row : all) {
    if (row.samples_per_triangle > 0 && row.error_p95_mm > 0 && row.compression > 0) {
      rows.push_back(row);
    }
  }
  if (rows.empty()) throw Error("mesh sweep: there is nothing to draw");
  const auto error = [](const SweepRow& row) { return row.error_p95_mm; };
  const auto compression = [](const SweepRow& row) { return row.compression; };
  const Axis x = MakeAxis(
      rows, [](const SweepRow& row) { return row.samples_per_triangle; }, kLeft, kRight);
  const Axis left = MakeAxis(rows, error, kBottom, kTop);
  const Axis right = MakeAxis(rows, compression, kBottom, kTop);
  constexpr const char *kErrorColor = "#b5462f", *kCompressionColor = "#2f6db5";
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"400\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"640\" height=\"400\" "
      "fill=\"white\"/>\n";
  svg += Print(
      "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" fill=\"none\" "
      "stroke=\"#888\"/>\n",
      kLeft, kTop, kRight - kLeft, kBottom - kTop);
  for (const double value : Ticks(x)) {
    svg += Print(
        "<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%g\" y2=\"%g\" stroke=\"#ddd\"/>\n<text "
        "x=\"%.1f\" y=\"%g\" text-anchor=\"middle\">%g</text>\n",
        x.At(value), x.At(value), kTop, kBottom, x.At(value), kBottom + 18, value);
  }
  for (const double value : Ticks(left)) {
    svg += Print("<text x=\"%g\" y=\"%.1f\" text-anchor=\"end\" fill=\"%s\">%g</text>\n", kLeft - 6,
                 left.At(value) + 4, kErrorColor, value);
  }
  for (const double value : Ticks(right)) {
    svg += Print("<text x=\"%g\" y=\"%.1f\" fill=\"%s\">%g</text>\n", kRight + 6,
                 right.At(value) + 4, kCompressionColor, value);
  }
  svg += Curve(rows, x, left, error, kErrorColor);
  svg += Curve(rows, x, right, compression, kCompressionColor);
  svg += Print(
      "<text x=\"%g\" y=\"24\" fill=\"%s\">error, 95 %%, mm</text>\n<text x=\"%g\" "
      "y=\"24\" text-anchor=\"end\" fill=\"%s\">compression, three terms</text>\n<text "
      "x=\"320\" y=\"382\" text-anchor=\"middle\">samples a triangle</text>\n</svg>\n",
      kLeft, kErrorColor, kRight, kCompressionColor);
  return svg;
}

}  // namespace lfm
