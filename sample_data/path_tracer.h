// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sample_data/environment_light.h"
#include "sample_data/lanes/path_kernels.h"
#include "sample_data/sample_sequence.h"
#include "sample_data/scene_description.h"
#include "sample_data/traced_scene.h"

namespace lfm {

/// How many rays were traced.
struct RayCounts {
  int64_t camera = 0;  ///< from the eye
  int64_t bounce = 0;  ///< from surface to surface
  int64_t shadow = 0;  ///< only asked whether something is in the way

  int64_t Total() const { return camera + bounce + shadow; }
  RayCounts& operator+=(const RayCounts& other);
};

/// Sixteen rays that only ask whether something is in their way.
struct alignas(64) ShadowPacket {
  RTCRay16 rays;
  alignas(64) int valid[16];
};

/// Every packet of a tracer as it was handed to Embree, for measuring Embree alone on the same
/// rays.
struct RayLog {
  std::vector<RayPacket> camera, bounce;
  std::vector<ShadowPacket> near_shadow;  ///< of first hits, towards one light a packet
  std::vector<ShadowPacket> far_shadow;   ///< of everything later
};

/// One ray to find the radiance of. `direction` is unit length.
struct PathRay {
  Eigen::Vector3f origin, direction;
  PathKey key;
};

/// A path tracer: unbiased estimates of the radiance that arrives along rays, by one path each.
///
/// At every surface that is not a delta lobe one point of each lamp, one direction of the
/// environment map and every directional light are asked (beyond the first surface: one lamp and
/// one directional light, drawn at random); the other strategy is the BSDF's own samples; both
/// are weighed by the power heuristic (Veach and Guibas 1995). The room of Lighting is found by
/// BSDF samples alone.
///
/// `bounces` counts scatterings after the first surface; 0 is direct light only. What a glass or a
/// perfect mirror does is not counted, so direct light is also what is seen through or in them.
/// Glass blocks shadow rays: light behind it is found by the paths that go through, and
/// directional light, which no path can find, casts full shadows there. Absorption (Beer-Lambert)
/// acts between the surfaces that a ray inside glass meets. From the eighth surface on paths
/// survive by Russian roulette; all end at the thirty-second.
///
/// Lamps are seen by every ray, camera rays too, and stand in no ray's way.
class PathTracer {
 public:
  /// The scene must outlive the tracer. `indirect_limit` is the most radiance that one path may
  /// bring over two surfaces or more (with a counted bounce among them): a finite one cuts off what
  /// few paths find by luck, caustics above all, and darkens the picture by what it cuts; all other
  /// light is unbiased. Throws Error for an unusable environment map, for a directional light whose
  /// direction is not unit length, for `bounces` outside [0, 64] and a limit that is not positive.
  PathTracer(const TracedScene& scene, const SceneLights& lights, int bounces,
             float indirect_limit = std::numeric_limits<float>::infinity());

  const TracedScene& scene() const { return scene_; }
  const LightTables& lights() const { return lights_; }
  int bounces() const { return bounces_; }
  float indirect_limit() const { return indirect_limit_; }

  /// Traces a batch (about a thousand rays is good; neighbours should be near each other) and sets
  /// radiance[k] to ray k's estimate. A ray's estimate does not depend on the rest of the batch.
  ///
  /// `kernels` says which of UsablePathKernels to run; all give the same bits. Null: the fastest.
  RayCounts Trace(std::span<const PathRay> rays, std::span<Eigen::Vector3f> radiance,
                  RayLog* log = nullptr, const PathKernels* kernels = nullptr) const;

  /// The mean of `samples` paths along one ray (unit `direction`); numbers depend on (seed,
  /// stream).
  Eigen::Vector3f TraceRadiance(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                                int samples, uint64_t seed, uint64_t stream) const;

 private:
  const TracedScene& scene_;
  EnvironmentLight environment_;
  std::vector<float> lamps_, directional_;  // as LightTables has them
  LightTables lights_;
  int bounces_;
  float indirect_limit_;
};

}  // namespace lfm
