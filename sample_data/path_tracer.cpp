// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>

#include "core/error.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr int kLane = 16;

// Arrays cut out of one block, each with room for sixteen values more than it is asked for.
class Arena {
 public:
  explicit Arena(size_t bytes) : block_(std::make_unique_for_overwrite<std::byte[]>(bytes)) {}
  template <typename T>
  T* Take(size_t count) {
    T* taken = reinterpret_cast<T*>(block_.get() + used_);
    used_ += (count + kLane) * sizeof(T);
    return taken;
  }

 private:
  std::unique_ptr<std::byte[]> block_;  // aligned for 64-bit values: from operator new
  size_t used_ = 0;
};

constexpr size_t kWaveBytes = 80, kQueueBytes = 44;  // a path

PathWave MakeWave(Arena& arena, size_t paths) {
  PathWave wave;
  wave.set = arena.Take<uint64_t>(paths);
  for (auto* vector : {wave.origin, wave.direction, wave.throughput, wave.absorption}) {
    for (int c = 0; c < 3; ++c) vector[c] = arena.Take<float>(paths);
  }
  wave.density = arena.Take<float>(paths);
  wave.index_ratio2 = arena.Take<float>(paths);
  for (auto** array : {&wave.bounces, &wave.state, &wave.index, &wave.ray}) {
    *array = arena.Take<int32_t>(paths);
  }
  return wave;
}

ShadowQueue MakeQueue(Arena& arena, size_t rays) {
  ShadowQueue queue;
  for (auto* vector : {queue.origin, queue.direction, queue.light}) {
    for (int c = 0; c < 3; ++c) vector[c] = arena.Take<float>(rays);
  }
  queue.distance = arena.Take<float>(rays);
  queue.ray = arena.Take<int32_t>(rays);
  return queue;
}

void CopyLanes(const float* from, float* to) { std::memcpy(to, from, kLane * sizeof(float)); }

// Sixteen rays out of arrays, into a packet of Embree's. All else in it must be 0.
void AimRays(float* const origin[3], float* const direction[3], int begin, RTCRay16& rays) {
  CopyLanes(origin[0] + begin, rays.org_x);
  CopyLanes(origin[1] + begin, rays.org_y);
  CopyLanes(origin[2] + begin, rays.org_z);
  CopyLanes(direction[0] + begin, rays.dir_x);
  CopyLanes(direction[1] + begin, rays.dir_y);
  CopyLanes(direction[2] + begin, rays.dir_z);
  std::fill(rays.mask, rays.mask + kLane, ~0u);
}

class Batch {
 public:
  Batch(const PathTracer& tracer, const PathKernels& kernels, std::span<const PathRay> rays,
        std::span<V3f> radiance, RayLog* log)
      : tracer_(tracer),
        scene_(tracer.scene()),
        kernels_(kernels),
        radiance_(radiance),
        log_(log),
        arena_(Bytes(tracer, rays.size())) {
    const LightTables& lights = tracer.lights();
    wave_ = MakeWave(arena_, rays.size());
    next_ = MakeWave(arena_, rays.size());
    for (size_t q = 0; q < Queues(tracer); ++q) asked_.push_back(MakeQueue(arena_, rays.size()));
    last_ = MakeQueue(arena_, rays.size() * (static_cast<size_t>(lights.lamps) + 1));
    wave_.count = static_cast<int>(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        wave_.origin[c][i] = rays[i].origin[c];
        wave_.direction[c][i] = rays[i].direction[c];
        wave_.throughput[c][i] = 1;
        wave_.absorption[c][i] = 0;
      }
      wave_.density[i] = 0;
      wave_.index_ratio2[i] = 1;
      wave_.bounces[i] = 0;
      wave_.state[i] = kDelta;
      wave_.index[i] = static_cast<int32_t>(rays[i].key.index);
      wave_.set[i] = rays[i].key.set;
      wave_.ray[i] = static_cast<int32_t>(i);
      radiance_[i] = V3f::Zero();
    }
    // The kernels read whole packs, beyond the last path too: they must not meet rubbish.
    ClearTail(wave_);
  }

  RayCounts Run() {
    for (int surfaces = 0; wave_.count > 0; ++surfaces) {
      const bool first = surfaces == 0;
      (first ? counts_.camera : counts_.bounce) += wave_.count;
      next_.count = 0;
      for (int begin = 0; begin < wave_.count; begin += kLane) TracePack(surfaces, begin);
      const RayOrder order = first ? RayOrder::kCoherent : RayOrder::kScattered;
      std::vector<ShadowPacket>* log = log_ == nullptr ? nullptr
                                       : first         ? &log_->near_shadow
                                                       : &log_->far_shadow;
      for (ShadowQueue& queue : asked_) Flush(queue, order, log);
      Flush(last_, RayOrder::kScattered, log_ == nullptr ? nullptr : &log_->far_shadow);
      std::swap(wave_, next_);
      ClearTail(wave_);
    }
    return counts_;
  }

 private:
  static size_t Queues(const PathTracer& tracer) {
    return static_cast<size_t>(tracer.lights().lamps) + tracer.lights().parallel + 1;
  }
  static size_t Bytes(const PathTracer& tracer, size_t rays) {
    const size_t last = rays * (static_cast<size_t>(tracer.lights().lamps) + 1);
    return 2 * kWaveBytes * (rays + kLane) +
           kQueueBytes * (Queues(tracer) * (rays + kLane) + last + kLane);
  }

  static void ClearTail(PathWave& wave) {
    const int end = wave.count, to = (end + kLane - 1) / kLane * kLane;
    for (int i = end; i < to; ++i) {
      for (int c = 0; c < 3; ++c) {
        wave.origin[c][i] = wave.throughput[c][i] = wave.absorption[c][i] = 0;
        wave.direction[c][i] = c == 2 ? 1 : 0;
      }
      wave.density[i] = 0;
      wave.index_ratio2[i] = 1;
      wave.bounces[i] = wave.state[i] = wave.index[i] = wave.ray[i] = 0;
      wave.set[i] = 0;
    }
  }

  void TracePack(int surfaces, int begin) {
    const int lanes = std::min(kLane, wave_.count - begin);
    RayPacket packet;
    RTCRay16& ray = packet.rays.ray;
    AimRays(wave_.origin, wave_.direction, begin, ray);
    for (int lane = 0; lane < kLane; ++lane) {
      ray.tfar[lane] = kFar;
      packet.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.valid[lane] = lane < lanes ? -1 : 0;
    }
    if (log_ != nullptr) (surfaces == 0 ? log_->camera : log_->bounce).push_back(packet);
    scene_.Intersect(packet, surfaces == 0 ? RayOrder::kCoherent : RayOrder::kScattered);

    // RTC_INVALID_GEOMETRY_ID is -1.
    const RTCHit16& hit = packet.rays.hit;
    FetchJob fetch;
    fetch.scene = &scene_.tables();
    fetch.wave = &wave_;
    fetch.begin = begin;
    fetch.bounces = tracer_.bounces();
    fetch.geometry = reinterpret_cast<const int32_t*>(hit.geomID);
    fetch.triangle = reinterpret_cast<const int32_t*>(hit.primID);
    fetch.u = hit.u;
    fetch.v = hit.v;
    fetch.distance = ray.tfar;
    SurfacePack surface;
    kernels_.fetch(fetch, surface);
    scene_.LookUpColors(packet, lanes, surface);

    ShadeJob shade;
    shade.scene = &scene_.tables();
    shade.lights = &tracer_.lights();
    shade.limits = {tracer_.bounces(), tracer_.indirect_limit(), scene_.HasSpecularPaths()};
    shade.surfaces = surfaces;
    shade.wave = &wave_;
    shade.begin = begin;
    shade.lanes = lanes;
    shade.surface = &surface;
    shade.next = &next_;
    shade.asked = asked_.data();
    shade.last = &last_;
    shade.radiance = radiance_.data()->data();
    kernels_.shade(shade);
  }

  void Flush(ShadowQueue& queue, RayOrder order, std::vector<ShadowPacket>* log) {
    ShadowPacket packet = {};
    RTCRay16& ray = packet.rays;
    // Embree looks at rays that are switched off, too: they must not be rubbish.
    for (int i = queue.count; i % kLane != 0; ++i) {
      for (int c = 0; c < 3; ++c) queue.origin[c][i] = queue.direction[c][i] = 0;
      queue.distance[i] = 0;
    }
    for (int begin = 0; begin < queue.count; begin += kLane) {
      const int lanes = std::min(kLane, queue.count - begin);
      AimRays(queue.origin, queue.direction, begin, ray);
      CopyLanes(queue.distance + begin, ray.tfar);
      for (int lane = 0; lane < kLane; ++lane) packet.valid[lane] = lane < lanes ? -1 : 0;
      if (log != nullptr) log->push_back(packet);
      scene_.Occlude(packet.valid, packet.rays, order);
      for (int lane = 0; lane < lanes; ++lane) {
        if (ray.tfar[lane] < 0) continue;
        V3f& radiance = radiance_[queue.ray[begin + lane]];
        for (int c = 0; c < 3; ++c) radiance[c] += queue.light[c][begin + lane];
      }
    }
    counts_.shadow += queue.count;
    queue.count = 0;
  }

  const PathTracer& tracer_;
  const TracedScene& scene_;
  const PathKernels& kernels_;
  std::span<V3f> radiance_;
  RayLog* log_;
  Arena arena_;
  PathWave wave_, next_;
  std::vector<ShadowQueue> asked_;  // a lamp each, the environment, a directional light each
  ShadowQueue last_;
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
      bounces_(bounces),
      indirect_limit_(indirect_limit) {
  if (!(indirect_limit > 0)) throw Error("the limit of indirect light must be positive");
  if (bounces < 0 || bounces > 64) {
    throw Error("bounces is " + std::to_string(bounces) + "; give a number from 0 to 64");
  }
  const auto add = [](std::vector<float>& to, const V3f& v) {
    to.insert(to.end(), v.data(), v.data() + 3);
  };
  for (const AreaLight& lamp : lights.studio.lights) {
    if (!(lamp.Area() > 0)) throw Error("a lamp has no area; give it two sides");
    const V3f half_u = lamp.half_u.cast<float>(), half_v = lamp.half_v.cast<float>();
    add(lamps_, lamp.center.cast<float>());
    add(lamps_, half_u);
    add(lamps_, half_v);
    add(lamps_, lamp.Normal().cast<float>());
    add(lamps_, lamp.radiance);
    lamps_.insert(lamps_.end(), {static_cast<float>(lamp.Area()), 1 / half_u.squaredNorm(),
                                 1 / half_v.squaredNorm()});
    lamps_.resize(lamps_.size() + 6);
  }
  for (const DirectionalLight& light : lights.directional) {
    if (!(std::abs(light.to_light.norm() - 1) < 1e-3f)) {
      throw Error("a directional light's direction must have length 1");
    }
    add(directional_, light.to_light);
    add(directional_, light.irradiance);
    directional_.insert(directional_.end(), {0, 0});
  }
  lights_ = environment_.tables();
  lights_.lamps = static_cast<int>(lights.studio.lights.size());
  lights_.lamp = lamps_.data();
  lights_.parallel = static_cast<int>(lights.directional.size());
  lights_.directional = directional_.data();
}

RayCounts PathTracer::Trace(std::span<const PathRay> rays, std::span<V3f> radiance, RayLog* log,
                            const PathKernels* kernels) const {
  if (rays.empty()) return {};
  return Batch(*this, kernels != nullptr ? *kernels : UsablePathKernels().front(), rays, radiance,
               log)
      .Run();
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
