// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_renderer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "sample_data/print_sampler.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kFar = 1e5f;
constexpr float kDepthStepMm = 1.5f;
constexpr int kPixelsAtOnce = 16 / kCoarseSamples;

// What the coarse samples of a pixel met.
struct Look {
  static constexpr int kSeveral = -3, kObject = -2;
  int surface = kSeveral;    // kSeveral, kObject, -1 for the room, or a patch
  V3f albedo = V3f::Zero();  // that a patch's pixel was shaded with: 1 where its print varies

  bool Varies() const { return albedo.x() == 1; }
};

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
        print_(reflectance, rays, camera_from_world),
        rays_(rays),
        world_from_camera_(camera_from_world.rotation.transpose().cast<float>()),
        eye_(camera_from_world.Center().cast<float>()) {}

  // Both passes return how many rays they traced. This one shades the pixels that show one thing.
  int64_t RenderRow(int y, RenderedPhoto& photo, Look* looks) const {
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
        if (!IsSimple(samples)) continue;
        const bool object = samples[0].hit.triangle >= 0;
        if (Varies(samples)) samples[0].albedo = samples[3].albedo = V3f::Ones();
        looks[x0 + i] = {object ? Look::kObject : samples[0].hit.patch, samples[0].albedo};
        mask[x0 + i] = object ? 255 : 0;
        const V3f radiance = ShadeSimple(samples);
        std::copy(radiance.data(), radiance.data() + 3, out + 3 * (x0 + i));
      }
    }
    return traced;
  }

  // Looks closer where a pixel shows several things, or another one than a neighbour: coarse
  // samples miss what crosses a pixel's rim only, and would leave pixels that are too small.
  int64_t RefineRow(int y, const std::vector<Look>& looks, RenderedPhoto& photo) const {
    int64_t traced = 0;
    const Camera& camera = rays_.camera();
    const auto look = [&](int column, int row) -> const Look& {
      return looks[static_cast<size_t>(row) * camera.width + column];
    };
    for (int x = 0; x < camera.width; ++x) {
      const Look& here = look(x, y);
      bool several = here.surface == Look::kSeveral, edge = here.Varies();
      for (int row = std::max(0, y - 1); row <= std::min(camera.height - 1, y + 1); ++row) {
        for (int column = std::max(0, x - 1); column <= std::min(camera.width - 1, x + 1);
             ++column) {
          several |= look(column, row).surface != here.surface;
          edge |= look(column, row).albedo != here.albedo;
        }
      }
      Eigen::Map<V3f> radiance(&photo.radiance.At<float>(0, y) + 3 * x);
      if (several) {
        radiance = ShadeFine(x, y);
        photo.mask.At<uint8_t>(x, y) = CenterIsObject(x, y) ? 255 : 0;
        traced += kFineSamples + 1;
      } else if (edge) {
        const V3f mean = print_.PixelColor(scene_.patches()[here.surface], x, y);
        radiance = radiance.cwiseQuotient(here.albedo).cwiseProduct(mean);
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
      if (other.hit.patch != first.hit.patch) return false;
      near = std::min(near, other.hit.distance);
      far = std::max(far, other.hit.distance);
    }
    return first.hit.triangle < 0 || far - near < kDepthStepMm;
  }

  static bool Varies(const Sample* samples) {
    return std::any_of(samples + 1, samples + kCoarseSamples,
                       [&](const Sample& s) { return s.albedo != samples[0].albedo; });
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
    for (int s = 0; s < kFineSamples; ++s) {
      Sample sample = Resolve(packet, s);
      const int patch = sample.hit.patch;
      if (patch >= 0 && scene_.patches()[patch].material == PatchMaterial::kPrint) {
        sample.albedo = print_.CellColor(scene_.patches()[patch], x, y, s);
      }
      sum += Shade(sample);
    }
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
  PrintSampler print_;
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
  std::vector<Look> looks(static_cast<size_t>(camera.width) * camera.height);
  constexpr int kRowsAtOnce = 4;
  ParallelFor(
      0, camera.height,
      [&](int64_t y) {
        traced[y] = tracer.RenderRow(static_cast<int>(y), photo, &looks[y * camera.width]);
      },
      kRowsAtOnce);
  ParallelFor(
      0, camera.height,
      [&](int64_t y) { traced[y] += tracer.RefineRow(static_cast<int>(y), looks, photo); },
      kRowsAtOnce);
  for (const int64_t count : traced) photo.rays.camera += count;
  return photo;
}

}  // namespace lfm
