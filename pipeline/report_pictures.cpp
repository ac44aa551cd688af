// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/report_pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/board.h"
#include "calib/calib_files.h"
#include "calib/calib_pictures.h"
#include "core/error.h"
#include "core/options.h"
#include "core/ply.h"
#include "core/ray_scene.h"
#include "encode/encode_pictures.h"
#include "encode/glb.h"
#include "mesh/mesh_files.h"
#include "mesh/mesh_pictures.h"
#include "pipeline/heldout.h"
#include "pipeline/picture_sheet.h"
#include "pipeline/stage_cache.h"
#include "resample/light_field.h"
#include "resample/resample_pictures.h"
#include "scan/scan_pictures.h"
#include "viewer/orbit_camera.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

constexpr int kViewWidth = 480, kViewHeight = 540;
constexpr double kViewAzimuths_deg[] = {-60, 60, 180};
constexpr double kViewElevation_deg = 20;
constexpr double kDegree = std::numbers::pi / 180;

// Collects pictures as they are drawn.
class Gallery {
 public:
  explicit Gallery(fs::path folder) : folder_(std::move(folder)) {}
  void Add(const std::string& stage, const std::string& name, const std::string& caption,
           const Image& image) {
    WriteImage(image, folder_ / (name + ".png"));
    pictures_.push_back({stage, "pictures/" + name + ".png", caption});
  }
  std::vector<ReportPicture> Pictures() const { return pictures_; }

 private:
  fs::path folder_;
  std::vector<ReportPicture> pictures_;
};

// A few of many, spread evenly.
template <typename T>
std::vector<T> Spread(const std::vector<T>& all, size_t count) {
  std::vector<T> some;
  count = std::min(count, all.size());
  for (size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
  return some;
}

void DrawCalib(const Capture& capture, const CalibResult& calib, Gallery& gallery) {
  if (capture.board.empty()) return;
  const Board board = ReadBoard(capture.folder / capture.board);
  const ImageLoader load = MakeImageLoader(capture);
  for (const PosedImage& photo : Spread(calib.photos, 2)) {
    gallery.Add("calib", "calib-" + photo.id,
                "Photograph " + photo.id +
                    ": where the calibration puts the print, the corners found, and their errors "
                    "enlarged.",
                DrawCalibration(load(photo.file), board, calib.cameras.at(photo.camera),
                                calib.platform_shape, photo));
  }
}

void DrawScans(const Capture& capture, const ScanOptions& options, Gallery& gallery) {
  if (!capture.scanner || capture.scanner->scans.empty()) return;
  const ImageLoader load = MakeImageLoader(capture);
  for (size_t i = 0; i < capture.scanner->scans.size(); ++i) {
    try {
      const ScanPictures pictures = DrawScan(capture, static_cast<int>(i), load, options);
      gallery.Add("scan", "scan-decoded",
                  "Scan " + capture.scanner->scans[i].id +
                      ": projector column, phase of the fringes, confidence.",
                  SideBySide({pictures.columns, pictures.phase, pictures.confidence}));
      return;
    } catch (const Error&) {
      continue;  // set aside by the stage too, and said so there
    }
  }
}

// Pictures show what the stage did, with the options that it had.
ScanOptions RecordedScanOptions(const Workspace& workspace) {
  ScanOptions options;
  OptionsFromJson(AnyOptions(options), ReadStageRecord(workspace.folder, "scan").options,
                  (workspace.Stage("scan") / "stage.json").string());
  return options;
}

Image DrawFromAllSides(const TriangleMesh& mesh, const MeshPictureOptions& options) {
  std::vector<Image> views;
  for (double azimuth : kViewAzimuths_deg) {
    const MeshView view = ViewMeshFrom(mesh, azimuth * kDegree, kViewElevation_deg * kDegree,
                                       kViewWidth, kViewHeight);
    views.push_back(DrawMesh(mesh, view.camera, view.camera_from_world, options));
  }
  return SideBySide(views);
}

void DrawMeshes(const MeshResult& mesh, Gallery& gallery) {
  gallery.Add("mesh", "mesh-surface", "The dense surface.", DrawFromAllSides(mesh.surface, {}));
  if (!mesh.surface.confidence.empty()) {
    MeshPictureOptions options;
    options.values = mesh.surface.confidence;
    gallery.Add("mesh", "mesh-confidence",
                "Confidence of the dense surface: dark where it was closed without a measurement.",
                DrawFromAllSides(mesh.surface, options));
  }
  MeshPictureOptions wires;
  wires.wires = MeshWires::kDrawn;
  gallery.Add("mesh", "mesh-decimated", "The mesh that carries the light field.",
              DrawFromAllSides(mesh.mesh, wires));
}

void DrawResampling(const LightField& light_field, Gallery& gallery) {
  MeshPictureOptions options;
  options.values = CoverageValues(light_field);
  options.value_high =
      std::max(1.0f, *std::max_element(options.values.begin(), options.values.end()));
  gallery.Add("resample", "resample-coverage",
              "Photographs that were used for each part: dark none, yellow " +
                  std::to_string(std::lround(options.value_high)) + ".",
              DrawFromAllSides(light_field.mesh(), options));
}

void DrawEncoding(const LightFieldModel& model, const nlohmann::json& figures, Gallery& gallery) {
  const auto shares = figures.value("singular_value_share", std::vector<double>());
  for (const EncodePicture& picture : DrawEncodePictures(model, shares)) {
    gallery.Add("encode", "encode-" + picture.name, picture.caption, picture.image);
  }
}

void DrawHeldout(const Capture& capture, const CalibResult& calib, const TriangleMesh& surface,
                 const ReferenceRenderer& renderer, Gallery& gallery) {
  std::vector<PosedImage> tests;
  for (const PosedImage& photo : calib.photos) {
    if (photo.split == PhotoSplit::kTest) tests.push_back(photo);
  }
  const ImageLoader load = MakeImageLoader(capture);
  const RayScene rays(surface);
  constexpr int kGain = 8, kMargin = 6, kAllTerms = 1 << 20;
  for (const PosedImage& photo : Spread(tests, 4)) {
    const Image picture = ToRgb8(load(photo.file));
    const Image mask =
        RenderSilhouette(rays, calib.cameras.at(photo.camera), photo.camera_from_world);
    const Image full = RenderPhotoCamera(renderer, calib, photo, kAllTerms);
    const Image mean_only = RenderPhotoCamera(renderer, calib, photo, 0);
    const Image difference = DifferencePicture(picture, full, mask, kGain);
    std::vector<Image> row;
    for (const Image* image : {&picture, &full, &mean_only, &difference}) {
      row.push_back(CropToMask(*image, mask, kMargin));
    }
    gallery.Add("evaluate", "heldout-" + photo.id,
                "Held-out photograph " + photo.id +
                    ", the model, its mean view alone, and photograph against model, differences "
                    "enlarged 8 times.",
                SideBySide(row));
  }
}

void DrawModel(const ReferenceRenderer& renderer, Gallery& gallery) {
  constexpr double kFov = 0.5;
  constexpr int kSize = 480;
  OrbitCamera orbit = FrameMesh(renderer.model().mesh, kFov, 1);
  RenderOptions options;
  options.samples_per_side = 2;
  std::vector<Image> views;
  for (const OrbitCamera& camera : TurntablePath(orbit, 4)) {
    views.push_back(renderer
                        .Render(PinholeCamera(camera, kSize, kSize), CameraFromWorld(camera),
                                options, SilentProgress())
                        .color);
  }
  gallery.Add("evaluate", "model-turned", "The model from four sides.", SideBySide(views));
}

}  // namespace

std::vector<ReportPicture> MakeReportPictures(const Capture& capture, const Workspace& workspace,
                                              const fs::path& folder, Progress& progress) {
  progress.Start("report: pictures", 6);
  Gallery gallery(folder);
  const CalibResult calib = LoadCalib(workspace.Stage("calib"));
  DrawCalib(capture, calib, gallery);
  progress.Advance();
  DrawScans(capture, RecordedScanOptions(workspace), gallery);
  progress.Advance();
  const MeshResult mesh = LoadMesh(workspace.Stage("mesh"));
  DrawMeshes(mesh, gallery);
  progress.Advance();
  DrawResampling(LightField::Open(workspace.LightFieldFile()), gallery);
  progress.Advance();
  const ReferenceRenderer renderer(ReadGlb(workspace.ModelFile()));
  DrawEncoding(renderer.model(), ReadStageRecord(workspace.folder, "encode").figures, gallery);
  progress.Advance();
  DrawHeldout(capture, calib, mesh.surface, renderer, gallery);
  DrawModel(renderer, gallery);
  progress.Advance();
  return gallery.Pictures();
}

}  // namespace lfm
