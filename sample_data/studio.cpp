// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/studio.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/board.h"
#include "core/atomic_file.h"
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
#include "sample_data/scan_renderer.h"
#include "sample_data/scene_file.h"
#include "sample_data/scene_mesh.h"
#include "sample_data/trouble_files.h"
#include "scan/patterns.h"

namespace lfm {
namespace {

constexpr const char* kPhotoCamera = "photo";
constexpr const char* kScannerCamera = "scanner";
// The scene whose light is baked.
constexpr const char* kPaintedScene = "bust";
// What white paper becomes where the plate is lit best, linear: bright, but never saturated.
constexpr double kPaperLevel = 0.68;
constexpr uint64_t kScanPictures = 1u << 20, kPlacementPictures = 1u << 21;
constexpr uint64_t kBorderStream = 35;

std::string Numbered(const char* format, int number) {
  char text[64];
  std::snprintf(text, sizeof(text), format, number);
  return text;
}

PatternOptions MakePatternOptions(const StudioOptions& options) {
  PatternOptions patterns;
  patterns.scheme = options.patterns;
  patterns.phase_steps = options.phase_steps;
  patterns.stripe = {StripeProfile::kGauss, options.stripe_width_px, options.stripe_step_px};
  return patterns;
}

std::string PhotoEnding(const StudioOptions& options) {
  const PhotoFormat format = options.trouble.photo.format;
  if (format == PhotoFormat::kPng8 && options.jpeg_quality > 0) return ".jpg";
  return PictureEnding(format);
}

std::vector<std::string> RoleNames(const PatternSequence& sequence) {
  std::vector<std::string> names;
  for (const Pattern& pattern : sequence.patterns) names.push_back(PatternName(pattern));
  return names;
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
        sensor_{options.trouble.sensor.full_well_electrons,
                options.trouble.sensor.read_noise_electrons},
        nominal_(options.board.empty() ? DefaultBoard() : ReadBoard(options.board)),
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
    if (options_.scans > 0 || options_.placements > 0) TakeScans();
    result_.mesh = std::move(subject_.mesh);
    result_.board = nominal_;
    result_.printed = board_;
    return std::move(result_);
  }

 private:
  void MakeObject() {
    progress_.Start("shaping the object", 1);
    if (!options_.mesh.empty()) {
      subject_ =
          MakeSubject(ReadPlyMesh(options_.mesh), options_.mesh_height_mm, options_.edge_mm, seed_);
    } else if (options_.scene == kPaintedScene) {
      subject_ = MakeBust(options_.edge_mm, seed_);
    } else {
      scene_description_ =
          FindScene(options_.scene, options_.tiny ? SceneDetail::kTiny : SceneDetail::kDefault);
      for (const std::string& warning : scene_description_->warnings) progress_.Note(warning);
      subject_.mesh = JoinObjects(scene_description_->objects);
    }
    const Pose table{Eigen::Matrix3d::Identity(), {0, 0, -kPlateThicknessMm}};
    scene_ = std::make_unique<StudioScene>(&subject_.mesh,
                                           MakeBentPlateAndTable(board_, sag_mm_, table));
    progress_.Advance();
  }

  std::unique_ptr<PhotoSource> LightScene() {
    if (scene_description_) {
      const int usual_samples = options_.tiny ? 4 : 16;
      return MakeTracedSource(*scene_description_, scene_->patches(), reflectance_,
                              options_.SamplesPerPixel(usual_samples), seed_);
    }
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

    const std::unique_ptr<PhotoSource> source = LightScene();
    const PixelRays rays(camera);
    const PhotoRenderer render = [&](const PixelRays& r, const Pose& camera_from_world) {
      return source->Render(r, camera_from_world);
    };
    const PhotoShoot shoot{rays,
                           source->lighting(),
                           trouble,
                           render,
                           sensor_,
                           static_cast<float>(kPaperLevel / source->BrightestPaper()),
                           SubjectCenter(subject_.mesh),
                           seed_};
    progress_.Start("photographs", options_.photos);
    ParallelFor(0, options_.photos, [&](int64_t i) {
      const TakenPhoto photo = TakePhoto(shoot, static_cast<int>(i), stations[i].camera_from_world,
                                         stations[i].split, result_.conditions[i]);
      const std::string id = Numbered("photo_%03d", static_cast<int>(i));
      sink_("photos/" + id + photo_ending_, photo.picture);
      sink_("ground_truth/masks/" + id + ".png", photo.mask);
      if (!photo.clean.empty()) sink_("ground_truth/photos/" + id + ".png", photo.clean);
      progress_.Advance();
    });
    if (const std::string costs = source->Costs(); !costs.empty()) progress_.Note(costs);
    ListPhotos(camera, stations);
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

  void TakeScans() {
    const ScanRig rig = MakeScanRig(options_.scan_width, options_.scan_height,
                                    options_.projector_width, options_.projector_height);
    const PixelRays rays(rig.camera);
    Scanner scanner;
    scanner.camera = kScannerCamera;
    scanner.projector_width = rig.projector.width;
    scanner.projector_height = rig.projector.height;
    const PatternOptions patterns = MakePatternOptions(options_);
    const PatternSequence columns = MakePatternSequence(rig.projector.width, rig.projector.height,
                                                        PatternRows::kWithout, patterns);
    const PatternSequence both = MakePatternSequence(rig.projector.width, rig.projector.height,
                                                     PatternRows::kWith, patterns);
    scanner.scan_roles = RoleNames(columns);
    scanner.placement_roles = RoleNames(both);
    progress_.Start("scans", options_.scans + options_.placements);

    const ScanTrouble& trouble = options_.trouble.scan;
    const ScanExposure exposure = MakeScanExposure(trouble);
    const PatternTable scan_patterns(columns, trouble);
    const std::vector<Pose> poses = TroubleScanPoses(
        MakeScanPoses(options_.scans, options_.rig_low_deg, options_.rig_high_deg),
        options_.trouble.platform.axis_tilt_deg, options_.trouble.platform.wobble_mm, seed_);
    const ScanSubject painted{scene_.get(), &subject_.mesh, &reflectance_};
    for (int i = 0; i < options_.scans; ++i) {
      const std::vector<Image> frames =
          RenderScan(painted, rig, rays, poses[i], scan_patterns, exposure, sensor_, seed_,
                     kScanPictures + static_cast<uint64_t>(i));
      scanner.scans.push_back(
          WriteFrames("scans/", Numbered("scan_%02d", i), scanner.scan_roles, frames));
      progress_.Advance();
    }

    const PatternTable placement_patterns(both, trouble);
    const std::vector<PlatformPlacement> placements = MakePlacements(options_.placements);
    for (int i = 0; i < options_.placements; ++i) {
      const StudioScene empty(
          nullptr, MakeBentPlateAndTable(board_, sag_mm_, placements[i].world_from_table));
      const std::vector<Image> frames =
          RenderScan({&empty, nullptr, &reflectance_}, rig, rays, placements[i].camera_from_world,
                     placement_patterns, exposure, sensor_, seed_,
                     kPlacementPictures + static_cast<uint64_t>(i));
      scanner.placements.push_back(WriteFrames("placements/", Numbered("placement_%02d", i),
                                               scanner.placement_roles, frames));
      progress_.Advance();
    }
    ListScanner(rig, poses, placements, std::move(scanner));
  }

  ScanSet WriteFrames(const std::string& folder, const std::string& id,
                      const std::vector<std::string>& roles, const std::vector<Image>& frames) {
    ScanSet set;
    set.id = id;
    for (const std::string& role : roles) {
      set.frames.push_back(folder + id + "/" + role + ending_);
    }
    ParallelFor(0, static_cast<int64_t>(frames.size()),
                [&](int64_t f) { sink_(set.frames[f], frames[f]); });
    return set;
  }

  void ListScanner(const ScanRig& rig, const std::vector<Pose>& poses,
                   const std::vector<PlatformPlacement>& placements, Scanner scanner) {
    const Camera& camera = rig.camera;
    result_.capture.cameras[kScannerCamera] = {camera.width, camera.height, {}, {}};
    result_.truth.cameras[kScannerCamera] = {camera.width, camera.height, camera, {}};
    result_.capture.scanner = scanner;
    scanner.projector = rig.projector;
    scanner.projector_from_camera = rig.projector_from_camera;
    for (size_t i = 0; i < scanner.scans.size(); ++i) {
      scanner.scans[i].camera_from_world = poses[i];
    }
    for (size_t i = 0; i < scanner.placements.size(); ++i) {
      scanner.placements[i].camera_from_world = placements[i].camera_from_world;
    }
    result_.truth.scanner = std::move(scanner);
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

StudioOptions ResolveTiny(const StudioOptions& options) {
  if (!options.tiny) return options;
  const StudioOptions defaults;
  StudioOptions resolved = options;
  const auto shrink = [&](auto StudioOptions::*field, auto tiny) {
    if (options.*field == defaults.*field) resolved.*field = tiny;
  };
  shrink(&StudioOptions::photos, 20);
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
  return Studio(resolved, sink, progress).Run();
}

void MakeCapture(const StudioOptions& options, const std::filesystem::path& folder,
                 Progress& progress) {
  if (options.mesh.empty() && options.scene != kPaintedScene) {
    SceneDescription scene =
        FindScene(options.scene, options.tiny ? SceneDetail::kTiny : SceneDetail::kDefault);
    if (scene.kind != SceneKind::kLightField) {
      if (options.tiny) scene = ShrinkField(std::move(scene));
      MakeFieldCapture(scene, options, folder, progress);
      return;
    }
  }
  ImageWriteOptions write;
  write.png_compression = 1;
  if (options.jpeg_quality > 0) write.jpeg_quality = options.jpeg_quality;
  std::error_code error;
  std::filesystem::remove(folder / "capture.json", error);
  const StudioResult result = RenderStudio(
      options,
      [&](const std::string& file, const Image& picture) {
        WriteImage(picture, folder / file, write);
      },
      progress);
  Capture capture = result.capture, truth = result.truth;
  capture.folder = folder;
  truth.folder = folder / "ground_truth";
  WritePly(result.mesh, truth.folder / truth.mesh);
  WriteTrouble(options, result, truth.folder);
  WriteExports(capture, truth);
  SaveCapture(truth);
  WriteBoard(result.board, folder / capture.board);
  SaveCapture(capture);
}

}  // namespace lfm
