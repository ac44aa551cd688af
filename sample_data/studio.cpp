// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/studio.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include "calib/board.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "sample_data/camera_path.h"
#include "sample_data/coat_shading.h"
#include "sample_data/photo_renderer.h"
#include "sample_data/scan_renderer.h"
#include "scan/patterns.h"

namespace lfm {
namespace {

constexpr const char* kPhotoCamera = "photo";
constexpr const char* kScannerCamera = "scanner";
// What white paper becomes where the plate is lit best, linear: bright, but never saturated.
constexpr double kPaperLevel = 0.68;
constexpr uint64_t kScanPictures = 1u << 20, kPlacementPictures = 1u << 21;

std::string Numbered(const char* format, int number) {
  char text[64];
  std::snprintf(text, sizeof(text), format, number);
  return text;
}

// The standard sequence, with another number of phase steps.
PatternSequence MakeSequence(const Camera& projector, int phase_steps, PatternRows rows) {
  PatternSequence sequence = MakePatternSequence(projector.width, projector.height, rows);
  const std::vector<Pattern> standard = std::move(sequence.patterns);
  sequence.phase_steps = phase_steps;
  sequence.patterns.clear();
  for (const Pattern& pattern : standard) {
    if (pattern.kind != PatternKind::kPhase) {
      sequence.patterns.push_back(pattern);
    } else if (pattern.index == 0) {
      for (int step = 0; step < phase_steps; ++step) {
        sequence.patterns.push_back({PatternKind::kPhase, pattern.axis, step});
      }
    }
  }
  return sequence;
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
        seed_(static_cast<uint64_t>(options.seed)),
        board_(DefaultBoard()),
        reflectance_(board_) {}

  StudioResult Run() {
    MakeObject();
    result_.capture.name = options_.mesh.empty() ? "bust" : "mesh";
    result_.capture.board = "board.json";
    result_.truth.name = result_.capture.name + " (ground truth)";
    result_.truth.mesh = "mesh.ply";
    TakePhotos();
    if (options_.scans > 0 || options_.placements > 0) TakeScans();
    result_.mesh = std::move(subject_.mesh);
    return std::move(result_);
  }

 private:
  void MakeObject() {
    progress_.Start("shaping the object", 1);
    subject_ = options_.mesh.empty()
                   ? MakeBust(options_.edge_mm, seed_)
                   : MakeSubject(ReadPlyMesh(options_.mesh), options_.mesh_height_mm,
                                 options_.edge_mm, seed_);
    const Pose table{Eigen::Matrix3d::Identity(), {0, 0, -kPlateThicknessMm}};
    scene_ = std::make_unique<StudioScene>(&subject_.mesh, MakePlateAndTable(board_, table));
    progress_.Advance();
  }

  void TakePhotos() {
    const Camera camera = MakePhotoCamera(options_.photo_width, options_.photo_height);
    CameraPathOptions path;
    path.photos = options_.photos;
    path.test_photos = options_.test_photos;
    path.mm_per_pixel = 0.24 * 720 / options_.photo_height;
    path.seed = seed_;
    const std::vector<CameraStation> stations = MakeCameraPath(camera, subject_.mesh, path);

    const Lighting lighting = MakeStudioLighting();
    BakeOptions bake;
    bake.seed = seed_;
    if (options_.tiny) {
      bake.gather_rays = 64;
      bake.rays_per_cell = 4;
      bake.plate_spacing_mm = 2;
    }
    const BakedLight light = BakeLight(*scene_, subject_, lighting, reflectance_, bake, progress_);
    const CoatShading shading(subject_, lighting, light);
    const float exposure = static_cast<float>(kPaperLevel / BrightestPaper(light));
    const PixelRays rays(camera);
    progress_.Start("photographs", options_.photos);
    ParallelFor(0, options_.photos, [&](int64_t i) {
      const RenderedPhoto photo =
          RenderPhoto(*scene_, shading, reflectance_, rays, stations[i].camera_from_world);
      WritePhoto(static_cast<int>(i), photo, exposure, stations[i].split);
      progress_.Advance();
    });

    result_.capture.cameras[kPhotoCamera] = {camera.width, camera.height, {}, {}};
    result_.truth.cameras[kPhotoCamera] = {camera.width, camera.height, camera, {}};
    for (int i = 0; i < options_.photos; ++i) {
      Photo photo;
      photo.id = Numbered("photo_%03d", i);
      photo.file = "photos/" + photo.id + ending_;
      photo.camera = kPhotoCamera;
      photo.split = stations[i].split;
      result_.capture.photos.push_back(photo);
      photo.file = "photos/" + photo.id + ".png";
      photo.mask = "masks/" + photo.id + ".png";
      photo.camera_from_world = stations[i].camera_from_world;
      result_.truth.photos.push_back(photo);
    }
  }

  // Radiance of the best lit paper.
  double BrightestPaper(const BakedLight& light) const {
    float brightest = 0;
    for (size_t p = 0; p < light.patches.size(); ++p) {
      if (scene_->patches()[p].material != PatchMaterial::kPrint) continue;
      for (const Eigen::Vector3f& e : light.patches[p].irradiance) {
        brightest = std::max(brightest, e.maxCoeff());
      }
    }
    return brightest * kPaperAlbedo / std::numbers::pi;
  }

  void WritePhoto(int index, const RenderedPhoto& photo, float exposure, PhotoSplit split) {
    const int width = photo.radiance.width(), height = photo.radiance.height();
    Image noisy(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
    Image clean(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
    std::vector<float> row(static_cast<size_t>(width) * 3);
    const Sensor sensor;
    for (int y = 0; y < height; ++y) {
      const float* in = &photo.radiance.At<float>(0, y);
      for (size_t i = 0; i < row.size(); ++i) row[i] = exposure * in[i];
      ExposeRow(sensor, row.data(), static_cast<int>(row.size()), seed_,
                static_cast<uint64_t>(index), static_cast<uint64_t>(y), &noisy.At<uint8_t>(0, y));
      uint8_t* out = &clean.At<uint8_t>(0, y);
      for (size_t i = 0; i < row.size(); ++i) out[i] = EncodeSrgb8(row[i]);
    }
    const std::string id = Numbered("photo_%03d", index);
    sink_("photos/" + id + ending_, noisy);
    sink_("ground_truth/masks/" + id + ".png", photo.mask);
    if (split == PhotoSplit::kTest) sink_("ground_truth/photos/" + id + ".png", clean);
  }

  void TakeScans() {
    const ScanRig rig = MakeScanRig(options_.scan_width, options_.scan_height,
                                    options_.projector_width, options_.projector_height);
    const PixelRays rays(rig.camera);
    Scanner scanner;
    scanner.camera = kScannerCamera;
    scanner.projector_width = rig.projector.width;
    scanner.projector_height = rig.projector.height;
    const PatternSequence columns =
        MakeSequence(rig.projector, options_.phase_steps, PatternRows::kWithout);
    const PatternSequence both =
        MakeSequence(rig.projector, options_.phase_steps, PatternRows::kWith);
    scanner.scan_roles = RoleNames(columns);
    scanner.placement_roles = RoleNames(both);
    progress_.Start("scans", options_.scans + options_.placements);

    const PatternTable scan_patterns(columns);
    const std::vector<Pose> poses =
        MakeScanPoses(options_.scans, options_.rig_low_deg, options_.rig_high_deg);
    const ScanSubject painted{scene_.get(), &subject_.mesh, &reflectance_};
    for (int i = 0; i < options_.scans; ++i) {
      const std::vector<Image> frames =
          RenderScan(painted, rig, rays, poses[i], scan_patterns, ScanExposure(), Sensor(), seed_,
                     kScanPictures + static_cast<uint64_t>(i));
      scanner.scans.push_back(
          WriteFrames("scans/", Numbered("scan_%02d", i), scanner.scan_roles, frames));
      progress_.Advance();
    }

    const PatternTable placement_patterns(both);
    const std::vector<PlatformPlacement> placements = MakePlacements(options_.placements);
    for (int i = 0; i < options_.placements; ++i) {
      const StudioScene empty(nullptr, MakePlateAndTable(board_, placements[i].world_from_table));
      const std::vector<Image> frames =
          RenderScan({&empty, nullptr, &reflectance_}, rig, rays, placements[i].camera_from_world,
                     placement_patterns, ScanExposure(), Sensor(), seed_,
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
  std::string ending_;
  uint64_t seed_;
  Board board_;
  SetReflectance reflectance_;
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
  Capture truth = result.truth;
  truth.folder = folder / "ground_truth";
  WritePly(result.mesh, truth.folder / truth.mesh);
  SaveCapture(truth);
  WriteBoard(DefaultBoard(), folder / result.capture.board);
  Capture capture = result.capture;
  capture.folder = folder;
  SaveCapture(capture);
}

}  // namespace lfm
