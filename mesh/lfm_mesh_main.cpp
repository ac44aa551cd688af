// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "calib/calib_files.h"
#include "core/atomic_file.h"
#include "core/capture.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/image.h"
#include "core/json_reader.h"
#include "core/output_folder.h"
#include "core/ply.h"
#include "mesh/mesh.h"
#include "mesh/mesh_files.h"
#include "mesh/mesh_pictures.h"
#include "mesh/mesh_sweep.h"
#include "mesh/surface_comparison.h"
#include "scan/scan_files.h"

namespace {

constexpr const char *kComparison = "comparison.json", *kSweepTable = "sweep.csv",
                     *kSweepChart = "sweep.svg", *kPictures = "pictures";

struct OutputOptions {
  bool pictures = false, sweep = false;
  std::string points, reference;
  double threshold_mm = 0.2;
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"points",
            "Take these points (PLY, world frame, mm; normals are estimated where there are none) "
            "in place of WORK/scan; not for a capture that brings its mesh."},
           points);
    v.Text({"reference",
            "Compare the surface with this mesh (PLY, world frame, mm): distances both ways into "
            "WORK/mesh/comparison.json; with --pictures, the error on the surface."},
           reference);
    v.Number({"threshold-mm", "Accuracy and completeness count what is nearer.", "mm", 1e-6, 1e6},
             threshold_mm);
    v.Flag({"sweep",
            "Also decimate to a range of triangle sizes; error and compression into "
            "WORK/mesh/sweep.csv and sweep.svg."},
           sweep);
    v.Flag({"pictures",
            "Also draw the surface, its confidence and the mesh's triangles from three sides, into "
            "WORK/mesh/pictures."},
           pictures);
  }
};

// Draws from three sides what `draw` makes of a view, as NAME_AZIMUTH.png.
void DrawFromAllSides(const lfm::TriangleMesh& mesh, const lfm::MeshPictureOptions& options,
                      const std::filesystem::path& folder, const std::string& name) {
  constexpr int kAzimuths_deg[] = {-60, 60, 180};
  constexpr double kElevation = 0.35, kDegree = std::numbers::pi / 180;
  constexpr int kWidth = 640, kHeight = 720;
  for (const int azimuth_deg : kAzimuths_deg) {
    const lfm::MeshView view =
        lfm::ViewMeshFrom(mesh, azimuth_deg * kDegree, kElevation, kWidth, kHeight);
    lfm::WriteImage(lfm::DrawMesh(mesh, view.camera, view.camera_from_world, options),
                    folder / (name + "_" + std::to_string(azimuth_deg) + ".png"));
  }
}

void DrawPictures(const lfm::MeshResult& result, const std::filesystem::path& folder,
                  lfm::Progress& progress) {
  lfm::MeshPictureOptions confidence, wires;
  confidence.values = result.surface.confidence;
  wires.wires = lfm::MeshWires::kDrawn;
  progress.Start("drawing", 3);
  DrawFromAllSides(result.surface, {}, folder, "surface");
  progress.Advance();
  DrawFromAllSides(result.surface, confidence, folder, "confidence");
  progress.Advance();
  DrawFromAllSides(result.mesh, wires, folder, "mesh");
  progress.Advance();
}

// Before the work, which a bad file would waste.
std::optional<lfm::TriangleMesh> ReadReference(const std::string& file) {
  if (file.empty()) return std::nullopt;
  try {
    lfm::TriangleMesh reference = lfm::ReadPlyMesh(file);
    lfm::ValidateReference(reference, file);
    return reference;
  } catch (const lfm::Error& e) {
    throw lfm::Error(
        std::string(e.what()) + " (--reference takes a mesh as PLY, in the world frame, in mm)",
        e.kind());
  }
}

// What an earlier run compared, swept and drew belongs to the mesh of then.
void RemoveFiguresOfEarlierMesh(const std::filesystem::path& folder) {
  for (const char* name : {kComparison, kSweepTable, kSweepChart, kPictures}) {
    std::error_code error;
    std::filesystem::remove_all(folder / name, error);
    if (error) {
      throw lfm::Error((folder / name).string() + ": cannot be removed (" + error.message() +
                           "); it belongs to an earlier mesh",
                       lfm::ErrorKind::kSystem);
    }
  }
}

void Compare(const lfm::MeshResult& result, const lfm::TriangleMesh& reference,
             const OutputOptions& output, const std::filesystem::path& folder,
             lfm::Progress& progress) {
  progress.Start("comparing with the reference", 1);
  const lfm::SurfaceComparison comparison =
      lfm::CompareSurfaces(result.surface, reference, output.threshold_mm);
  lfm::WriteJson(lfm::ComparisonToJson(comparison), folder / kComparison);
  char line[200];
  std::snprintf(line, sizeof line,
                "against the reference: mean %.4f mm, RMS %.4f mm, 95 %% %.4f mm, max %.3f mm; "
                "F-score %.4f at %g mm",
                comparison.both.mean, comparison.both.rms, comparison.both.p95, comparison.both.max,
                comparison.f_score, output.threshold_mm);
  progress.Note(line);
  if (!output.pictures) return;
  lfm::MeshPictureOptions error;
  const std::vector<double> distances = lfm::DistancesToMesh(result.surface.vertices, reference);
  error.values.assign(distances.begin(), distances.end());
  error.value_high = output.threshold_mm;
  DrawFromAllSides(result.surface, error, folder / kPictures, "error");
}

void Sweep(const lfm::MeshResult& result, const lfm::CalibResult& calib,
           const std::filesystem::path& folder, lfm::Progress& progress) {
  const std::vector<lfm::SweepRow> rows = lfm::SweepDecimation(result.surface, calib, progress);
  lfm::WriteFileAtomically(folder / kSweepTable, lfm::SweepToCsv(rows));
  lfm::WriteFileAtomically(folder / kSweepChart, lfm::SweepToSvg(rows));
}

lfm::MeshResult Build(const lfm::Capture& capture, const std::filesystem::path& work,
                      const lfm::CalibResult& calib, const std::string& points,
                      const lfm::MeshOptions& options, lfm::Progress& progress) {
  const lfm::ImageLoader photos = lfm::MakeImageLoader(capture);
  if (capture.BringsGeometry()) {
    if (!points.empty()) {
      throw lfm::Error("--points " + points + ": the capture brings its own mesh, " + capture.mesh +
                       "; leave out --points");
    }
    const std::filesystem::path mesh = capture.folder / capture.mesh;
    return lfm::PrepareGivenMesh(lfm::ReadPlyMesh(mesh), calib, options, progress, photos,
                                 mesh.string());
  }
  const std::string file = points.empty() ? (work / "scan" / "points.ply").string() : points;
  if (points.empty() && std::filesystem::exists(work / "scan" / "rig.json")) {
    const lfm::ScanResult scan = lfm::LoadScan(work / "scan");
    return lfm::BuildMesh(scan.points, lfm::SightsOf(scan), calib, options, progress, photos, file);
  }
  return lfm::BuildMesh(lfm::ReadPlyCloud(file), {}, calib, options, progress, photos, file);
}

void NoteFigures(const lfm::MeshResult& result, lfm::Progress& progress) {
  for (const std::string& reason : result.reasons) progress.Note("method: " + reason);
  if (result.carved_points > 0) {
    progress.Note("carved: " + std::to_string(result.carved_points) +
                  " points bound what was closed without data");
  }
  char line[300];
  std::snprintf(line, sizeof line,
                "surface: %zu triangles; mesh: %zu triangles of %.0f samples, %.3f mm off on "
                "average, 95 %% within %.3f mm; a photograph's pixel is %.3f mm",
                result.surface.triangles.size(), result.mesh.triangles.size(),
                result.samples_per_triangle, result.deviation_mean_mm, result.deviation_p95_mm,
                result.pixel_mm);
  progress.Note(line);
  const int crossings = result.surface_self_intersections + result.mesh_self_intersections;
  if (crossings > 0) {
    progress.Note("warning: " + std::to_string(crossings) + " pairs of triangles still cross");
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string capture_folder, work_folder;
  lfm::MeshOptions options;
  OutputOptions output;
  lfm::CommandLine command(
      "lfm-mesh",
      "Reconstructs the closed surface of the scanned object and decimates it. Reads WORK/calib "
      "and WORK/scan (or --points, or the mesh that the capture brings), writes WORK/mesh.",
      "lfm-mesh demo/capture demo/work");
  command.Positional("CAPTURE", "The capture folder.", capture_folder);
  command.Positional("WORK", "The workspace folder.", work_folder);
  command.Options(lfm::AnyOptions(options), "Mesh");
  command.Options(lfm::AnyOptions(output), "Output");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const std::filesystem::path work = work_folder;
    lfm::RequireWritableFolder(work / "mesh");
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    const lfm::CalibResult calib = lfm::CalibOfCapture(capture, work / "calib");
    const std::optional<lfm::TriangleMesh> reference = ReadReference(output.reference);
    const lfm::MeshResult result = Build(capture, work, calib, output.points, options, progress);
    RemoveFiguresOfEarlierMesh(work / "mesh");
    lfm::SaveMesh(result, work / "mesh");
    if (output.pictures) DrawPictures(result, work / "mesh" / kPictures, progress);
    if (reference) Compare(result, *reference, output, work / "mesh", progress);
    if (output.sweep) Sweep(result, calib, work / "mesh", progress);
    NoteFigures(result, progress);
  });
}
