// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <string>

#include "calib/calib_files.h"
#include "core/capture.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/ply.h"
#include "mesh/mesh.h"
#include "mesh/mesh_files.h"

namespace {

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
  lfm::CommandLine command(
      "lfm-mesh",
      "Reconstructs the closed surface of the scanned object and decimates it. Reads WORK/calib "
      "and "
      "WORK/scan/points.ply (or the mesh that the capture brings), writes WORK/mesh.",
      "lfm-mesh demo/capture demo/work");
  command.Positional("CAPTURE", "The capture folder.", capture_folder);
  command.Positional("WORK", "The workspace folder.", work_folder);
  command.Options(lfm::AnyOptions(options), "Mesh");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    const std::filesystem::path work = work_folder;
    const lfm::MeshResult result =
        capture.BringsGeometry()
            ? lfm::PrepareGivenMesh(lfm::ReadPlyMesh(capture.folder / capture.mesh),
                                    lfm::CalibFromCapture(capture), options, progress)
            : lfm::BuildMesh(lfm::ReadPlyCloud(work / "scan" / "points.ply"),
                             lfm::LoadCalib(work / "calib"), options, progress);
    lfm::SaveMesh(result, work / "mesh");
    progress.Note(Figures(result));
  });
}
