// SPDX-License-Identifier: BSD-3-Clause
#include "resample/used_photos.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/parallel.h"
#include "core/pixel_directions.h"
#include "resample/photo_depth.h"

namespace lfm {
namespace {

constexpr const char* kCure =
    "or take smaller photographs, or fewer triangles (lfm-mesh --triangle-count)";

int64_t PixelCount(const UsedPhoto& photo) {
  return int64_t{photo.camera.width} * photo.camera.height;
}

using CameraRays = std::map<std::string, std::vector<Eigen::Vector3d>>;

/// Lenses are undone once a camera, not once a photograph: of cameras that took several, as long as
/// their rays take `most_bytes` in all.
CameraRays RaysOfCameras(const std::vector<UsedPhoto>& photos, int64_t most_bytes) {
  std::map<std::string, int> uses;
  for (const UsedPhoto& photo : photos) ++uses[photo.camera_name];
  CameraRays rays;
  for (const UsedPhoto& photo : photos) {
    if (uses[photo.camera_name] < 2 || rays.contains(photo.camera_name)) continue;
    most_bytes -= PixelCount(photo) * static_cast<int64_t>(sizeof(Eigen::Vector3d));
    if (most_bytes < 0) break;
    rays[photo.camera_name] = PixelDirections(photo.camera);
  }
  return rays;
}

void ApplyMask(const Image& mask, const std::string& file, const Camera& camera,
               std::vector<PixelUse>& usable) {
  if (mask.width() != camera.width || mask.height() != camera.height) {
    throw Error(file + ": the mask has another size than the photograph");
  }
  const Image coded = ToSrgb8(mask);
  const uint8_t* values = coded.Data<uint8_t>();
  for (size_t i = 0; i < usable.size(); ++i) {
    if (values[i * static_cast<size_t>(coded.channels())] < 128) {
      usable[i] = PixelUse::kForbidden;
    }
  }
}

// Pictures of floats may hold NaN where a camera or a converter gave up. Infinity is a highlight
// beyond what the file can hold: it saturates.
void ForbidWhatIsNoNumber(const Image& picture, std::vector<PixelUse>& usable) {
  const auto channels = static_cast<size_t>(picture.channels());
  if (picture.type() != PixelType::kFloat32 || picture.size() != usable.size() * channels) return;
  const float* values = picture.Data<float>();
  for (size_t i = 0; i < picture.size(); ++i) {
    if (std::isnan(values[i]) || values[i] == -std::numeric_limits<float>::infinity()) {
      usable[i / channels] = PixelUse::kForbidden;
    }
  }
}

PhotoPixels LookAtPhoto(const UsedPhoto& photo, const PhotoLook& look, const CameraRays& rays,
                        const ImageLoader& load_image, size_t index, VisibleLists& lists) {
  const Image picture = load_image(photo.file);
  PhotoSight sight{photo.camera, photo.camera_from_world, {}, {}};
  const auto known = rays.find(photo.camera_name);
  std::vector<Eigen::Vector3d> own;
  if (known == rays.end()) own = PixelDirections(photo.camera);
  sight.depth = RenderDepth(look.surface, look.surface_scene, photo.camera,
                            known != rays.end() ? known->second : own, photo.camera_from_world);
  sight.usable = FindUsablePixels(sight.depth, photo.camera, look.options.depth_margin_px);
  ForbidWhatIsNoNumber(picture, sight.usable);
  if (!photo.mask.empty()) {
    ApplyMask(load_image(photo.mask), photo.mask, photo.camera, sight.usable);
  }
  lists.Put(index, FindVisibleTriangles(look.mesh, look.deviations_mm, sight,
                                        {look.options.max_grazing_deg, look.options.min_data_share,
                                         look.options.max_hidden_share}));
  return MakePhotoPixels(picture, sight.usable, photo.camera, photo.file);
}

/// How what is left of the memory is used.
struct MemoryPlan {
  int64_t rays_bytes = 0;    ///< of cameras that took several photographs
  bool holds_pixels = true;  ///< or else they are put aside
  int64_t at_once = 1;       ///< photographs looked at
};

MemoryPlan PlanMemory(const std::vector<UsedPhoto>& photos, const TriangleMesh& mesh,
                      const MemoryLimit& memory) {
  // A float picture, its depths, marks, a mask, its rays; projected vertices; the list as it grows.
  constexpr int64_t kBytesAPixel = 36, kRaysBytesAPixel = 24, kBytesAVertex = 48,
                    kBytesATriangle = 36, kPixelBytes = 4;
  int64_t largest = 0, pixels = 0;
  for (const UsedPhoto& photo : photos) {
    largest = std::max(largest, PixelCount(photo));
    pixels += PixelCount(photo);
  }
  const int64_t one = (kBytesAPixel + kRaysBytesAPixel) * largest +
                      kBytesAVertex * static_cast<int64_t>(mesh.vertices.size()) +
                      kBytesATriangle * static_cast<int64_t>(mesh.triangles.size());
  memory.Require(one, "looking at the photographs", kCure);
  const int64_t left = memory.BytesLeft();
  MemoryPlan plan;
  plan.rays_bytes = (left - one) / 4;
  plan.holds_pixels = kPixelBytes * pixels <= (left - one) / 2;
  const int64_t held = plan.rays_bytes + (plan.holds_pixels ? kPixelBytes * pixels : 0);
  plan.at_once = std::max<int64_t>(1, (left - held) / one);
  if (plan.at_once >= ThreadCount()) plan.at_once = static_cast<int64_t>(photos.size());
  return plan;
}

}  // namespace

std::vector<UsedPhoto> FindUsedPhotos(const Capture& capture, const CalibResult& calib) {
  std::map<std::string, const Photo*> photo_of_id;
  for (const Photo& photo : capture.photos) photo_of_id[photo.id] = &photo;
  std::vector<UsedPhoto> used;
  for (const PosedImage& posed : calib.photos) {
    const std::string who = "photograph " + posed.id;
    const auto photo = photo_of_id.find(posed.id);
    if (photo == photo_of_id.end()) {
      throw Error(who + ": has a pose but is not in the capture; run lfm-calib again");
    }
    if (photo->second->split != PhotoSplit::kTrain) continue;
    const auto camera = calib.cameras.find(posed.camera);
    if (camera == calib.cameras.end()) {
      throw Error(who + ": camera " + posed.camera + " has no intrinsics; run lfm-calib again");
    }
    ValidateCamera(camera->second, who.c_str());
    const Pose& pose = posed.camera_from_world;
    if (!pose.rotation.allFinite() || !pose.translation.allFinite()) {
      throw Error(who + ": its pose is not finite; run lfm-calib again");
    }
    used.push_back(
        {posed.id, photo->second->file, photo->second->mask, posed.camera, camera->second, pose});
  }
  if (used.empty()) {
    throw Error("no train photograph has a pose: nothing to resample; see calib/poses.json");
  }
  if (used.size() > 65535) throw Error("more than 65535 photographs; mark some of them as test");
  return used;
}

SeenPhotos LookAtPhotos(const std::vector<UsedPhoto>& photos, const PhotoLook& look,
                        const ImageLoader& load_image, const MemoryLimit& memory,
                        Progress& progress) {
  progress.Start("looking at photographs", static_cast<int64_t>(photos.size()));
  const MemoryPlan plan = PlanMemory(photos, look.mesh, memory);
  const CameraRays rays = RaysOfCameras(photos, plan.rays_bytes);
  SeenPhotos seen{std::vector<PhotoPixels>(photos.size()), {look.result, photos.size()}, {}};
  std::optional<ScratchFile> pixels;
  if (!plan.holds_pixels) pixels.emplace(look.result);
  std::vector<uint64_t> offsets(photos.size());
  const auto look_at = [&](int64_t i) {
    const auto p = static_cast<size_t>(i);
    PhotoPixels& photo = seen.photos[p];
    photo = LookAtPhoto(photos[p], look, rays, load_image, p, seen.lists);
    if (pixels) {
      offsets[p] = pixels->Append(photo.rgbu.data(), photo.rgbu.size());
      photo.rgbu = {};
    }
    progress.Advance();
  };
  const auto count = static_cast<int64_t>(photos.size());
  for (int64_t begin = 0; begin < count; begin += plan.at_once) {
    ParallelFor(begin, std::min(count, begin + plan.at_once), look_at);
  }
  if (!pixels) return seen;
  seen.file = pixels->Map();
  for (size_t p = 0; p < photos.size(); ++p) {
    seen.photos[p].in_file =
        reinterpret_cast<const uint8_t*>(seen.file.bytes().data()) + offsets[p];
  }
  return seen;
}

}  // namespace lfm
