// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <string>

#include "calib/calib_files.h"
#include "core/capture.h"
#include "core/command_line.h"
#include "core/ply.h"
#include "mesh/mesh_files.h"
#include "resample/dense_light_field.h"
#include "resample/resample.h"

namespace {

struct OutputOptions {
  std::string dense;
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"dense",
            "Also write the full resampled matrix to this file (float32; gigabytes): the oracle "
            "that the factored form is tested against."},
           dense);
  }
};

void Report(const lfm::ResampleResult& result, lfm::Progress& progress) {
  char line[200];
  std::snprintf(line, sizeof(line),
                "%.1f views and %.0f samples a triangle; %d triangles unseen; %.2f %% saturated, "
                "%.1f %% near edges; "
                "%.0f %% of directions inside the photographs'",
                result.mean_visible_views, result.samples_per_triangle, result.unseen_triangles,
                100 * result.saturated_share, 100 * result.near_edge_share,
                100 * result.seen_directions_share);
  progress.Note(line);
}

}  // namespace

int main(int argc, char** argv) {
  lfm::CommandLine command("lfm-resample",
                           "Resamples the photographs onto the mesh: WORK/calib and WORK/mesh go "
                           "in, WORK/resample/light_field.lfs comes out.",
                           "lfm-resample demo/capture demo/work --max-grazing-deg 75");
  std::string capture_folder, work_folder;
  command.Positional("CAPTURE", "folder with capture.json and the photographs", capture_folder);
  command.Positional("WORK", "workspace folder", work_folder);
  lfm::ResampleOptions options;
  OutputOptions output;
  command.Options(lfm::AnyOptions(options));
  command.Options(lfm::AnyOptions(output), "Output");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const std::filesystem::path work = work_folder;
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    const bool own_calib = !std::filesystem::exists(work / "calib") && capture.BringsGeometry();
    const lfm::CalibResult calib =
        own_calib ? lfm::CalibFromCapture(capture) : lfm::LoadCalib(work / "calib");
    const bool own_mesh = !std::filesystem::exists(work / "mesh") && capture.BringsGeometry();
    const lfm::MeshResult mesh =
        own_mesh ? lfm::PrepareGivenMesh(lfm::ReadPlyMesh(capture.folder / capture.mesh), calib,
                                         lfm::MeshOptions{}, progress)
                 : lfm::LoadMesh(work / "mesh");
    const std::filesystem::path file = work / "resample" / "light_field.lfs";
    const lfm::ResampleResult result =
        lfm::Resample(capture, calib, mesh.surface, mesh.mesh, lfm::MakeImageLoader(capture),
                      options, file, progress);
    Report(result, progress);
    if (!output.dense.empty()) {
      lfm::WriteDense(lfm::LightField::Open(file), output.dense, progress);
    }
  });
}
