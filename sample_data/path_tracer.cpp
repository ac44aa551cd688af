// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "sample_data/bsdf.h"
#include "sample_data/microfacet.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kShort = 1 - 1e-4f;  // shadow rays end a little before their lamp
constexpr int kRouletteFrom = 8, kLongestPath = 32;
// Pairs of random numbers that a surface takes, by what for.
constexpr uint32_t kPairsPerSurface = 64;
enum Slot : uint32_t { kLobe, kDirection, kEnvironment, kChoice, kFirstLamp };

// Rays that wait for an answer, sixteen to a packet, and what each brings if its way is free.
class ShadowQueue {
 public:
  void Add(const V3f& origin, const V3f& direction, float distance, const V3f& light, int path) {
    const int lane = count_ % 16;
    if (lane == 0) {
      ShadowPacket& fresh = packets_.emplace_back();
      for (int i = 0; i < 16; ++i) {
        fresh.rays.tnear[i] = 0;
        fresh.rays.tfar[i] = 0;
        fresh.rays.time[i] = 0;
        fresh.rays.mask[i] = ~0u;
        fresh.rays.id[i] = 0;
        fresh.rays.flags[i] = 0;
        fresh.valid[i] = 0;
      }
    }
    ShadowPacket& packet = packets_.back();
    packet.rays.org_x[lane] = origin.x();
    packet.rays.org_y[lane] = origin.y();
    packet.rays.org_z[lane] = origin.z();
    packet.rays.dir_x[lane] = direction.x();
    packet.rays.dir_y[lane] = direction.y();
    packet.rays.dir_z[lane] = direction.z();
    packet.rays.tfar[lane] = distance;
    packet.valid[lane] = -1;
    gains_.push_back({light, path});
    ++count_;
  }

  void Reserve(size_t rays) {
    packets_.reserve(rays / 16 + 1);
    gains_.reserve(rays);
  }

  template <typename Gain>
  int Flush(const TracedScene& scene, RayOrder order, std::vector<ShadowPacket>* log,
            const Gain& gain) {
    if (log != nullptr) log->insert(log->end(), packets_.begin(), packets_.end());
    for (ShadowPacket& packet : packets_) scene.Occlude(packet.valid, packet.rays, order);
    for (int i = 0; i < count_; ++i) {
      if (packets_[i / 16].rays.tfar[i % 16] < 0) continue;
      gain(gains_[i].path, gains_[i].light);
    }
    const int flushed = count_;
    packets_.clear();
    gains_.clear();
    count_ = 0;
    return flushed;
  }

 private:
  struct Gain {
    V3f light;
    int path;
  };
  std::vector<ShadowPacket> packets_;
  std::vector<Gain> gains_;
  int count_ = 0;
};

struct Path {
  V3f origin, direction;
  V3f throughput = V3f::Ones();
  V3f absorption = V3f::Zero();
  float density = 0;       // with which the ray was drawn, 1/sr
  float lamp_share = 1;    // probability that a lamp was asked where the ray began
  float index_ratio2 = 1;  // n^2 of the medium: what `throughput` lacks inside glass
  int bounces = 0, surfaces = 0;
  bool delta = true;    // nothing but the ray itself can find its light
  bool inside = false;  // of an absorbing glass
  PathKey key;
};

// The power heuristic's weight of a sample of density `a` beside another strategy's `b`. Grazing
// lamps may have densities whose squares overflow: then `b` wins.
float Power(float a, float b) { return a * a / (a * a + b * b); }

class Batch {
 public:
  Batch(const PathTracer& tracer, std::span<const PathRay> rays, std::span<V3f> radiance,
        RayLog* log)
      : tracer_(tracer), scene_(tracer.scene()), radiance_(radiance), log_(log) {
    lamp_queues_.resize(tracer.lamps().size() + tracer.directional().size() + 1);
    for (size_t l = 0; l < tracer.lamps().size(); ++l) lamp_queues_[l].Reserve(rays.size());
    paths_.resize(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
      paths_[i].origin = rays[i].origin;
      paths_[i].direction = rays[i].direction;
      paths_[i].key = rays[i].key;
      active_.push_back(static_cast<int>(i));
      radiance_[i] = V3f::Zero();
    }
  }

  RayCounts Run() {
    for (bool first = true; !active_.empty(); first = false) {
      (first ? counts_.camera : counts_.bounce) += static_cast<int64_t>(active_.size());
      next_.clear();
      for (size_t begin = 0; begin < active_.size(); begin += 16) {
        const int lanes = static_cast<int>(std::min<size_t>(16, active_.size() - begin));
        RayPacket packet;
        for (int lane = 0; lane < lanes; ++lane) {
          const Path& path = paths_[active_[begin + lane]];
          packet.Set(lane, path.origin, path.direction, 0, kFar);
        }
        if (log_ != nullptr) (first ? log_->camera : log_->bounce).push_back(packet);
        scene_.Intersect(packet, first ? RayOrder::kCoherent : RayOrder::kScattered);
        for (int lane = 0; lane < lanes; ++lane) Arrive(active_[begin + lane], packet, lane);
      }
      const auto gain = [this](int path, const V3f& light) { radiance_[path] += light; };
      const RayOrder order = first ? RayOrder::kCoherent : RayOrder::kScattered;
      for (ShadowQueue& queue : lamp_queues_) {
        std::vector<ShadowPacket>* log = log_ == nullptr ? nullptr
                                         : first         ? &log_->near_shadow
                                                         : &log_->far_shadow;
        counts_.shadow += queue.Flush(scene_, order, log, gain);
      }
      counts_.shadow += last_queue_.Flush(scene_, RayOrder::kScattered,
                                          log_ == nullptr ? nullptr : &log_->far_shadow, gain);
      active_.swap(next_);
    }
    return counts_;
  }

 private:
  static uint32_t Pair(const Path& path, uint32_t slot) {
    return static_cast<uint32_t>(path.surfaces) * kPairsPerSurface + slot;
  }

  void Arrive(int index, const RayPacket& packet, int lane) {
    Path& path = paths_[index];
    const bool hit = packet.rays.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
    const float distance = hit ? packet.rays.ray.tfar[lane] : kFar;
    ForEachEmitter(
        path, path.origin, path.direction, path.throughput, distance,
        [&](const V3f& light, float) { radiance_[index] += Limited(path, path.surfaces, light); });
    if (!hit || path.surfaces >= kLongestPath) return;
    if (path.inside) {
      path.throughput.array() *= (-distance * path.absorption.array()).exp();
    }
    const SurfacePoint surface = scene_.Surface(packet, lane, path.direction);
    const Material& material = surface.material;
    const bool delta = IsDelta(material);
    const bool uncounted = delta || material.kind == MaterialKind::kGlass;
    if (path.bounces > tracer_.bounces() && !uncounted) return;
    const V3f o = surface.frame.Local(-path.direction);
    if (!delta) Illuminate(index, surface, o);
    Scatter(index, surface, o, uncounted);
  }

  // `light` that came over `surfaces` surfaces, held below the limit for what came over two or more
  // of which one is counted.
  V3f Limited(const Path& path, int surfaces, const V3f& light) const {
    if (surfaces < 2 || path.bounces < 1) return light;
    const float most = light.maxCoeff(), limit = tracer_.indirect_limit();
    return most > limit ? V3f(limit / most * light) : light;
  }

  // Calls take(light, distance) for every emitter that the ray meets before `limit`.
  template <typename Take>
  void ForEachEmitter(const Path& path, const V3f& origin, const V3f& direction,
                      const V3f& throughput, float limit, const Take& take) {
    for (const LampLight32& lamp : tracer_.lamps()) {
      const float t = lamp.Meet(origin, direction);
      if (!(t > 0) || !(t < limit)) continue;
      const float weight =
          path.delta ? 1 : Power(path.density, path.lamp_share * lamp.Density(direction, t));
      take(weight * throughput.cwiseProduct(lamp.radiance), t);
    }
    const EnvironmentLight& environment = tracer_.environment();
    if (limit < kFar || environment.IsBlack()) return;
    const float weight = path.delta || !environment.IsSampled()
                             ? 1
                             : Power(path.density, environment.Density(direction));
    take(weight * throughput.cwiseProduct(environment.Radiance(direction)), kFar);
  }

  // The light that reaches the surface straight from what can be asked.
  void Illuminate(int index, const SurfacePoint& surface, const V3f& o) {
    const Path& path = paths_[index];
    const size_t lamps = tracer_.lamps().size(), parallel = tracer_.directional().size();
    const bool all = path.surfaces == 0;
    const float choice = all ? 0 : RandomPair(path.key, Pair(path, kChoice))[0];
    const auto chosen = [&](size_t count, size_t i) {
      return all ||
             i == std::min(count - 1, static_cast<size_t>(choice * static_cast<float>(count)));
    };
    for (size_t l = 0; l < lamps; ++l) {
      if (!chosen(lamps, l)) continue;
      const auto u = RandomPair(path.key, Pair(path, kFirstLamp + static_cast<uint32_t>(l)));
      const LampLight32& lamp = tracer_.lamps()[l];
      const LampLight32::Sample sample = lamp.Draw(surface.position, u[0], u[1]);
      const float density = sample.density * (all ? 1 : 1 / static_cast<float>(lamps));
      Ask(index, surface, o, sample.direction, sample.distance * kShort, density, lamp.radiance,
          lamp_queues_[l]);
    }
    if (tracer_.environment().IsSampled()) {
      const auto u = RandomPair(path.key, Pair(path, kEnvironment));
      const EnvironmentLight::Sample sample = tracer_.environment().Draw(u[0], u[1]);
      Ask(index, surface, o, sample.direction, kFar, sample.density, sample.radiance,
          lamp_queues_[lamps]);
    }
    for (size_t l = 0; l < parallel; ++l) {
      if (!chosen(parallel, l)) continue;
      const DirectionalLight& light = tracer_.directional()[l];
      const V3f i = surface.frame.Local(light.to_light);
      if (!SameSide(surface, i, light.to_light)) continue;
      const V3f value = EvaluateBsdf(surface.material, o, i).value;
      if (value.isZero(0)) continue;
      const float share = all ? 1 : 1 / static_cast<float>(parallel);
      lamp_queues_[lamps + 1 + l].Add(
          TracedScene::Departure(surface, light.to_light), light.to_light, kFar,
          Limited(path, path.surfaces + 1,
                  path.throughput.cwiseProduct(value).cwiseProduct(light.irradiance) / share),
          index);
    }
  }

  void Ask(int index, const SurfacePoint& surface, const V3f& o, const V3f& direction,
           float distance, float density, const V3f& radiance, ShadowQueue& queue) {
    if (!(density > 0)) return;
    const V3f i = surface.frame.Local(direction);
    if (!SameSide(surface, i, direction)) return;
    const BsdfValue value = EvaluateBsdf(surface.material, o, i);
    if (value.value.isZero(0)) return;
    const V3f light = paths_[index].throughput.cwiseProduct(value.value).cwiseProduct(radiance) *
                      (density / (density * density + value.density * value.density));
    const Path& path = paths_[index];
    queue.Add(TracedScene::Departure(surface, direction), direction, distance,
              Limited(path, path.surfaces + 1, light), index);
  }

  // Whether a direction is on the same side of the facet as of the shading normal: else light would
  // leak through surfaces. Opaque surfaces scatter to the eye's side only.
  static bool SameSide(const SurfacePoint& surface, const V3f& local, const V3f& direction) {
    const float facet = surface.facet.dot(direction);
    if (surface.material.kind == MaterialKind::kGlass) return facet * local.z() > 0;
    return facet > 0 && local.z() > 0;
  }

  void Scatter(int index, const SurfacePoint& surface, const V3f& o, bool uncounted) {
    Path& path = paths_[index];
    const auto lobe = RandomPair(path.key, Pair(path, kLobe));
    const auto u = RandomPair(path.key, Pair(path, kDirection));
    const BsdfSample sample = SampleBsdf(surface.material, o, lobe[0], u[0], u[1]);
    if (sample.weight.isZero(0)) return;
    const V3f direction = UnitVector(surface.frame.World(sample.direction));
    if (!SameSide(surface, sample.direction, direction)) return;
    path.throughput = path.throughput.cwiseProduct(sample.weight);
    path.density = sample.density;
    path.delta = sample.delta;
    path.lamp_share = path.surfaces == 0 || tracer_.lamps().empty()
                          ? 1
                          : 1 / static_cast<float>(tracer_.lamps().size());
    path.index_ratio2 *= sample.index_ratio2;
    path.bounces += !uncounted;
    const V3f origin = TracedScene::Departure(surface, direction);
    if (path.bounces > tracer_.bounces() && !scene_.HasSpecularPaths()) {
      // Only emitters count any more: no need to know what is hit.
      ForEachEmitter(path, origin, direction, path.throughput, kFar,
                     [&](const V3f& light, float distance) {
                       last_queue_.Add(origin, direction, distance * kShort,
                                       Limited(path, path.surfaces + 1, light), index);
                     });
      return;
    }
    if (surface.material.kind == MaterialKind::kGlass) {
      path.inside = sample.direction.z() < 0 && !surface.material.absorption_per_mm.isZero(0);
      path.absorption = surface.material.absorption_per_mm;
    }
    if (++path.surfaces >= kRouletteFrom) {
      const float survival = std::min(0.95f, path.index_ratio2 * path.throughput.maxCoeff());
      if (!(lobe[1] < survival)) return;
      path.throughput /= survival;
    }
    path.origin = origin;
    path.direction = direction;
    next_.push_back(index);
  }

  const PathTracer& tracer_;
  const TracedScene& scene_;
  std::span<V3f> radiance_;
  RayLog* log_;
  std::vector<Path> paths_;
  std::vector<int> active_, next_;
  std::vector<ShadowQueue> lamp_queues_;  // a lamp each, the environment, a directional light each
  ShadowQueue last_queue_;
  RayCounts counts_;
};

}  // namespace

RayCounts& RayCounts::operator+=(const RayCounts& other) {
  camera += other.camera;
  bounce += other.bounce;
  shadow += other.shadow;
  return *this;
}

PathTracer::PathTracer(const TracedScene& scene, const SceneLights& lights, int bounces,
                       float indirect_limit)
    : scene_(scene),
      environment_(lights.studio, lights.environment),
      directional_(lights.directional),
      bounces_(bounces),
      indirect_limit_(indirect_limit) {
  if (!(indirect_limit > 0)) throw Error("the limit of indirect light must be positive");
  if (bounces < 0 || bounces > 64) {
    throw Error("bounces is " + std::to_string(bounces) + "; give a number from 0 to 64");
  }
  for (const AreaLight& lamp : lights.studio.lights) {
    if (!(lamp.Area() > 0)) throw Error("a lamp has no area; give it two sides");
    lamps_.emplace_back(lamp);
  }
  for (const DirectionalLight& light : directional_) {
    if (!(std::abs(light.to_light.norm() - 1) < 1e-3f)) {
      throw Error("a directional light's direction must have length 1");
    }
  }
}

RayCounts PathTracer::Trace(std::span<const PathRay> rays, std::span<V3f> radiance,
                            RayLog* log) const {
  return Batch(*this, rays, radiance, log).Run();
}

V3f PathTracer::TraceRadiance(const V3f& origin, const V3f& direction, int samples, uint64_t seed,
                              uint64_t stream) const {
  std::vector<PathRay> rays(static_cast<size_t>(std::max(1, samples)));
  std::vector<V3f> radiance(rays.size());
  for (size_t s = 0; s < rays.size(); ++s) {
    rays[s] = {origin,
               direction,
               {MakeSetKey(seed, stream, s / kSetSize), static_cast<uint32_t>(s % kSetSize)}};
  }
  Trace(rays, radiance);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const V3f& value : radiance) sum += value.cast<double>();
  return (sum / static_cast<double>(rays.size())).cast<float>();
}

}  // namespace lfm
