// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/pixel_footprint.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "mesh/surface_distance.h"

namespace lfm {
namespace {

constexpr int64_t kSamples = 500;
// Off the surface, as a share of the distance to the eye, so that a ray does not end where it
// began.
constexpr double kClearance = 1e-3;

std::vector<double> SeenFootprints(const PosedImage& photo, const Camera& camera,
                                   const SurfaceSamples& samples, const RayScene& scene) {
  std::vector<double> footprints;
  const Eigen::Vector3d eye = photo.camera_from_world.Center();
  for (size_t i = 0; i < samples.points.size(); ++i) {
    const Eigen::Vector3d to_eye = eye - samples.points[i];
    if (to_eye.dot(samples.normals[i]) <= 0) continue;
    const Eigen::Vector3d in_camera = photo.camera_from_world * samples.points[i];
    const auto pixel = Project(camera, in_camera);
    if (!pixel || !camera.Contains(*pixel)) continue;
    if (scene.Occluded(samples.points[i], to_eye, kClearance, 1)) continue;
    footprints.push_back(in_camera.z() / std::sqrt(camera.fx * camera.fy));
  }
  return footprints;
}

}  // namespace

double MedianPixelFootprint(const TriangleMesh& surface, const RayScene& scene,
                            const CalibResult& calib) {
  std::vector<const PosedImage*> photos;
  for (const PosedImage& photo : calib.photos) {
    if (photo.split == PhotoSplit::kTrain) photos.push_back(&photo);
  }
  if (photos.empty()) {
    throw Error(
        "mesh: there is no calibrated photograph for training to measure a pixel's size by; check "
        "the splits in capture.json, and calib/poses.json for what was set aside");
  }
  const SurfaceSamples samples = SampleSurface(surface, kSamples, 4);
  std::vector<std::vector<double>> of_photos(photos.size());
  ParallelFor(0, static_cast<int64_t>(photos.size()), [&](int64_t i) {
    const auto camera = calib.cameras.find(photos[i]->camera);
    if (camera == calib.cameras.end()) {
      throw Error("mesh: photograph '" + photos[i]->id + "' names the unknown camera '" +
                  photos[i]->camera + "'");
    }
    of_photos[i] = SeenFootprints(*photos[i], camera->second, samples, scene);
  });
  std::vector<double> all;
  for (const auto& footprints : of_photos) {
    all.insert(all.end(), footprints.begin(), footprints.end());
  }
  if (all.empty()) {
    throw Error(
        "mesh: no photograph sees the reconstructed object; do scans and photographs "
        "share one platform?");
  }
  std::nth_element(all.begin(), all.begin() + all.size() / 2, all.end());
  return all[all.size() / 2];
}

}  // namespace lfm
