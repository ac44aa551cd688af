// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "sample_data/coat_shading.h"
#include "sample_data/occluder_shadow.h"
#include "sample_data/random.h"
#include "sample_data/traced_photo.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr uint64_t kSecondBake = 0xba4e;

class BakedSource : public PhotoSource {
 public:
  BakedSource(const StudioScene& scene, const Subject& subject, const SetReflectance& reflectance,
              const BakeOptions& options, Progress& progress)
      : scene_(scene),
        subject_(subject),
        reflectance_(reflectance),
        lighting_(MakeStudioLighting()),
        lights_(BakeTwice(options, progress)),
        light_(lights_[0]),
        shading_(subject, lighting_, lights_[0]),
        shading_again_(subject, lighting_, lights_[1]) {}

  RenderedPhoto Render(const PixelRays& rays, const Pose& camera_from_world) const override {
    return RenderPhoto(scene_, shading_, reflectance_, rays, camera_from_world);
  }
  PhotoRenderer WithOccluder(const Occluder& occluder) const override {
    struct Shadowed {
      Shadowed(const BakedSource& source, const Occluder& in_the_way)
          : occluder(in_the_way),
            light(ShadowLight(source.light_, source.scene_, source.subject_, source.lighting_,
                              in_the_way)),
            shading(source.subject_, source.lighting_, light) {}
      Occluder occluder;
      BakedLight light;
      CoatShading shading;
    };
    const auto shadowed = std::make_shared<const Shadowed>(*this, occluder);
    return [this, shadowed](const PixelRays& rays, const Pose& camera_from_world) {
      RenderedPhoto photo =
          RenderPhoto(scene_, shadowed->shading, reflectance_, rays, camera_from_world);
      CoverWithOccluder(shadowed->occluder, lighting_, rays, camera_from_world, photo);
      return photo;
    };
  }
  std::optional<RenderedPhoto> RenderAgain(const PixelRays& rays,
                                           const Pose& camera_from_world) const override {
    return RenderPhoto(scene_, shading_again_, reflectance_, rays, camera_from_world);
  }
  RayCounts LightingRays() const override {
    RayCounts rays = lights_[0].rays;
    return rays += lights_[1].rays;
  }
  double BrightestPaper() const override {
    float brightest = 0;
    for (size_t p = 0; p < light_.patches.size(); ++p) {
      if (scene_.patches()[p].material != PatchMaterial::kPrint) continue;
      for (const V3f& e : light_.patches[p].irradiance) {
        brightest = std::max(brightest, e.maxCoeff());
      }
    }
    return brightest * kPaperAlbedo / std::numbers::pi;
  }

 private:
  std::vector<BakedLight> BakeTwice(const BakeOptions& options, Progress& progress) const {
    const uint64_t seeds[] = {options.seed, ScrambleBits(options.seed ^ kSecondBake)};
    return BakeLights(scene_, subject_, lighting_, reflectance_, options, seeds, progress);
  }

  const StudioScene& scene_;
  const Subject& subject_;
  const SetReflectance& reflectance_;
  Lighting lighting_;
  std::vector<BakedLight> lights_;
  const BakedLight& light_;
  CoatShading shading_, shading_again_;
};

// Traces a photograph whose random numbers depend on the seed and the place of the eye.
RenderedPhoto TraceFrom(const PathTracer& tracer, int samples, uint64_t seed, const PixelRays& rays,
                        const Pose& camera_from_world) {
  TraceOptions options;
  options.samples_per_pixel = samples;
  options.seed = seed;
  const Eigen::Vector3d center = camera_from_world.Center();
  for (int c = 0; c < 3; ++c) {
    options.picture = ScrambleBits(options.picture ^ std::bit_cast<uint64_t>(center[c]));
  }
  TracedPhoto photo = TracePhoto(tracer, rays, camera_from_world, options);
  return {std::move(photo.radiance), std::move(photo.mask), std::move(photo.standard_error),
          photo.rays};
}

// The scene with an occluder as its last object.
class OccludedScene {
 public:
  OccludedScene(const TracedScene& scene, const SetReflectance& reflectance,
                const SceneLights& lights, int bounces, float indirect_limit,
                const Occluder& occluder)
      : occluder_(occluder),
        objects_(WithOccluderObject(scene.objects(), occluder)),
        traced_(objects_, scene.patches(), &reflectance),
        tracer_(traced_, lights, bounces, indirect_limit) {}

  RenderedPhoto Render(int samples, uint64_t seed, const PixelRays& rays,
                       const Pose& camera_from_world) const {
    RenderedPhoto photo = TraceFrom(tracer_, samples, seed, rays, camera_from_world);
    MaskOccluder(occluder_, rays, camera_from_world, photo.mask);
    return photo;
  }

 private:
  static std::vector<SceneObject> WithOccluderObject(std::vector<SceneObject> objects,
                                                     const Occluder& occluder) {
    SceneObject object;
    object.name = "occluder";
    object.mesh = OccluderMesh(occluder);
    object.material.kind = MaterialKind::kLambert;
    object.material.diffuse = occluder.albedo;
    objects.push_back(std::move(object));
    return objects;
  }

  Occluder occluder_;
  std::vector<SceneObject> objects_;
  TracedScene traced_;
  PathTracer tracer_;
};

class TracedSource : public PhotoSource {
 public:
  TracedSource(const SceneDescription& scene, std::vector<Patch> patches,
               const SetReflectance& reflectance, int samples, double indirect_limit, uint64_t seed)
      : lights_(scene.lights),
        reflectance_(reflectance),
        traced_(scene.objects, std::move(patches), &reflectance),
        samples_(samples),
        seed_(seed),
        brightest_paper_(MeasurePaper(PathTracer(traced_, scene.lights, scene.bounces))),
        indirect_limit_(LitLimit(scene.name, brightest_paper_, indirect_limit)),
        tracer_(traced_, scene.lights, scene.bounces, indirect_limit_) {}

  RenderedPhoto Render(const PixelRays& rays, const Pose& camera_from_world) const override {
    return TraceFrom(tracer_, samples_, seed_, rays, camera_from_world);
  }
  PhotoRenderer WithOccluder(const Occluder& occluder) const override {
    const auto occluded = std::make_shared<const OccludedScene>(
        traced_, reflectance_, lights_, tracer_.bounces(), indirect_limit_, occluder);
    return [this, occluded](const PixelRays& rays, const Pose& camera_from_world) {
      return occluded->Render(samples_, seed_, rays, camera_from_world);
    };
  }
  std::optional<RenderedPhoto> RenderAgain(const PixelRays&, const Pose&) const override {
    return std::nullopt;
  }
  RayCounts LightingRays() const override { return {}; }
  double BrightestPaper() const override { return brightest_paper_; }

 private:
  // The limit of indirect light in the scene's units.
  static float LitLimit(const std::string& name, double brightest_paper, double indirect_limit) {
    if (!(brightest_paper > 0)) {
      throw Error("scene '" + name + "': no light falls on the plate; give it lights");
    }
    return static_cast<float>(indirect_limit * brightest_paper);
  }

  // Looks straight down at the plate.
  double MeasurePaper(const PathTracer& tracer) const {
    constexpr int kPointsAcross = 33, kSamples = 64;
    constexpr float kHalfSideMm = 105, kAboveMm = 0.2f;
    std::vector<float> radiance(kPointsAcross * kPointsAcross);
    ParallelFor(0, static_cast<int64_t>(radiance.size()), [&](int64_t i) {
      const auto place = [&](int64_t k) {
        return kHalfSideMm * (2 * static_cast<float>(k) / (kPointsAcross - 1) - 1);
      };
      const V3f origin(place(i % kPointsAcross), place(i / kPointsAcross), kAboveMm);
      radiance[i] =
          tracer.TraceRadiance(origin, -V3f::UnitZ(), kSamples, seed_, static_cast<uint64_t>(i))
              .maxCoeff();
    });
    // Not the very brightest, which is the luckiest too.
    std::sort(radiance.begin(), radiance.end());
    return radiance[radiance.size() * 98 / 100];
  }

  SceneLights lights_;
  const SetReflectance& reflectance_;
  TracedScene traced_;
  int samples_;
  uint64_t seed_;
  double brightest_paper_;
  float indirect_limit_;
  PathTracer tracer_;
};

}  // namespace

std::unique_ptr<PhotoSource> MakeBakedSource(const StudioScene& scene, const Subject& subject,
                                             const SetReflectance& reflectance,
                                             const BakeOptions& options, Progress& progress) {
  return std::make_unique<BakedSource>(scene, subject, reflectance, options, progress);
}

std::unique_ptr<PhotoSource> MakeTracedSource(const SceneDescription& scene,
                                              std::vector<Patch> patches,
                                              const SetReflectance& reflectance, int samples,
                                              double indirect_limit, uint64_t seed) {
  return std::make_unique<TracedSource>(scene, std::move(patches), reflectance, samples,
                                        indirect_limit, seed);
}

}  // namespace lfm
