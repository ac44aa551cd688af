// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/transport_preview.h"

#include <cmath>

#include "core/parallel.h"
#include "sample_data/sensor.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr int kSide = 2, kRays = kSide * kSide;  // a pixel
constexpr float kBackground = 0.25f, kFar = 1e9f;

}  // namespace

std::vector<float> PreviewLight(const CubeMap& cube) {
  std::vector<float> light;
  const V3f window = V3f(-0.5f, -0.5f, 0.7f).normalized();
  for (int t = 0; t < cube.Texels(); ++t) {
    const float cosine = cube.Direction(t).dot(window);
    light.push_back(0.25f + 3.5f * std::exp(12 * (cosine - 1)));
  }
  return light;
}

Image PreviewMesh(const TracedScene& scene, const FixedView& view, std::span<const V3f> radiance) {
  const Camera camera = FixedCamera(view);
  const Pose pose = FixedPose(view);
  const V3f eye = pose.Center().cast<float>();
  const Eigen::Matrix3d world_from_camera = pose.rotation.transpose();
  std::vector<size_t> first_vertex;
  size_t vertices = 0;
  for (const SceneObject& object : scene.objects()) {
    first_vertex.push_back(vertices);
    vertices += object.mesh.vertices.size();
  }
  Image picture(camera.width, camera.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  ParallelFor(0, camera.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < camera.width; ++x) {
      RayPacket packet;
      for (int i = 0; i < kRays; ++i) {
        const double px = x + (i % kSide + 0.5) / kSide - 0.5;
        const double py = y + (i / kSide + 0.5) / kSide - 0.5;
        const Eigen::Vector3d direction =
            world_from_camera *
            Eigen::Vector3d((px - camera.cx) / camera.fx, (py - camera.cy) / camera.fy, 1);
        packet.Set(i, eye, direction.normalized().cast<float>(), 0, kFar);
      }
      scene.Intersect(packet, RayOrder::kCoherent);
      V3f sum = V3f::Zero();
      for (int i = 0; i < kRays; ++i) {
        const RTCHit16& hit = packet.rays.hit;
        if (!scene.IsObject(hit.geomID[i])) {
          sum += V3f::Constant(kBackground);
          continue;
        }
        const V3f* values = &radiance[first_vertex[hit.geomID[i]]];
        const Eigen::Vector3i& t = scene.objects()[hit.geomID[i]].mesh.triangles[hit.primID[i]];
        sum += (1 - hit.u[i] - hit.v[i]) * values[t[0]] + hit.u[i] * values[t[1]] +
               hit.v[i] * values[t[2]];
      }
      for (int c = 0; c < 3; ++c) picture.At<uint8_t>(x, y, c) = EncodeSrgb8(sum[c] / kRays);
    }
  });
  return picture;
}

}  // namespace lfm
