// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "calib/calib_files.h"
#include "core/capture.h"
#include "core/command_line.h"
#include "core/image.h"
#include "core/output_folder.h"
#include "core/ply.h"
#include "mesh/mesh_files.h"
#include "mesh/mesh_pictures.h"
#include "resample/dense_light_field.h"
#include "resample/photo_gains.h"
#include "resample/resample.h"
#include "resample/resample_pictures.h"

namespace {

struct OutputOptions {
  std::string dense;
  bool pictures = false;
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"dense",
            "Also write the full resampled matrix to this file (float32; gigabytes): the oracle "
            "that the factored form is tested against."},
           dense);
    v.Flag({"pictures",
            "Also draw the mesh by the number of photographs that were used, and contact sheets of "
            "some triangles' views, into WORK/resample/pictures."},
           pictures);
  }
};

void DrawCoverage(const lfm::LightField& light_field, const std::filesystem::path& folder) {
  constexpr int kAzimuths_deg[] = {-60, 60, 180};
  constexpr double kElevation = 0.35, kDegree = std::numbers::pi / 180;
  constexpr int kWidth = 640, kHeight = 720;
  lfm::MeshPictureOptions options;
  options.values = lfm::CoverageValues(light_field);
  options.value_high =
      std::max(1.0F, *std::max_element(options.values.begin(), options.values.end()));
  for (const int azimuth_deg : kAzimuths_deg) {
    const lfm::MeshView view =
        lfm::ViewMeshFrom(light_field.mesh(), azimuth_deg * kDegree, kElevation, kWidth, kHeight);
    lfm::WriteImage(lfm::DrawMesh(light_field.mesh(), view.camera, view.camera_from_world, options),
                    folder / ("coverage_" + std::to_string(azimuth_deg) + ".png"));
  }
}

/// Of a few triangles that some photograph shows, spread evenly.
void DrawContactSheets(const lfm::LightField& light_field, const std::filesystem::path& folder) {
  constexpr size_t kSheets = 8;
  std::vector<int> seen;
  for (int t = 0; t < light_field.triangle_count(); ++t) {
    if (!light_field.Patch(t).photos.empty()) seen.push_back(t);
  }
  const size_t count = std::min(kSheets, seen.size());
  for (size_t i = 0; i < count; ++i) {
    const int triangle = seen[i * seen.size() / count];
    lfm::WriteImage(lfm::PatchContactSheet(light_field, triangle),
                    folder / ("triangle_" + std::to_string(triangle) + ".png"));
  }
}

void Report(const lfm::ResampleResult& result, lfm::Progress& progress) {
  char line[200];
  std::snprintf(line, sizeof(line),
                "%.1f views and %.0f samples a triangle; %d triangles unseen; %.2f %% saturated, "
                "%.1f %% near edges, %.1f %% hidden; "
                "%.0f %% of directions inside the photographs'",
                result.mean_visible_views, result.samples_per_triangle, result.unseen_triangles,
                100 * result.saturated_share, 100 * result.near_edge_share,
                100 * result.hidden_share, 100 * result.seen_directions_share);
  progress.Note(line);
  if (result.photo_gains.empty()) return;
  std::snprintf(line, sizeof(line),
                "exposures differ by %.2f stops (standard deviation): brought to one, %.1f %% off "
                "where it was %.1f %%",
                lfm::ExposureSpreadStops(result.photo_gains), 100 * result.gain_error_with,
                100 * result.gain_error_without);
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
    lfm::RequireWritableFolder(work / "resample");
    const std::filesystem::path dense = output.dense;
    if (!dense.empty()) lfm::RequireWritableFolder(dense.parent_path());
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    const lfm::CalibResult calib = lfm::CalibOfCapture(capture, work / "calib");
    const bool own_mesh = !std::filesystem::exists(work / "mesh") && capture.BringsGeometry();
    const lfm::MeshResult mesh =
        own_mesh ? lfm::PrepareGivenMesh(lfm::ReadPlyMesh(capture.folder / capture.mesh), calib,
                                         lfm::MeshOptions{}, progress)
                 : lfm::LoadMesh(work / "mesh");
    const std::filesystem::path file = work / "resample" / "light_field.lfs";
    const lfm::ResampleResult result =
        lfm::Resample(capture, calib, mesh.surface, mesh.mesh, lfm::MakeImageLoader(capture),
                      options, file, progress);
    lfm::SavePhotoGains(result.photo_ids, result.photo_gains, work / "resample");
    Report(result, progress);
    if (dense.empty() && !output.pictures) return;
    const lfm::LightField light_field = lfm::LightField::Open(file);
    if (!dense.empty()) lfm::WriteDense(light_field, dense, progress);
    if (output.pictures) {
      progress.Start("drawing", 2);
      DrawCoverage(light_field, work / "resample" / "pictures");
      progress.Advance();
      DrawContactSheets(light_field, work / "resample" / "pictures");
      progress.Advance();
    }
  });
}
