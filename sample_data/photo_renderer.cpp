// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_renderer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kFar = 1e5f;
constexpr float kDepthStepMm = 1.5f;
constexpr int kPixelsAtOnce = 16 / kCoarseSamples;

struct Sample {
  SurfaceHit hit;
  V3f point = V3f::Zero();
  V3f direction = V3f::Zero();  // not unit
  V3f albedo = V3f::Zero();     // of a patch
};

class PhotoTracer {
 public:
  PhotoTracer(const StudioScene& scene, const CoatShading& shading,
              const SetReflectance& reflectance, const PixelRays& rays,
              const Pose& camera_from_world)
      : scene_(scene),
        shading_(shading),
        reflectance_(reflectance),
        rays_(rays),
        world_from_camera_(camera_from_world.rotation.transpose().cast<float>()),
        eye_(camera_from_world.Center().cast<float>()) {}

  // Returns how many rays it traced.
  int64_t RenderRow(int y, RenderedPhoto& photo) const {
    int64_t traced = 0;
    const int width = rays_.camera().width;
    float* out = &photo.radiance.At<float>(0, y);
    uint8_t* mask = &photo.mask.At<uint8_t>(0, y);
    for (int x0 = 0; x0 < width; x0 += kPixelsAtOnce) {
      const int count = std::min(kPixelsAtOnce, width - x0);
      RayPacket packet;
      for (int lane = 0; lane < count * kCoarseSamples; ++lane) {
        const float* offset = kCoarsePattern[lane % kCoarseSamples];
        Aim(packet, lane, x0 + lane / kCoarseSamples, y, offset[0], offset[1]);
      }
      scene_.Intersect(packet, RayOrder::kCoherent);
      traced += count * kCoarseSamples;
      for (int i = 0; i < count; ++i) {
        Sample samples[kCoarseSamples];
        for (int s = 0; s < kCoarseSamples; ++s) {
          samples[s] = Resolve(packet, i * kCoarseSamples + s);
        }
        V3f radiance;
        if (IsSimple(samples)) {
          radiance = ShadeSimple(samples);
          mask[x0 + i] = samples[0].hit.triangle >= 0 ? 255 : 0;
        } else {
          radiance = ShadeFine(x0 + i, y);
          mask[x0 + i] = CenterIsObject(x0 + i, y) ? 255 : 0;
          traced += kFineSamples + 1;
        }
        std::copy(radiance.data(), radiance.data() + 3, out + 3 * (x0 + i));
      }
    }
    return traced;
  }

 private:
  void Aim(RayPacket& packet, int lane, int x, int y, float dx, float dy) const {
    packet.Set(lane, eye_, world_from_camera_ * rays_.Direction(x, y, dx, dy), 0, kFar);
  }

  Sample Resolve(const RayPacket& packet, int lane) const {
    Sample s;
    s.hit = StudioScene::Hit(packet, lane);
    const RTCRay16& ray = packet.rays.ray;
    s.direction = {ray.dir_x[lane], ray.dir_y[lane], ray.dir_z[lane]};
    s.point = eye_ + s.hit.distance * s.direction;
    if (s.hit.patch >= 0) {
      const Patch& patch = scene_.patches()[s.hit.patch];
      // The table's grain is coarse: one look a pixel is enough.
      if (patch.material != PatchMaterial::kTable) s.albedo = reflectance_.Color(patch, s.point);
    }
    return s;
  }

  static bool IsSimple(const Sample* samples) {
    const Sample& first = samples[0];
    float near = first.hit.distance, far = near;
    for (int s = 1; s < kCoarseSamples; ++s) {
      const Sample& other = samples[s];
      if ((other.hit.triangle >= 0) != (first.hit.triangle >= 0)) return false;
      if (other.hit.patch != first.hit.patch || other.albedo != first.albedo) return false;
      near = std::min(near, other.hit.distance);
      far = std::max(far, other.hit.distance);
    }
    return first.hit.triangle < 0 || far - near < kDepthStepMm;
  }

  V3f ShadePatch(const Sample& s) const {
    const Patch& patch = scene_.patches()[s.hit.patch];
    const Eigen::Vector3d d = s.point.cast<double>() - patch.origin;
    const V3f albedo =
        patch.material == PatchMaterial::kTable ? reflectance_.Color(patch, s.point) : s.albedo;
    return (albedo / std::numbers::pi_v<float>)
        .cwiseProduct(
            shading_.light.patches[s.hit.patch].Sample(patch, d.dot(patch.u), d.dot(patch.v)));
  }

  V3f ShadeCoat(const Sample& s) const {
    return CoatRadiance(shading_, s.hit, s.point, -s.direction.normalized());
  }

  V3f Shade(const Sample& s) const {
    if (s.hit.triangle >= 0) return BaseRadiance(shading_, s.hit) + ShadeCoat(s);
    if (s.hit.patch >= 0) return ShadePatch(s);
    return shading_.lighting.Environment(s.direction.normalized());
  }

  V3f ShadeSimple(const Sample* samples) const {
    if (samples[0].hit.triangle < 0) {
      // Light on the set changes slowly: two opposite samples have the pixel's mean.
      return 0.5f * (Shade(samples[0]) + Shade(samples[3]));
    }
    V3f base = V3f::Zero();
    for (int s = 0; s < kCoarseSamples; ++s) base += BaseRadiance(shading_, samples[s].hit);
    return base / kCoarseSamples + 0.5f * (ShadeCoat(samples[0]) + ShadeCoat(samples[3]));
  }

  V3f ShadeFine(int x, int y) const {
    RayPacket packet;
    for (int s = 0; s < kFineSamples; ++s) {
      Aim(packet, s, x, y, kFinePattern[s][0], kFinePattern[s][1]);
    }
    scene_.Intersect(packet, RayOrder::kCoherent);
    V3f sum = V3f::Zero();
    for (int s = 0; s < kFineSamples; ++s) sum += Shade(Resolve(packet, s));
    return sum / kFineSamples;
  }

  bool CenterIsObject(int x, int y) const {
    RayPacket packet;
    Aim(packet, 0, x, y, 0, 0);
    scene_.Intersect(packet, RayOrder::kCoherent);
    return StudioScene::Hit(packet, 0).triangle >= 0;
  }

  const StudioScene& scene_;
  const CoatShading& shading_;
  const SetReflectance& reflectance_;
  const PixelRays& rays_;
  Eigen::Matrix3f world_from_camera_;
  V3f eye_;
};

}  // namespace

RenderedPhoto RenderPhoto(const StudioScene& scene, const CoatShading& shading,
                          const SetReflectance& reflectance, const PixelRays& rays,
                          const Pose& camera_from_world) {
  const Camera& camera = rays.camera();
  RenderedPhoto photo;
  photo.radiance =
      Image(camera.width, camera.height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  photo.mask = Image(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  const PhotoTracer tracer(scene, shading, reflectance, rays, camera_from_world);
  std::vector<int64_t> traced(static_cast<size_t>(camera.height));
  ParallelFor(
      0, camera.height,
      [&](int64_t y) { traced[y] = tracer.RenderRow(static_cast<int>(y), photo); }, 4);
  for (const int64_t count : traced) photo.rays.camera += count;
  return photo;
}

}  // namespace lfm
