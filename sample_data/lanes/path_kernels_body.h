// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_lights.h"
#include "sample_data/lanes/lane_random.h"
#include "sample_data/lanes/lane_scattering.h"
#include "sample_data/lanes/lane_surface.h"
#include "sample_data/lanes/path_kernels.h"

// What path_kernels.h declares; included once by the file that is compiled for each instruction
// set.
namespace lfm {
inline namespace LFM_LANE_SET {

using F = Floats;
using V = Vec<Floats>;

constexpr float kFar = __builtin_inff();
constexpr float kShort = 1 - 1e-4f;  // shadow rays end a little before their lamp
constexpr int kRouletteFrom = 8, kLongestPath = 32;
// Pairs of random numbers that a surface takes, by what for.
constexpr uint32_t kPairsPerSurface = 64;
enum Slot : uint32_t { kLobe, kDirection, kEnvironment, kChoice, kFirstLamp };

LFM_LANE V LoadVec(const float* const from[3], int at) {
  return {LoadLanes(from[0] + at), LoadLanes(from[1] + at), LoadLanes(from[2] + at)};
}
LFM_LANE V LoadVec(const float (&from)[3][16], int at) {
  return {LoadLanes(from[0] + at), LoadLanes(from[1] + at), LoadLanes(from[2] + at)};
}
LFM_LANE void StoreVec(float (&to)[3][16], int at, const V& v) {
  StoreLanes(to[0] + at, v.x);
  StoreLanes(to[1] + at, v.y);
  StoreLanes(to[2] + at, v.z);
}
LFM_LANE void WriteVec(const LanePacker& packer, float* const to[3], int at, const V& v) {
  packer.Write(to[0] + at, v.x);
  packer.Write(to[1] + at, v.y);
  packer.Write(to[2] + at, v.z);
}

/// The power heuristic's weight of a sample of density `a` beside another strategy's `b` (Veach and
/// Guibas 1995). Grazing lamps may have densities whose squares overflow: then `b` wins.
LFM_LANE F PowerWeight(F a, F b) { return a * a / (a * a + b * b); }

/// Paths at the surfaces that they met: those of a job from its lane `part` on.
class PathShader {
 public:
  LFM_LANE PathShader(const ShadeJob& job, int part)
      : job_(job),
        scene_(*job.scene),
        lights_(*job.lights),
        first_(job.surfaces == 0),
        part_(part),
        at_(job.begin + part) {
    const PathWave& w = *job.wave;
    const int at = at_;
    Ints lane;
    for (int i = 0; i < kLaneCount; ++i) lane[i] = part + i;
    active_ = lane < job.lanes;
    origin_ = LoadVec(w.origin, at);
    direction_ = LoadVec(w.direction, at);
    throughput_ = LoadVec(w.throughput, at);
    density_ = LoadLanes(w.density + at);
    index_ratio2_ = LoadLanes(w.index_ratio2 + at);
    bounces_ = LoadLanes(w.bounces + at);
    state_ = LoadLanes(w.state + at);
    index_ = LoadLanes(w.index + at);
    ray_ = LoadLanes(w.ray + at);
    set_ = LoadLanes(w.set + at);
  }

  LFM_LANE void Run() {
    const F distance = LoadLanes(job_.surface->distance + part_);
    Emit(distance);
    const Ints hit = active_ & (distance < kFar);
    if (!Any(hit) || job_.surfaces + 1 >= kLongestPath) return;
    Absorb(distance);
    LaneSurface<F> surface = LoadSurface();
    const LaneFrame<F> frame = TurnToEye(surface, -direction_);
    const Ints delta = IsDeltaLane(surface.material);
    const Ints uncounted = delta | (surface.material.kind == kLaneGlass);
    const Ints alive = hit & ((bounces_ <= job_.limits.bounces) | uncounted);
    const V o = frame.Local(-direction_);
    const Ints lit = alive & ~delta;
    if (Any(lit)) Illuminate(lit, surface, frame, o);
    if (Any(alive)) Scatter(alive, uncounted, surface, frame, o);
  }

 private:
  LFM_LANE NumberPair<F> Numbers(uint32_t slot) const {
    return RandomLanes<F>(set_, reinterpret_cast<UInts>(index_),
                          static_cast<uint32_t>(job_.surfaces) * kPairsPerSurface + slot);
  }

  LFM_LANE LaneSurface<F> LoadSurface() const {
    const SurfacePack& p = *job_.surface;
    const auto number = [&](const auto& from) { return LoadLanes(from + part_); };
    LaneSurface<F> s;
    s.position = LoadVec(p.position, part_);
    s.facet = LoadVec(p.facet, part_);
    s.normal = LoadVec(p.normal, part_);
    s.along = LoadVec(p.along, part_);
    s.material.kind = number(p.kind);
    s.material.diffuse = LoadVec(p.diffuse, part_);
    s.material.specular = LoadVec(p.specular, part_);
    s.material.exponent = number(p.exponent);
    s.material.alpha_u = number(p.alpha_u);
    s.material.alpha_v = number(p.alpha_v);
    s.material.ior = number(p.ior);
    s.material.absorption = LoadVec(p.absorption, part_);
    s.flags = number(p.flags);
    return s;
  }

  // `light` that came over `surfaces` surfaces, held below the limit for what came over two or more
  // of which one is counted.
  LFM_LANE V Limited(int surfaces, Ints bounces, const V& light) const {
    if (surfaces < 2 || !(job_.limits.indirect < kFar)) return light;
    const F most = LargestOf(light);
    const Ints over = (bounces >= 1) & (most > job_.limits.indirect);
    return Select<F>(over, (job_.limits.indirect / Select(over, most, Splat<F>(1))) * light, light);
  }

  // Calls take(mask, light, distance) for every emitter that rays of the mask meet before `limit`.
  template <typename Take>
  LFM_LANE void ForEachEmitter(Ints mask, const V& origin, const V& direction, const V& throughput,
                               F limit, Ints delta, F density, float lamp_share,
                               const Take& take) const {
    for (int l = 0; l < lights_.lamps; ++l) {
      const LaneLamp<F> lamp = TheLamp<F>(lights_, l);
      const F t = MeetLamp(lamp, origin, direction);
      const Ints met = mask & (t > 0.0f) & (t < limit);
      if (!Any(met)) continue;
      const F other = lamp_share * LampDensity(lamp, direction, t);
      const F weight = Select(delta, Splat<F>(1), PowerWeight(density, other));
      take(met, weight * Times(throughput, lamp.radiance), t);
    }
    const Ints free = mask & !(limit < kFar);
    if ((lights_.room_is_black && lights_.pixels == nullptr) || !Any(free)) return;
    F weight = Splat<F>(1);
    if (lights_.pixels != nullptr) {
      const F other = EnvironmentDensity(lights_, direction);
      weight = Select(delta, weight, PowerWeight(density, other));
    }
    take(free, weight * Times(throughput, EnvironmentRadiance(lights_, direction)), Splat<F>(kFar));
  }

  // What the rays that arrive here bring.
  LFM_LANE void Emit(F distance) const {
    const int before = job_.surfaces - 1;  // the surface where the rays began
    const float share =
        before <= 0 || lights_.lamps == 0 ? 1 : 1 / static_cast<float>(lights_.lamps);
    ForEachEmitter(active_, origin_, direction_, throughput_, distance, (state_ & kDelta) != 0,
                   density_, share, [&](Ints met, const V& light, F) {
                     Gain(met, Limited(job_.surfaces, bounces_, light));
                   });
  }

  LFM_LANE void Gain(Ints mask, const V& light) const {
    float x[kLaneCount], y[kLaneCount], z[kLaneCount];
    StoreLanes(x, light.x);
    StoreLanes(y, light.y);
    StoreLanes(z, light.z);
    for (unsigned bits = MaskBits(mask); bits != 0; bits &= bits - 1) {
      const int lane = __builtin_ctz(bits);
      float* to = job_.radiance + 3 * static_cast<int64_t>(ray_[lane]);
      to[0] += x[lane];
      to[1] += y[lane];
      to[2] += z[lane];
    }
  }

  LFM_LANE void Absorb(F distance) {
    const Ints inside = active_ & ((state_ & kInside) != 0);
    if (!Any(inside)) return;
    const V a = LoadVec(job_.wave->absorption, at_);
    const V left = {Exp(-distance * a.x), Exp(-distance * a.y), Exp(-distance * a.z)};
    throughput_ = Select<F>(inside, Times(throughput_, left), throughput_);
  }

  // Whether a direction is on the same side of the facet as of the shading normal: else light would
  // leak through surfaces. Opaque surfaces scatter to the eye's side only.
  LFM_LANE static Ints SameSide(Ints glass, const LaneFrame<F>& frame, const V& local,
                                const V& direction) {
    const F facet = Dot(frame.facet, direction);
    return (glass & (facet * local.z > 0.0f)) | (~glass & (facet > 0.0f) & (local.z > 0.0f));
  }

  LFM_LANE void Queue(ShadowQueue& queue, Ints mask, const V& origin, const V& direction,
                      F distance, const V& light) const {
    const LanePacker packer(mask);
    const int at = queue.count;
    WriteVec(packer, queue.origin, at, origin);
    WriteVec(packer, queue.direction, at, direction);
    packer.Write(queue.distance + at, distance);
    WriteVec(packer, queue.light, at, light);
    packer.Write(queue.ray + at, ray_);
    queue.count = at + packer.count();
  }

  // The light that reaches the surfaces straight from what can be asked.
  LFM_LANE void Illuminate(Ints lit, const LaneSurface<F>& surface, const LaneFrame<F>& frame,
                           const V& o) const {
    const int lamps = lights_.lamps, parallel = lights_.parallel;
    F choice = Splat<F>(0);
    if (!first_ && (lamps > 1 || parallel > 1)) choice = Numbers(kChoice).first;
    for (int l = 0; l < (first_ ? lamps : lamps > 0 ? 1 : 0); ++l) {
      const NumberPair<F> u = Numbers(kFirstLamp + static_cast<uint32_t>(l));
      const LaneLamp<F> lamp =
          first_ ? TheLamp<F>(lights_, l) : FetchLamp<F>(lights_, Chosen(choice, lamps));
      const LampSample<F> sample = DrawLamp(lamp, surface.position, u.first, u.second);
      const F density = first_ ? sample.density : sample.density / static_cast<float>(lamps);
      Ask(job_.asked[l], lit, surface, frame, o, sample.direction, sample.distance * kShort,
          density, lamp.radiance);
    }
    if (lights_.pixels != nullptr) {
      const NumberPair<F> u = Numbers(kEnvironment);
      const EnvironmentSample<F> sample = DrawEnvironment<F>(lights_, u.first, u.second);
      Ask(job_.asked[lamps], lit, surface, frame, o, sample.direction, Splat<F>(kFar),
          sample.density, EnvironmentRadiance(lights_, sample.direction));
    }
    for (int l = 0; l < (first_ ? parallel : parallel > 0 ? 1 : 0); ++l) {
      const Ints row = (first_ ? SplatInt<Ints>(l) : Chosen(choice, parallel)) * kParallelFloats;
      const V direction = GatherVec<F>(lights_.directional, row);
      const V irradiance = GatherVec<F>(lights_.directional, row + 3);
      const float share = first_ ? 1 : static_cast<float>(parallel);
      AskParallel(job_.asked[lamps + 1 + l], lit, surface, frame, o, direction,
                  Splat<F>(share) * irradiance);
    }
  }

  LFM_LANE static Ints Chosen(F choice, int count) {
    return HeldIndex(ToInt(choice * static_cast<float>(count)), count);
  }

  LFM_LANE void Ask(ShadowQueue& queue, Ints lit, const LaneSurface<F>& surface,
                    const LaneFrame<F>& frame, const V& o, const V& direction, F distance,
                    F density, const V& radiance) const {
    const V i = frame.Local(direction);
    const Ints glass = surface.material.kind == kLaneGlass;
    Ints mask = lit & SameSide(glass, frame, i, direction) & (density > 0.0f) & (density < 1e18f);
    if (!Any(mask)) return;
    const LaneBsdf<F> bsdf = EvaluateLanes(scene_.layers, surface.material, o, i);
    mask &= !IsZero(bsdf.value);
    const F weight = density / (density * density + bsdf.density * bsdf.density);
    const V light = weight * Times(Times(throughput_, bsdf.value), radiance);
    Queue(queue, mask, DepartFrom(surface.position, frame.facet, direction), direction, distance,
          Limited(job_.surfaces + 1, bounces_, light));
  }

  LFM_LANE void AskParallel(ShadowQueue& queue, Ints lit, const LaneSurface<F>& surface,
                            const LaneFrame<F>& frame, const V& o, const V& direction,
                            const V& irradiance) const {
    const V i = frame.Local(direction);
    const Ints glass = surface.material.kind == kLaneGlass;
    Ints mask = lit & SameSide(glass, frame, i, direction);
    if (!Any(mask)) return;
    const LaneBsdf<F> bsdf = EvaluateLanes(scene_.layers, surface.material, o, i);
    mask &= !IsZero(bsdf.value);
    const V light = Times(Times(throughput_, bsdf.value), irradiance);
    Queue(queue, mask, DepartFrom(surface.position, frame.facet, direction), direction,
          Splat<F>(kFar), Limited(job_.surfaces + 1, bounces_, light));
  }

  LFM_LANE void Scatter(Ints alive, Ints uncounted, const LaneSurface<F>& surface,
                        const LaneFrame<F>& frame, const V& o) const {
    const NumberPair<F> lobe = Numbers(kLobe), u = Numbers(kDirection);
    const LaneSample<F> sample =
        SampleLanes(scene_.layers, surface.material, o, lobe.first, u.first, u.second);
    const V direction = UnitVector(frame.World(sample.direction));
    const Ints glass = surface.material.kind == kLaneGlass;
    Ints going =
        alive & !IsZero(sample.weight) & SameSide(glass, frame, sample.direction, direction);
    V throughput = Times(throughput_, sample.weight);
    const Ints bounces = bounces_ + 1 + uncounted;  // uncounted is -1 where it holds
    const F ratio = index_ratio2_ * sample.index_ratio2;
    const V origin = DepartFrom(surface.position, frame.facet, direction);
    const Ints ending = bounces > job_.limits.bounces;
    if (!job_.limits.specular_paths) {
      // Only emitters count any more: no need to know what is hit.
      const Ints last = going & ending;
      const float share = first_ || lights_.lamps == 0 ? 1 : 1 / static_cast<float>(lights_.lamps);
      if (Any(last)) {
        ForEachEmitter(last, origin, direction, throughput, Splat<F>(kFar), sample.delta,
                       sample.density, share, [&](Ints met, const V& light, F distance) {
                         Queue(*job_.last, met, origin, direction, distance * kShort,
                               Limited(job_.surfaces + 1, bounces, light));
                       });
      }
      going &= ~ending;
    }
    if (job_.surfaces + 1 >= kRouletteFrom) {
      const F survival = Min(ratio * LargestOf(throughput), 0.95f);
      going &= lobe.second < survival;
      throughput = (1.0f / Select(going, survival, Splat<F>(1))) * throughput;
    }
    if (!Any(going)) return;
    const Ints absorbing =
        glass & (sample.direction.z < 0.0f) & !IsZero(surface.material.absorption);
    const Ints inside = Select(glass, absorbing, (state_ & kInside) != 0);
    const V absorption =
        Select<F>(glass, surface.material.absorption, LoadVec(job_.wave->absorption, at_));
    const Ints state = (sample.delta & kDelta) | (inside & kInside);
    Continue(going, origin, direction, throughput, absorption, sample.density, ratio, bounces,
             state);
  }

  LFM_LANE void Continue(Ints going, const V& origin, const V& direction, const V& throughput,
                         const V& absorption, F density, F ratio, Ints bounces, Ints state) const {
    PathWave& next = *job_.next;
    const LanePacker packer(going);
    const int at = next.count;
    WriteVec(packer, next.origin, at, origin);
    WriteVec(packer, next.direction, at, direction);
    WriteVec(packer, next.throughput, at, throughput);
    WriteVec(packer, next.absorption, at, absorption);
    packer.Write(next.density + at, density);
    packer.Write(next.index_ratio2 + at, ratio);
    packer.Write(next.bounces + at, bounces);
    packer.Write(next.state + at, state);
    packer.Write(next.index + at, index_);
    packer.Write(next.ray + at, ray_);
    packer.Write(next.set + at, set_);
    next.count = at + packer.count();
  }

  const ShadeJob& job_;
  const SceneTables& scene_;
  const LightTables& lights_;
  bool first_;
  int part_, at_;
  Ints active_;
  V origin_, direction_, throughput_;
  F density_, index_ratio2_;
  Ints bounces_, state_, index_, ray_;
  ULongs set_;
};

LFM_LANE void FetchPart(const FetchJob& job, int part, SurfacePack& surface) {
  LaneHit<F> hit;
  const Ints geometry = LoadLanes(job.geometry + part), zero = {};
  const Ints met = geometry >= 0;
  hit.geometry = Select(met, geometry, zero);
  hit.triangle = Select(met, LoadLanes(job.triangle + part), zero);
  hit.u = Select(met, LoadLanes(job.u + part), 0.0f);
  hit.v = Select(met, LoadLanes(job.v + part), 0.0f);
  hit.distance = Select(met, LoadLanes(job.distance + part), 0.0f);
  hit.origin = LoadVec(job.wave->origin, job.begin + part);
  hit.direction = LoadVec(job.wave->direction, job.begin + part);
  const LaneSurface<F> s = FetchSurface(*job.scene, hit);
  StoreVec(surface.position, part, s.position);
  StoreVec(surface.facet, part, s.facet);
  StoreVec(surface.normal, part, s.normal);
  StoreVec(surface.along, part, s.along);
  StoreVec(surface.diffuse, part, s.material.diffuse);
  StoreVec(surface.specular, part, s.material.specular);
  StoreVec(surface.absorption, part, s.material.absorption);
  StoreLanes(surface.exponent + part, s.material.exponent);
  StoreLanes(surface.alpha_u + part, s.material.alpha_u);
  StoreLanes(surface.alpha_v + part, s.material.alpha_v);
  StoreLanes(surface.ior + part, s.material.ior);
  StoreLanes(surface.kind + part, s.material.kind);
  // No colour is looked up where a path ends unseen.
  const Ints passing = (s.material.kind == kLaneGlass) | (s.material.kind == kLaneConductor);
  const Ints seen = passing | (LoadLanes(job.wave->bounces + job.begin + part) <= job.bounces);
  StoreLanes(surface.flags + part, Select(met & seen, s.flags, zero));
  StoreLanes(surface.distance + part, Select(met, hit.distance, Splat<F>(kFar)));
}

void FetchPack(const FetchJob& job, SurfacePack& surface) {
  for (int part = 0; part < 16; part += kLaneCount) FetchPart(job, part, surface);
}

void ShadePack(const ShadeJob& job) {
  for (int part = 0; part < job.lanes; part += kLaneCount) PathShader(job, part).Run();
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
