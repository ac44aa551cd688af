// SPDX-License-Identifier: BSD-3-Clause
#include "resample/used_photos.h"

#include <cmath>
#include <limits>
#include <map>

#include "core/error.h"
#include "core/parallel.h"
#include "core/pixel_directions.h"
#include "resample/photo_depth.h"

namespace lfm {
namespace {

/// Lenses are undone once a camera, not once a photograph.
std::map<std::string, std::vector<Eigen::Vector3d>> RaysOfCameras(
    const std::vector<UsedPhoto>& photos) {
  std::map<std::string, std::vector<Eigen::Vector3d>> rays;
  for (const UsedPhoto& photo : photos) {
    if (!rays.contains(photo.camera_name)) {
      rays[photo.camera_name] = PixelDirections(photo.camera);
    }
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

std::vector<SeenPhoto> LookAtPhotos(const std::vector<UsedPhoto>& photos,
                                    const TriangleMesh& surface, const RayScene& surface_scene,
                                    const TriangleMesh& mesh,
                                    const std::vector<double>& deviations_mm,
                                    const ImageLoader& load_image, const ResampleOptions& options,
                                    Progress& progress) {
  progress.Start("looking at photographs", static_cast<int64_t>(photos.size()));
  const std::map<std::string, std::vector<Eigen::Vector3d>> rays = RaysOfCameras(photos);
  std::vector<SeenPhoto> seen(photos.size());
  ParallelFor(0, static_cast<int64_t>(photos.size()), [&](int64_t p) {
    const UsedPhoto& photo = photos[static_cast<size_t>(p)];
    const Image picture = load_image(photo.file);
    PhotoSight sight{photo.camera, photo.camera_from_world, {}, {}};
    sight.depth = RenderDepth(surface, surface_scene, photo.camera, rays.at(photo.camera_name),
                              photo.camera_from_world);
    sight.usable = FindUsablePixels(sight.depth, photo.camera, options.depth_margin_px);
    ForbidWhatIsNoNumber(picture, sight.usable);
    if (!photo.mask.empty()) {
      ApplyMask(load_image(photo.mask), photo.mask, photo.camera, sight.usable);
    }
    SeenPhoto& result = seen[static_cast<size_t>(p)];
    result.triangles = FindVisibleTriangles(
        mesh, deviations_mm, sight,
        {options.max_grazing_deg, options.min_data_share, options.max_hidden_share});
    result.pixels = MakePhotoPixels(picture, sight.usable, photo.camera, photo.file);
    progress.Advance();
  });
  return seen;
}

}  // namespace lfm
