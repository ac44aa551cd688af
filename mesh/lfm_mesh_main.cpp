// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <string>

#include "calib/calib_files.h"
#include "core/capture.h"
#include "core/command_line.h"
#include "core/image.h"
#include "core/ply.h"
#include "mesh/mesh.h"
#include "mesh/mesh_files.h"
#include "mesh/mesh_pictures.h"

namespace {

struct OutputOptions {
  bool pictures = false;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"pictures",
            "Also draw the surface, its confidence and the mesh's triangles from three sides, into "
            "WORK/mesh/pictures."},
           pictures);
  }
};

void DrawPictures(const lfm::MeshResult& result, const std::filesystem::path& folder,
                  lfm::Progress& progress) {
  constexpr int kAzimuths_deg[] = {-60, 60, 180};
  constexpr double kElevation = 0.35, kDegree = std::numbers::pi / 180;
  constexpr int kWidth = 640, kHeight = 720;
  lfm::MeshPictureOptions confidence, wires;
  confidence.values = result.surface.confidence;
  wires.wires = lfm::MeshWires::kDrawn;
  progress.Start("drawing", std::size(kAzimuths_deg));
  for (const int azimuth_deg : kAzimuths_deg) {
    const auto draw = [&](const char* name, const lfm::TriangleMesh& mesh,
                          const lfm::MeshPictureOptions& options) {
      const lfm::MeshView view =
          lfm::ViewMeshFrom(mesh, azimuth_deg * kDegree, kElevation, kWidth, kHeight);
      lfm::WriteImage(lfm::DrawMesh(mesh, view.camera, view.camera_from_world, options),
                      folder / (std::string(name) + "_" + std::to_string(azimuth_deg) + ".png"));
    };
    draw("surface", result.surface, {});
    draw("confidence", result.surface, confidence);
    draw("mesh", result.mesh, wires);
    progress.Advance();
  }
}

std::string Figures(const lfm::MeshResult& result) {
  char line[200];
  std::snprintf(line, sizeof line,
                "surface: %zu triangles; mesh: %zu triangles, %.3f mm off on average, 95 %% within "
                "%.3f mm; a photograph's pixel is %.3f mm",
                result.surface.triangles.size(), result.mesh.triangles.size(),
                result.deviation_mean_mm, result.deviation_p95_mm, result.pixel_mm);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  std::string capture_folder, work_folder;
  lfm::MeshOptions options;
  OutputOptions output;
  lfm::CommandLine command(
      "lfm-mesh",
      "Reconstructs the closed surface of the scanned object and decimates it. Reads WORK/calib "
      "and "
      "WORK/scan/points.ply (or the mesh that the capture brings), writes WORK/mesh.",
      "lfm-mesh demo/capture demo/work");
  command.Positional("CAPTURE", "The capture folder.", capture_folder);
  command.Positional("WORK", "The workspace folder.", work_folder);
  command.Options(lfm::AnyOptions(options), "Mesh");
  command.Options(lfm::AnyOptions(output), "Output");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    const std::filesystem::path work = work_folder;
    const lfm::CalibResult calib = lfm::CalibOfCapture(capture, work / "calib");
    const lfm::MeshResult result =
        capture.BringsGeometry()
            ? lfm::PrepareGivenMesh(lfm::ReadPlyMesh(capture.folder / capture.mesh), calib, options,
                                    progress)
            : lfm::BuildMesh(lfm::ReadPlyCloud(work / "scan" / "points.ply"), calib, options,
                             progress);
    lfm::SaveMesh(result, work / "mesh");
    if (output.pictures) DrawPictures(result, work / "mesh" / "pictures", progress);
    progress.Note(Figures(result));
  });
}
