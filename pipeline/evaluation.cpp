// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/evaluation.h"

#include "calib/calib_files.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "core/ply.h"
#include "encode/glb.h"
#include "encode/transport_form.h"
#include "mesh/mesh_files.h"
#include "pipeline/heldout.h"
#include "pipeline/truth.h"
#include "scan/scan_files.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// A file that the truth names for a photograph: its mask, or its picture without noise.
PictureOf TruthPictures(const GroundTruth& truth, std::string Photo::*file) {
  return [&truth, file](const PosedImage& posed) {
    for (const Photo& photo : truth.capture.photos) {
      if (photo.id != posed.id) continue;
      const Image image = ReadImage(truth.capture.folder / (photo.*file));
      return file == &Photo::mask ? ToGray(ToSrgb8(image)) : ToRgb8(image);
    }
    throw Error((truth.capture.folder / "capture.json").string() + ": does not know photograph '" +
                posed.id + "'");
  };
}

// Of the stages that have run.
json TruthGeometry(const Workspace& workspace, const CalibResult& calib, const GroundTruth& truth) {
  const PoseErrors poses = MeasurePoses(calib, truth);
  json figures = {{"pose_median_mm", poses.median_mm},
                  {"pose_median_deg", poses.median_deg},
                  {"pose_max_mm", poses.max_mm},
                  {"pose_max_deg", poses.max_deg}};
  const AlignedPoseErrors aligned = MeasureAlignedPoses(calib, truth);
  figures["pose_aligned_median_mm"] = aligned.median_mm;
  figures["pose_scale_percent"] = aligned.scale_percent;
  figures["pose_chi2"] = MeasurePoseHonesty(calib, truth);
  const auto add_intrinsics = [&figures](const std::string& of, const IntrinsicsErrors& errors) {
    if (errors.cameras == 0) return;
    figures[of + "focal_error_percent"] = errors.focal_percent;
    figures[of + "principal_point_error_px"] = errors.principal_point_px;
  };
  add_intrinsics("", MeasurePhotoIntrinsics(calib, truth));
  add_intrinsics("scanner_", MeasureScannerIntrinsics(calib, truth));
  const bool mesh_made = fs::exists(workspace.Stage("mesh") / "mesh.json");
  if (!mesh_made && !fs::exists(workspace.Stage("scan") / "points.ply")) return figures;
  const GeometryJudge judge(truth);
  if (fs::exists(workspace.Stage("scan") / "points.ply")) {
    const PointErrors points =
        judge.MeasurePoints(ReadPlyCloud(workspace.Stage("scan") / "points.ply"));
    figures["points_median_mm"] = points.median_mm;
    figures["points_p95_mm"] = points.p95_mm;
    figures["points_over_1_mm_share"] = points.over_1_mm_share;
    figures["points_completeness"] = points.completeness;
    figures["seen_share"] = points.seen_share;
  }
  if (!mesh_made) return figures;
  const MeshResult mesh = LoadMesh(workspace.Stage("mesh"));
  const SurfaceErrors surface = judge.MeasureSurface(mesh.surface);
  const SurfaceErrors decimated = judge.MeasureSurface(mesh.mesh);
  figures["surface_mean_mm"] = surface.mean_mm;
  figures["surface_rms_mm"] = surface.rms_mm;
  figures["surface_p95_mm"] = surface.p95_mm;
  figures["surface_max_mm"] = surface.max_mm;
  figures["surface_accuracy"] = surface.accuracy;
  figures["surface_completeness"] = surface.completeness;
  figures["surface_f_score"] = surface.f_score;
  figures["mesh_mean_mm"] = decimated.mean_mm;
  figures["mesh_p95_mm"] = decimated.p95_mm;
  return figures;
}

// A picture that somebody made of a test photograph's camera, in `folder`.
PictureOf PicturesIn(const fs::path& folder, const CalibResult& calib) {
  return [&folder, &calib](const PosedImage& photo) {
    for (const char* ending : {".png", ".jpg"}) {
      const fs::path file = folder / (photo.id + ending);
      if (!fs::exists(file)) continue;
      const Image image = ToRgb8(ReadImage(file));
      const Camera& camera = calib.cameras.at(photo.camera);
      if (image.width() != camera.width || image.height() != camera.height) {
        throw Error(file.string() + ": has " + std::to_string(image.width()) + " x " +
                    std::to_string(image.height()) + " pixels; render the camera's " +
                    std::to_string(camera.width) + " x " + std::to_string(camera.height));
      }
      return image;
    }
    throw Error((folder / (photo.id + ".png")).string() +
                ": no such file; render every test photograph's camera");
  };
}

// The figures of one reference, complete: which pixels counted, which photographs are missing.
json Figures(const Capture& capture, const CalibResult& calib, HeldoutScores scores,
             Foreground foreground, Progress& progress) {
  AddUnposedPhotos(capture, calib, scores);
  for (const PhotoScore& photo : scores.photos) {
    progress.Detail("evaluate: " + photo.id + ": " + std::to_string(photo.full.psnr_db) +
                    " dB on " + std::to_string(photo.full.pixels) + " pixels");
  }
  for (const MissingPhoto& photo : scores.missing) {
    progress.Note("not scored: " + photo.id + ": " + photo.reason);
  }
  json figures = ScoresToJson(scores);
  figures["foreground"] =
      foreground == Foreground::kTrueMask ? "true mask" : "silhouette of the dense surface";
  return figures;
}

}  // namespace

json EvaluateWorkspace(const Capture& capture, const Workspace& workspace, Progress& progress,
                       const fs::path& model) {
  const CalibResult calib = LoadCalibOf(capture, workspace.Stage("calib"));
  const TriangleMesh surface = ReadPlyMesh(workspace.Stage("mesh") / "surface.ply");
  const fs::path file = model.empty() ? workspace.ModelFile() : model;
  DecodedModel decoded = ReadModel(file);
  if (decoded.parts_missing > 0) progress.Note(CutOffNote(file, decoded));
  const ReferenceRenderer renderer(std::move(decoded.model));
  const std::vector<HeldoutScores> scores = ScoreModel(
      renderer, calib, {{PhotographsOf(capture)}, SilhouettesOf(surface, calib)}, progress);
  return Figures(capture, calib, scores.front(), Foreground::kSurfaceSilhouette, progress);
}

json EvaluateWithTruth(const Capture& capture, const Workspace& workspace, Progress& progress) {
  const GroundTruth truth = LoadGroundTruth(capture.folder);
  const CalibResult calib = LoadCalibOf(capture, workspace.Stage("calib"));
  const ReferenceRenderer renderer(ReadGlb(workspace.ModelFile()));
  const std::vector<HeldoutScores> scores =
      ScoreModel(renderer, calib,
                 {{PhotographsOf(capture), TruthPictures(truth, &Photo::file)},
                  TruthPictures(truth, &Photo::mask)},
                 progress);
  progress.Start("evaluate: geometry against the truth", 1);
  json figures = TruthGeometry(workspace, calib, truth);
  if (!scores[1].photos.empty()) figures["heldout_psnr_noisefree_db"] = scores[1].psnr_db;
  return {{"truth", figures},
          {"evaluate", Figures(capture, calib, scores[0], Foreground::kTrueMask, progress)}};
}

json EvaluateGeometry(const Capture& capture, const Workspace& workspace, Progress& progress) {
  const GroundTruth truth = LoadGroundTruth(capture.folder);
  const CalibResult calib = LoadCalibOf(capture, workspace.Stage("calib"));
  progress.Start("evaluate: geometry against the truth", 1);
  return TruthGeometry(workspace, calib, truth);
}

json EvaluateImages(const Capture& capture, const Workspace& workspace, const fs::path& images,
                    Foreground foreground, Progress& progress) {
  const CalibResult calib = LoadCalibOf(capture, workspace.Stage("calib"));
  const auto score = [&](const PictureOf& masks) {
    const std::vector<HeldoutScores> scores = ScorePictures(
        PicturesIn(images, calib), calib, {{PhotographsOf(capture)}, masks}, progress);
    return Figures(capture, calib, scores.front(), foreground, progress);
  };
  if (foreground == Foreground::kTrueMask) {
    const GroundTruth truth = LoadGroundTruth(capture.folder);
    return score(TruthPictures(truth, &Photo::mask));
  }
  return score(SilhouettesOf(ReadPlyMesh(workspace.Stage("mesh") / "surface.ply"), calib));
}

}  // namespace lfm
