// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/studio.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/board.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/output_folder.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "sample_data/camera_path.h"
#include "sample_data/exports.h"
#include "sample_data/exposed_picture.h"
#include "sample_data/field_studio.h"
#include "sample_data/photo_shoot.h"
#include "sample_data/photo_source.h"
#include "sample_data/plate.h"
#include "sample_data/random.h"
#include "sample_data/scene_file.h"
#include "sample_data/scene_mesh.h"
#include "sample_data/trouble_files.h"

namespace lfm {
namespace {

constexpr const char* kPhotoCamera = "photo";
constexpr const char* kScannerCamera = "scanner";
// The scene whose light is baked.
constexpr const char* kPaintedScene = "bust";
// What white paper becomes where the plate is lit best, linear: bright, but never saturated.
constexpr double kPaperLevel = 0.68;
constexpr uint64_t kBorderStream = 35;
// The most that one path of few may bring of bounced light, in units of the best lit paper's
// radiance: more comes from caustics, which are fireflies at few samples.
constexpr double kIndirectLimit = 1;
// Of traced scenes with --tiny.
constexpr int kTinySamples = 2, kTinyBounces = 1;
// Photographs that tell the noise of a baked scene.
constexpr int kNoisePhotos = 4;

std::string Numbered(const char* format, int number) {
  char text[64];
  std::snprintf(text, sizeof(text), format, number);
  return text;
}

std::string PhotoEnding(const StudioOptions& options) {
  const PhotoFormat format = options.trouble.photo.format;
  if (format == PhotoFormat::kPng8 && options.jpeg_quality > 0) return ".jpg";
  return PictureEnding(format);
}

Board ChooseBoard(const std::string& file) {
  if (file.empty()) return DefaultBoard();
  Board board = ReadBoard(file);
  RequireReadableMarks(board, file);
  for (const BoardPlate& plate : PlatesOf(board)) {
    if (std::max(plate.board->width_mm, plate.board->height_mm) > kTableSizeMm) {
      throw Error(file + ": the board is larger than the studio's table of " +
                  std::to_string(static_cast<int>(kTableSizeMm)) +
                  " mm; use a smaller one (lengths are millimetres)");
    }
  }
  return board;
}

// One run of the studio.
class Studio {
 public:
  Studio(const StudioOptions& options, const PictureSink& sink, Progress& progress)
      : options_(options),
        sink_(sink),
        progress_(progress),
        ending_(options.jpeg_quality > 0 ? ".jpg" : ".png"),
        photo_ending_(PhotoEnding(options)),
        seed_(static_cast<uint64_t>(options.seed)),
        sag_mm_(options.trouble.platform.plate_sag_mm),
        sensor_(MakeSensor(options)),
        nominal_(ChooseBoard(options.board)),
        board_(PrintedBoard(nominal_, options.trouble.platform, seed_)),
        reflectance_(board_) {}

  StudioResult Run() {
    MakeObject();
    result_.capture.name = scene_description_      ? scene_description_->name
                           : options_.mesh.empty() ? kPaintedScene
                                                   : "mesh";
    result_.capture.board = "board.json";
    result_.truth.name = result_.capture.name + " (ground truth)";
    result_.truth.mesh = "mesh.ply";
    TakePhotos();
    if (options_.scans > 0 || options_.placements > 0) ScanObject();
    result_.mesh = std::move(subject_.mesh);
    result_.board = nominal_;
    result_.printed = board_;
    return std::move(result_);
  }

 private:
  void MakeObject() {
    progress_.Start("shaping the object", 1);
    if (!options_.mesh.empty()) {
      ImportedMesh imported = ImportMesh(options_.mesh);
      for (const std::string& warning : imported.warnings) progress_.Note(warning);
      subject_ = MakeSubject(std::move(imported), options_.mesh_height_mm, options_.edge_mm, seed_);
    } else if (options_.scene == kPaintedScene) {
      subject_ = MakeBust(options_.edge_mm, seed_);
    } else {
      scene_description_ =
          FindScene(options_.scene, options_.tiny ? SceneDetail::kTiny : SceneDetail::kDefault);
      for (const std::string& warning : scene_description_->warnings) progress_.Note(warning);
      if (options_.tiny) {
        scene_description_->bounces = std::min(scene_description_->bounces, kTinyBounces);
      }
      subject_.mesh = JoinObjects(scene_description_->objects);
    }
    const Pose table{Eigen::Matrix3d::Identity(), {0, 0, -kPlateThicknessMm}};
    scene_ = std::make_unique<StudioScene>(&subject_.mesh,
                                           MakeBentPlateAndTable(board_, sag_mm_, table));
    progress_.Advance();
  }

  // With `times` as many samples as usual.
  std::unique_ptr<PhotoSource> TracedScene(int times) const {
    const int usual_samples = options_.tiny ? kTinySamples : 16;
    return MakeTracedSource(*scene_description_, scene_->patches(), reflectance_,
                            times * options_.SamplesPerPixel(usual_samples),
                            options_.quality == RenderQuality::kReference
                                ? std::numeric_limits<double>::infinity()
                                : kIndirectLimit,
                            seed_);
  }

  std::unique_ptr<PhotoSource> LightScene() {
    if (scene_description_) return TracedScene(1);
    BakeOptions bake;
    bake.seed = seed_;
    bake.gather_rays = options_.SamplesPerPixel(bake.gather_rays);
    if (options_.quality == RenderQuality::kReference) bake.rays_per_cell *= 4;
    if (options_.tiny) {
      bake.gather_rays /= 2;
      bake.rays_per_cell = 4;
      bake.plate_spacing_mm = 2;
    }
    return MakeBakedSource(*scene_, subject_, reflectance_, bake, progress_);
  }

  void TakePhotos() {
    const PhotoTrouble& trouble = options_.trouble.photo;
    const Camera camera = ScaleDistortion(
        MakePhotoCamera(options_.photo_width, options_.photo_height), trouble.distortion);
    CameraPathOptions path;
    path.photos = options_.photos;
    path.test_photos = options_.test_photos;
    path.mm_per_pixel = 0.24 * 720 / options_.photo_height;
    path.seed = seed_;
    std::vector<CameraStation> stations = MakeCameraPath(camera, subject_.mesh, path);
    DrawConditions(camera, stations);

    const StageClock lighting_clock;
    const std::unique_ptr<PhotoSource> source = LightScene();
    if (const RayCounts traced = source->LightingRays(); traced.Total() > 0) {
      StageReport& report = result_.report.emplace_back();
      report.name = "baking light";
      report.rays = traced;
      lighting_clock.Stop(report);
    }
    const StageClock clock;
    const PixelRays rays(camera);
    const auto renderer_of = [](const PhotoSource& from) -> PhotoRenderer {
      return [&from](const PixelRays& r, const Pose& pose) { return from.Render(r, pose); };
    };
    std::unique_ptr<PhotoSource> finer;
    if (options_.test_light > 1) finer = TracedScene(options_.test_light);
    const auto render_occluded = [&](const Occluder& occluder) {
      return source->WithOccluder(occluder);
    };
    const PhotoShoot shoot{rays,
                           trouble,
                           renderer_of(*source),
                           renderer_of(finer ? *finer : *source),
                           render_occluded,
                           sensor_,
                           static_cast<float>(kPaperLevel / source->BrightestPaper()),
                           SubjectCenter(subject_.mesh),
                           seed_};
    progress_.Start("photographs", options_.photos);
    StageReport report;
    report.name = "photographs";
    std::vector<TakenPhoto> taken(static_cast<size_t>(options_.photos));
    ParallelFor(0, options_.photos, [&](int64_t i) {
      TakenPhoto photo = TakePhoto(shoot, static_cast<int>(i), stations[i].camera_from_world,
                                   stations[i].split, result_.conditions[i]);
      const std::string id = Numbered("photo_%03d", static_cast<int>(i));
      sink_("photos/" + id + photo_ending_, photo.picture);
      sink_("ground_truth/masks/" + id + ".png", photo.mask);
      if (!photo.clean.empty()) sink_("ground_truth/photos/" + id + ".png", photo.clean);
      taken[i].rays = photo.rays;
      taken[i].noise = photo.noise;
      progress_.Advance();
    });
    NoiseTally noise;
    for (const TakenPhoto& photo : taken) {
      report.rays += photo.rays;
      noise += photo.noise;
    }
    clock.Stop(report);
    noise += CompareWithSecondLight(*source, shoot, stations);
    report.noise = noise;
    result_.report.push_back(std::move(report));
    ListPhotos(camera, stations);
  }

  // Of sources whose pictures do not know their error: some photographs are rendered twice.
  NoiseTally CompareWithSecondLight(const PhotoSource& source, const PhotoShoot& shoot,
                                    const std::vector<CameraStation>& stations) const {
    NoiseTally noise;
    const int count = std::min(kNoisePhotos, options_.photos);
    for (int i = 0; i < count; ++i) {
      const Pose& pose =
          stations[static_cast<size_t>(i) * stations.size() / count].camera_from_world;
      const std::optional<RenderedPhoto> again = source.RenderAgain(shoot.rays, pose);
      if (!again) break;
      noise += TallyDifferences(source.Render(shoot.rays, pose).radiance, again->radiance,
                                shoot.exposure, shoot.sensor);
    }
    return noise;
  }

  // Who has a stick before the lens, and who looks past the platform.
  void DrawConditions(const Camera& camera, std::vector<CameraStation>& stations) {
    std::vector<PhotoSplit> splits;
    for (const CameraStation& station : stations) splits.push_back(station.split);
    result_.conditions = DrawPhotoConditions(options_.trouble.photo, splits, seed_);
    const Eigen::Vector3d center = SubjectCenter(subject_.mesh);
    for (size_t i = 0; i < stations.size(); ++i) {
      if (!result_.conditions[i].half_framed) continue;
      RandomStream random(seed_, kBorderStream, i);
      const int side = static_cast<int>(4 * random.Uniform());
      stations[i].camera_from_world = AimAtBorder(camera, stations[i].camera_from_world, center,
                                                  side, random.Uniform(0.35, 0.65));
    }
  }

  void ListPhotos(const Camera& camera, const std::vector<CameraStation>& stations) {
    std::optional<ColorEncoding> encoding;
    if (options_.trouble.photo.format == PhotoFormat::kPng16) encoding = ColorEncoding::kLinear;
    result_.capture.cameras[kPhotoCamera] = {camera.width, camera.height, {}, encoding};
    result_.truth.cameras[kPhotoCamera] = {camera.width, camera.height, camera, {}};
    for (int i = 0; i < options_.photos; ++i) {
      Photo photo;
      photo.id = Numbered("photo_%03d", i);
      photo.file = "photos/" + photo.id + photo_ending_;
      photo.camera = kPhotoCamera;
      photo.split = stations[i].split;
      result_.capture.photos.push_back(photo);
      photo.file = "photos/" + photo.id + ".png";
      photo.mask = "masks/" + photo.id + ".png";
      photo.camera_from_world = stations[i].camera_from_world;
      result_.truth.photos.push_back(photo);
    }
  }

  void ScanObject() {
    TakenScans taken = TakeScans(options_, {*scene_, subject_.mesh, reflectance_, board_}, sensor_,
                                 kScannerCamera, ending_, sink_, progress_);
    const Camera& camera = taken.camera;
    result_.capture.cameras[kScannerCamera] = {camera.width, camera.height, {}, {}};
    result_.truth.cameras[kScannerCamera] = {camera.width, camera.height, camera, {}};
    result_.capture.scanner = std::move(taken.scanner);
    result_.truth.scanner = std::move(taken.truth);
    result_.report.push_back(std::move(taken.report));
  }

  const StudioOptions& options_;
  const PictureSink& sink_;
  Progress& progress_;
  std::string ending_, photo_ending_;
  uint64_t seed_;
  double sag_mm_;
  Sensor sensor_;
  Board nominal_, board_;  // as designed, as printed
  SetReflectance reflectance_;
  std::optional<SceneDescription> scene_description_;  // none: the subject is painted
  Subject subject_;
  std::unique_ptr<StudioScene> scene_;
  StudioResult result_;
};

}  // namespace

Sensor MakeSensor(const StudioOptions& options) {
  const SensorTrouble& asked = options.trouble.sensor;
  const SensorTrouble usual;
  const bool untouched = asked.full_well_electrons == usual.full_well_electrons &&
                         asked.read_noise_electrons == usual.read_noise_electrons;
  const bool silent =
      asked.noise == SensorNoise::kOff || (asked.noise == SensorNoise::kAuto && untouched &&
                                           options.quality == RenderQuality::kReference);
  if (silent) return {std::numeric_limits<double>::infinity(), 0};
  return {asked.full_well_electrons, asked.read_noise_electrons};
}

StudioOptions ResolveTiny(const StudioOptions& options) {
  if (!options.tiny) return options;
  const StudioOptions defaults;
  StudioOptions resolved = options;
  const auto shrink = [&](auto StudioOptions::*field, auto tiny) {
    if (options.*field == defaults.*field) resolved.*field = tiny;
  };
  const bool painted = !options.mesh.empty() || options.scene == kPaintedScene;
  shrink(&StudioOptions::photos, painted ? 20 : 12);
  shrink(&StudioOptions::test_photos, 2);
  shrink(&StudioOptions::photo_width, 320);
  shrink(&StudioOptions::photo_height, 240);
  shrink(&StudioOptions::scans, 3);
  shrink(&StudioOptions::placements, 3);
  shrink(&StudioOptions::scan_width, 240);
  shrink(&StudioOptions::scan_height, 180);
  shrink(&StudioOptions::projector_width, 256);
  shrink(&StudioOptions::projector_height, 192);
  shrink(&StudioOptions::phase_steps, 4);
  shrink(&StudioOptions::rig_low_deg, 36.0);
  shrink(&StudioOptions::edge_mm, 3.5);
  return resolved;
}

StudioResult RenderStudio(const StudioOptions& options, const PictureSink& sink,
                          Progress& progress) {
  StudioOptions resolved = ResolveTiny(options);
  ValidateOptions(AnyOptions(resolved));
  if (resolved.test_light > 1 && (!resolved.mesh.empty() || resolved.scene == kPaintedScene)) {
    throw Error(
        "--test-light has no effect on painted objects, whose light is baked; leave it out");
  }
  return Studio(resolved, sink, progress).Run();
}

void MakeCapture(const StudioOptions& options, const std::filesystem::path& folder,
                 Progress& progress) {
  RequireWritableFolder(folder);
  if (options.mesh.empty() && options.scene != kPaintedScene) {
    SceneDescription scene =
        FindScene(options.scene, options.tiny ? SceneDetail::kTiny : SceneDetail::kDefault);
    if (scene.kind != SceneKind::kLightField) {
      if (!options.board.empty()) {
        throw Error("--board: scene \"" + options.scene + "\" has no platform; leave --board out");
      }
      if (options.test_light > 1) {
        throw Error("--test-light: scene \"" + options.scene +
                    "\" has no photographs; leave --test-light out");
      }
      if (options.tiny) scene = ShrinkField(std::move(scene));
      MakeFieldCapture(scene, options, folder, progress);
      return;
    }
  }
  ImageWriteOptions write;
  write.png_compression = 1;
  if (options.jpeg_quality > 0) write.jpeg_quality = options.jpeg_quality;
  // What turns out to be wrong with the options before leaves an earlier capture as it is.
  std::once_flag first_picture;
  const StudioResult result = RenderStudio(
      options,
      [&](const std::string& file, const Image& picture) {
        std::call_once(first_picture, [&] {
          std::error_code error;
          std::filesystem::remove(folder / "capture.json", error);
        });
        WriteImage(picture, folder / file, write);
      },
      progress);
  Capture capture = result.capture, truth = result.truth;
  capture.folder = folder;
  truth.folder = folder / "ground_truth";
  WritePly(result.mesh, truth.folder / truth.mesh);
  WriteTrouble(options, result, truth.folder);
  WriteExports(capture, truth);
  WriteStudioReport(options, result.report, truth.folder / "studio.json");
  NoteReport(result.report, progress);
  SaveCapture(truth);
  WriteBoard(result.board, folder / capture.board);
  SaveCapture(capture);
}

}  // namespace lfm
