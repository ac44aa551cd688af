// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "sample_data/coat_shading.h"
#include "sample_data/random.h"
#include "sample_data/traced_photo.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

class BakedSource : public PhotoSource {
 public:
  BakedSource(const StudioScene& scene, const Subject& subject, const SetReflectance& reflectance,
              const BakeOptions& options, Progress& progress)
      : scene_(scene),
        reflectance_(reflectance),
        lighting_(MakeStudioLighting()),
        light_(BakeLight(scene, subject, lighting_, reflectance, options, progress)),
        shading_(subject, lighting_, light_) {}

  RenderedPhoto Render(const PixelRays& rays, const Pose& camera_from_world) const override {
    return RenderPhoto(scene_, shading_, reflectance_, rays, camera_from_world);
  }
  const Lighting& lighting() const override { return lighting_; }
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
  std::string Costs() const override { return ""; }

 private:
  const StudioScene& scene_;
  const SetReflectance& reflectance_;
  Lighting lighting_;
  BakedLight light_;
  CoatShading shading_;
};

class TracedSource : public PhotoSource {
 public:
  TracedSource(const SceneDescription& scene, std::vector<Patch> patches,
               const SetReflectance& reflectance, int samples, uint64_t seed)
      : lights_(scene.lights),
        traced_(scene.objects, std::move(patches), &reflectance),
        tracer_(traced_, scene.lights, scene.bounces),
        samples_(samples),
        seed_(seed),
        brightest_paper_(MeasurePaper()) {
    if (!(brightest_paper_ > 0)) {
      throw Error("scene '" + scene.name + "': no light falls on the plate; give it lights");
    }
  }

  RenderedPhoto Render(const PixelRays& rays, const Pose& camera_from_world) const override {
    TraceOptions options;
    options.samples_per_pixel = samples_;
    options.seed = seed_;
    // Pictures from different places have random numbers of their own.
    const Eigen::Vector3d center = camera_from_world.Center();
    for (int c = 0; c < 3; ++c) {
      options.picture = ScrambleBits(options.picture ^ std::bit_cast<uint64_t>(center[c]));
    }
    TracedPhoto photo = TracePhoto(tracer_, rays, camera_from_world, options);
    double squared_error = 0;
    const float* error = photo.standard_error.Data<float>();
    for (size_t i = 0; i < photo.standard_error.size(); ++i) squared_error += error[i] * error[i];
    const std::scoped_lock lock(mutex_);
    rays_ += photo.rays;
    values_ += static_cast<double>(photo.standard_error.size());
    squared_error_ += squared_error;
    return {std::move(photo.radiance), std::move(photo.mask)};
  }
  const Lighting& lighting() const override { return lights_.studio; }
  double BrightestPaper() const override { return brightest_paper_; }
  std::string Costs() const override {
    const std::scoped_lock lock(mutex_);
    if (values_ == 0) return "";
    char text[160];
    std::snprintf(text, sizeof(text),
                  "traced %.0f million rays; Monte Carlo error %.5f RMS of white paper's radiance",
                  static_cast<double>(rays_.Total()) * 1e-6,
                  std::sqrt(squared_error_ / values_) / brightest_paper_);
    return text;
  }

 private:
  // Looks straight down at the plate.
  double MeasurePaper() const {
    constexpr int kPointsAcross = 33, kSamples = 64;
    constexpr float kHalfSideMm = 105, kAboveMm = 0.2f;
    std::vector<float> radiance(kPointsAcross * kPointsAcross);
    ParallelFor(0, static_cast<int64_t>(radiance.size()), [&](int64_t i) {
      const auto place = [&](int64_t k) {
        return kHalfSideMm * (2 * static_cast<float>(k) / (kPointsAcross - 1) - 1);
      };
      const V3f origin(place(i % kPointsAcross), place(i / kPointsAcross), kAboveMm);
      radiance[i] =
          tracer_.TraceRadiance(origin, -V3f::UnitZ(), kSamples, seed_, static_cast<uint64_t>(i))
              .maxCoeff();
    });
    // Not the very brightest, which is the luckiest too.
    std::sort(radiance.begin(), radiance.end());
    return radiance[radiance.size() * 98 / 100];
  }

  SceneLights lights_;
  TracedScene traced_;
  PathTracer tracer_;
  int samples_;
  uint64_t seed_;
  double brightest_paper_;
  mutable std::mutex mutex_;
  mutable RayCounts rays_;
  mutable double values_ = 0, squared_error_ = 0;
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
                                              uint64_t seed) {
  return std::make_unique<TracedSource>(scene, std::move(patches), reflectance, samples, seed);
}

}  // namespace lfm
