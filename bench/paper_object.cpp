// SPDX-License-Identifier: BSD-3-Clause
#include "bench/paper_object.h"

#include <cmath>
#include <utility>

#include "calib/calib_files.h"
#include "core/error.h"
#include "core/ply.h"
#include "mesh/mesh.h"
#include "mesh/mesh_files.h"
#include "pipeline/picture_sheet.h"
#include "pipeline/pipeline.h"
#include "pipeline/truth.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

// The photographs of the capture with cameras, poses and mesh of its truth.
Capture WithTrueGeometry(const Capture& capture, const Capture& truth) {
  Capture given = capture;
  given.mesh = "ground_truth/" + truth.mesh;
  for (auto& [key, camera] : given.cameras) camera.intrinsics = truth.cameras.at(key).intrinsics;
  for (size_t i = 0; i < given.photos.size(); ++i) {
    given.photos[i].camera_from_world = truth.photos.at(i).camera_from_world;
  }
  return given;
}

PaperLightField Resampled(const PaperObject& object, const TriangleMesh& mesh,
                          const ResampleOptions& options, Progress& progress) {
  const fs::path file = object.folder / "light_field.lfs";
  const ResampleResult figures = Resample(object.capture, object.calib, object.surface, mesh,
                                          MakeImageLoader(object.capture), options, file, progress);
  PaperLightField result{LightField::Open(file), figures, {}, 0};
  result.eyes =
      EyesOfPhotos(object.calib, result.light_field.photo_ids(), result.light_field.name());
  for (int t = 0; t < result.light_field.triangle_count(); ++t) {
    const TrianglePatch patch = result.light_field.Patch(t);
    result.raw_bytes += int64_t{3} * PatchSampleCount(patch.edge_samples) *
                        static_cast<int64_t>(patch.photos.size());
  }
  return result;
}

}  // namespace

PaperObject OpenPaperObject(const fs::path& folder, GeometryOf geometry, Progress& progress) {
  PaperObject object{folder.filename().string(), folder, LoadCapture(folder / "capture"), {}, {}};
  if (geometry == GeometryOf::kTruth) {
    GroundTruth truth = LoadGroundTruth(object.capture.folder);
    object.capture = WithTrueGeometry(object.capture, truth.capture);
    object.calib = CalibFromCapture(object.capture);
    object.surface = std::move(truth.mesh);
    return object;
  }
  PipelineOptions options;
  options.out = (folder / "work").string();
  options.to = "mesh";
  RunPipeline(object.capture.folder, options, progress);
  object.calib = LoadCalibOf(object.capture, folder / "work/calib");
  object.surface = ReadPlyMesh(folder / "work/mesh/surface.ply");
  return object;
}

PaperLightField ResamplePaperObject(const PaperObject& object, double samples_per_triangle,
                                    const ResampleOptions& options, Progress& progress) {
  MeshOptions mesh;
  constexpr double kCloseEnough = 0.03;
  mesh.samples_per_triangle = samples_per_triangle;
  for (int attempt = 0;; ++attempt) {
    const MeshResult made = PrepareGivenMesh(object.surface, object.calib, mesh, progress);
    PaperLightField result = Resampled(object, made.mesh, options, progress);
    const double ratio = samples_per_triangle / result.figures.samples_per_triangle;
    if (attempt == 2 || !(samples_per_triangle > 0) || std::abs(ratio - 1) < kCloseEnough) {
      return result;
    }
    mesh.samples_per_triangle *= ratio;
  }
}

HeldoutScores ScorePaperModel(const PaperObject& object, const LightFieldModel& model,
                              Progress& progress) {
  return ScoreModel(ReferenceRenderer(model), object.calib,
                    {{PhotographsOf(object.capture)}, SilhouettesOf(object.surface, object.calib)},
                    progress)
      .front();
}

Image PhotographBeside(const PaperObject& object, int photograph,
                       const std::vector<const LightFieldModel*>& models) {
  constexpr int kMargin = 12, kAllTerms = 1 << 20;
  int left = photograph;
  for (const PosedImage& photo : object.calib.photos) {
    if (photo.split != PhotoSplit::kTest || left-- > 0) continue;
    const Image mask = SilhouettesOf(object.surface, object.calib)(photo);
    std::vector<Image> row = {CropToMask(PhotographsOf(object.capture)(photo), mask, kMargin)};
    for (const LightFieldModel* model : models) {
      row.push_back(
          CropToMask(RenderPhotoCamera(ReferenceRenderer(*model), object.calib, photo, kAllTerms),
                     mask, kMargin));
    }
    return SideBySide(row);
  }
  throw Error(object.name + ": has no test photograph " + std::to_string(photograph));
}

}  // namespace lfm
