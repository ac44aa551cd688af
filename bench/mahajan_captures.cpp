// SPDX-License-Identifier: BSD-3-Clause
// Mahajan 2007, Figure 7, from light transport that was captured: every few pixels or vertices of
// each scene that there is.
#include <algorithm>
#include <filesystem>

#include "bench/mahajan_report.h"
#include "core/capture.h"
#include "core/formatted_text.h"
#include "core/ply.h"
#include "core/transport_matrix.h"
#include "fields/analysis.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kMostPoints = 4096;
constexpr int kWindow = 64;

// Points of the first view and channel: of a picture every pixel of a window about `place` (a share
// of its width; pixels have to be finer than the texels' shadows), or as many pixels as kMostPoints
// allows of the whole when `place` is negative; of a mesh so many vertices.
Field ReadSome(const fs::path& folder, double place) {
  const Capture capture = LoadCapture(folder);
  const TransportMatrix matrix(folder / capture.transport->file);
  Field field;
  field.name = capture.name;
  field.kind = FieldColumns::kCubeTexels;
  std::vector<int64_t> which;
  if (capture.transport->kind == TransportKind::kImage) {
    const CaptureCamera& camera = capture.cameras.at(capture.transport->camera);
    int step = 1, left = 0, top = 0;
    if (place < 0) {
      while (int64_t{camera.width / step} * (camera.height / step) > kMostPoints) ++step;
      field.width = camera.width / step;
      field.height = camera.height / step;
    } else {
      field.width = std::min(kWindow, camera.width);
      field.height = std::min(kWindow, camera.height);
      left = std::clamp(static_cast<int>(place * camera.width) - field.width / 2, 0,
                        camera.width - field.width);
      top = (camera.height - field.height) / 2;
    }
    for (int y = 0; y < field.height; ++y) {
      for (int x = 0; x < field.width; ++x) {
        which.push_back(int64_t{top + y * step} * camera.width + left + x * step);
      }
    }
  } else {
    const TriangleMesh mesh = ReadPlyMesh(folder / capture.transport->mesh);
    const auto vertices = static_cast<int64_t>(mesh.vertices.size());
    const int64_t step = (vertices + kMostPoints - 1) / kMostPoints;
    for (int64_t vertex = 0; vertex < vertices; vertex += step) {
      which.push_back(vertex);
      field.positions.push_back(mesh.vertices[vertex].cast<float>());
    }
  }
  field.points = static_cast<int64_t>(which.size());
  field.functions = MakeFunctionRows(field.points, static_cast<int>(matrix.shape().columns()));
  for (int64_t i = 0; i < field.points; ++i) {
    const std::vector<float> row = matrix.ReadRows(which[i], 1);
    std::copy_n(row.data(), matrix.shape().columns(), field.functions.Row(i));
  }
  return field;
}

struct Subject {
  const char* name;
  double low, high;    // of the slope; high 0: nothing is asked
  double place = 0.5;  // of the patches' centre: across the picture; negative: spread evenly
};

// Where what is asked is of the paper's own scenes, not of these, it is a note.
constexpr Subject kSubjects[] = {
    {"hemisphere", 0, 0},
    {"step", 0.4, 0.6, 0.25},
    {"concave", 0.4, 0.6, 0.6},
    {"concave_bounced", 0.4, 0.6, 0.6},
    {"concave_phong100", 0.7, 0.9, 0.6},
    {"concave_phong100_bounced", 0.7, 0.9, 0.6},
    {"concave_phong500", 0.7, 0.9, 0.6},
    {"grid1d", 0.4, 0.6},
    {"grid2d", 0.85, 9},
    {"ellipsoid", 0, 0},
    {"face", 0, 0, -1},
    {"statue_transport", 0, 0, -1},
};

}  // namespace

void DrawCaptures(const fs::path& data, MahajanReport& report) {
  AnalysisOptions options;
  options.max_area = 1024;
  options.global_rows = 512;
  options.largest_block = 0;
  options.centers = 6;
  std::vector<ChartCurve> curves;
  for (const Subject& subject : kSubjects) {
    if (!fs::exists(data / subject.name / "capture.json")) continue;
    const Field field = ReadSome(data / subject.name, subject.place);
    std::vector<int64_t> centers;
    if (subject.place >= 0) {
      centers.push_back(int64_t{field.height / 2} * field.width + field.width / 2);
    }
    const AnalysisResult result = AnalyzeField(field, {}, centers, options, SilentProgress());
    report.Draw(std::string("capture_") + subject.name,
                {"Captured transport: " + result.name, "points of the patch", "terms",
                 ChartScale::kLogarithmic,
                 [&] {
                   std::vector<ChartCurve> all;
                   for (const DimensionCurve& curve : result.curves) {
                     all.push_back(
                         {"about " + std::to_string(curve.center), curve.areas, curve.dimensions});
                   }
                   return all;
                 }(),
                 ChartScale::kLogarithmic});
    const std::string what = FormattedText("captured %s, N = %lld", subject.name,
                                           static_cast<long long>(result.global_terms));
    if (subject.place >= 0 && subject.high > 0) {
      report.AddSlope(what, result.curves[0].slope, subject.low, subject.high);
    } else if (result.slope) {
      std::string text = FormattedText("%.3f", *result.slope);
      if (result.slope_half_width) {
        text += FormattedText(" +- %.3f over centres", *result.slope_half_width);
      }
      report.Note(what, text);
    }
    if (subject.place >= 0) {
      curves.push_back({subject.name, result.curves[0].areas, result.curves[0].dimensions});
    }
  }
  if (curves.size() > 8) curves.resize(8);
  report.Draw("figure7_captures", {"Captured transport, 6 x 32 x 32 texels: 99.95 % of the energy",
                                   "points of the patch", "terms", ChartScale::kLogarithmic, curves,
                                   ChartScale::kLogarithmic});
}

}  // namespace lfm
