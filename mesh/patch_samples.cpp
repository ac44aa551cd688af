// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/patch_samples.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/patch_sizes.h"

namespace lfm {
namespace {

constexpr double kSamplesAPixel = 2.0 / 3.0;
constexpr double kLeastCosine = 0.1736;  // of 80 degrees
constexpr int kMostEdgeSamples = 49;
// Off the surface, as a share of the distance to the eye: about a millimetre, more than a decimated
// triangle lies below its surface.
constexpr double kClearance = 3e-3;

struct PosedCamera {
  const Camera* camera;
  Pose camera_from_world;
};

std::vector<PosedCamera> TrainCameras(const CalibResult& calib) {
  std::vector<PosedCamera> cameras;
  for (const PosedImage& photo : calib.photos) {
    if (photo.split != PhotoSplit::kTrain) continue;
    const auto camera = calib.cameras.find(photo.camera);
    if (camera == calib.cameras.end()) {
      throw Error("mesh: photograph '" + photo.id + "' names the unknown camera '" + photo.camera +
                  "'");
    }
    cameras.push_back({&camera->second, photo.camera_from_world});
  }
  return cameras;
}

// Pixels that a photograph shows of a triangle; 0 when it does not show it whole.
double SeenPixels(const PosedCamera& photo, const std::array<Eigen::Vector3d, 3>& corners,
                  const RayScene& surface) {
  const Eigen::Vector3d eye = photo.camera_from_world.Center();
  const Eigen::Vector3d middle = (corners[0] + corners[1] + corners[2]) / 3;
  const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const Eigen::Vector3d to_eye = eye - middle;
  if (!(normal.dot(to_eye) > kLeastCosine * normal.norm() * to_eye.norm())) return 0;
  std::array<Eigen::Vector2d, 3> pixels;
  for (int k = 0; k < 3; ++k) {
    const auto pixel = Project(*photo.camera, photo.camera_from_world * corners[k]);
    if (!pixel || !photo.camera->Contains(*pixel)) return 0;
    pixels[k] = *pixel;
  }
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d from = k < 3 ? (0.8 * corners[k] + 0.2 * middle).eval() : middle;
    if (surface.Occluded(from, eye - from, kClearance, 1)) return 0;
  }
  const Eigen::Vector2d a = pixels[1] - pixels[0], b = pixels[2] - pixels[0];
  return 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
}

}  // namespace

int PatchSamples(double largest_px) {
  return PatchSampleCount(ChooseEdgeSamples(kSamplesAPixel * largest_px, kMostEdgeSamples));
}

double PredictSamplesPerTriangle(const TriangleMesh& mesh, const RayScene& surface,
                                 const CalibResult& calib) {
  if (mesh.triangles.empty()) return 0;
  const std::vector<PosedCamera> photos = TrainCameras(calib);
  std::vector<int> samples(mesh.triangles.size());
  ParallelFor(
      0, static_cast<int64_t>(samples.size()),
      [&](int64_t t) {
        std::array<Eigen::Vector3d, 3> corners;
        for (int k = 0; k < 3; ++k) corners[k] = mesh.vertices[mesh.triangles[t][k]];
        double largest = 0;
        for (const PosedCamera& photo : photos) {
          largest = std::max(largest, SeenPixels(photo, corners, surface));
        }
        samples[t] = PatchSamples(largest);
      },
      64);
  int64_t sum = 0;
  for (const int s : samples) sum += s;
  return static_cast<double>(sum) / static_cast<double>(samples.size());
}

}  // namespace lfm
