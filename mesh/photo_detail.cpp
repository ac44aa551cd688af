// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/photo_detail.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr double kMostDetail = 8;
constexpr double kLeastCosine = 0.3;
constexpr double kClearance = 1e-3;

double GradientAt(const Image& image, const Eigen::Vector2d& pixel) {
  const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 1, image.width() - 2);
  const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 1, image.height() - 2);
  const int channels = image.channels(), green = channels >= 3 ? 1 : 0;
  const uint8_t* data = image.Data<uint8_t>();
  const auto at = [&](int u, int v) -> double {
    return data[(static_cast<size_t>(v) * image.width() + u) * channels + green];
  };
  return 0.5 * std::hypot(at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
}

Image LoadPhoto(const PosedImage& photo, const Camera& camera, const ImageLoader& load_image) {
  const Image picture = load_image(photo.file);
  if (picture.width() != camera.width || picture.height() != camera.height ||
      std::min(picture.width(), picture.height()) < 3) {
    throw Error(photo.file + ": its size is not its camera's; do not crop or scale photographs");
  }
  return picture.type() == PixelType::kUint8 ? picture : ToSrgb8(picture);
}

}  // namespace

std::vector<double> MeasurePhotoDetail(const TriangleMesh& surface, const RayScene& scene,
                                       const CalibResult& calib, const ImageLoader& load_image,
                                       Progress& progress) {
  const std::vector<Eigen::Vector3d> normals = ComputeVertexNormals(surface);
  std::vector<double> detail(surface.vertices.size(), 0);
  std::vector<int> seen(surface.vertices.size(), 0);
  progress.Start("looking for detail in photographs", static_cast<int64_t>(calib.photos.size()));
  for (const PosedImage& photo : calib.photos) {
    progress.Advance();
    if (photo.split != PhotoSplit::kTrain) continue;
    const auto camera = calib.cameras.find(photo.camera);
    if (camera == calib.cameras.end()) {
      throw Error("mesh: photograph '" + photo.id + "' names the unknown camera '" + photo.camera +
                  "'");
    }
    const Image picture = LoadPhoto(photo, camera->second, load_image);
    const Eigen::Vector3d eye = photo.camera_from_world.Center();
    ParallelFor(
        0, static_cast<int64_t>(detail.size()),
        [&](int64_t v) {
          const Eigen::Vector3d& point = surface.vertices[v];
          const Eigen::Vector3d to_eye = eye - point;
          if (to_eye.dot(normals[v]) < kLeastCosine * to_eye.norm()) return;
          const auto pixel = Project(camera->second, photo.camera_from_world * point);
          if (!pixel || !camera->second.Contains(*pixel)) return;
          if (scene.Occluded(point, to_eye, kClearance, 1)) return;
          detail[v] += GradientAt(picture, *pixel);
          ++seen[v];
        },
        256);
  }
  std::vector<double> known;
  for (size_t v = 0; v < detail.size(); ++v) {
    if (seen[v] == 0) continue;
    detail[v] /= seen[v];
    known.push_back(detail[v]);
  }
  if (known.empty()) return std::vector<double>(detail.size(), 1);
  std::nth_element(known.begin(), known.begin() + known.size() / 2, known.end());
  const double median = known[known.size() / 2];
  for (size_t v = 0; v < detail.size(); ++v) {
    detail[v] = seen[v] > 0 && median > 0 ? std::min(detail[v] / median, kMostDetail) : 1;
  }
  return detail;
}

}  // namespace lfm
