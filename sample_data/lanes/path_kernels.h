// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "sample_data/lanes/scene_tables.h"

namespace lfm {

/// The path tracer's work between two rounds of rays, for sixteen paths at a time, compiled for
/// several instruction sets. All sets compute the same bits.

/// Paths side by side: arrays of as many values as paths, with room for sixteen more.
struct PathWave {
  float* origin[3];
  float* direction[3];  ///< unit
  float* throughput[3];
  float* absorption[3];  ///< 1/mm, of the glass that the path is in
  float* density;        ///< with which the ray was drawn, 1/sr
  float* index_ratio2;   ///< n^2 of the medium: what `throughput` lacks inside glass
  int32_t* bounces;
  int32_t* state;  ///< kDelta, kInside
  int32_t* index;  ///< PathKey::index
  int32_t* ray;    ///< that the path belongs to
  uint64_t* set;   ///< PathKey::set
  int count = 0;
};
/// Bits of a path's state: nothing but its ray itself can find its light; it is inside an absorbing
/// glass.
inline constexpr int32_t kDelta = 1, kInside = 2;

/// Rays that ask whether something is in their way, and what each brings if nothing is.
struct ShadowQueue {
  float* origin[3];
  float* direction[3];
  float* distance;
  float* light[3];
  int32_t* ray;
  int count = 0;
};

/// Sixteen points that rays met, as fetched: plain arrays, for colours to be looked up in between.
struct SurfacePack {
  alignas(64) float position[3][16];
  alignas(64) float facet[3][16];
  alignas(64) float normal[3][16];
  alignas(64) float along[3][16];
  alignas(64) float diffuse[3][16];
  alignas(64) float specular[3][16];
  alignas(64) float absorption[3][16];
  alignas(64) float exponent[16];
  alignas(64) float alpha_u[16];
  alignas(64) float alpha_v[16];
  alignas(64) float ior[16];
  alignas(64) int32_t kind[16];
  alignas(64) int32_t flags[16];
  alignas(64) float distance[16];  ///< of the ray; infinity where nothing was met
};

struct TracerLimits {
  int bounces = 1;
  float indirect = 0;  ///< most radiance of one path over two surfaces or more
  bool specular_paths = false;
};

/// Where the paths `begin` to `begin + lanes` of a wave met something: `geometry` -1 for nothing.
struct FetchJob {
  const SceneTables* scene = nullptr;
  const PathWave* wave = nullptr;
  int begin = 0;
  int bounces = 0;  ///< that count; beyond, only what passes light on needs its colours
  const int32_t* geometry = nullptr;
  const int32_t* triangle = nullptr;
  const float* u = nullptr;
  const float* v = nullptr;
  const float* distance = nullptr;
};

struct ShadeJob {
  const SceneTables* scene = nullptr;
  const LightTables* lights = nullptr;
  TracerLimits limits;
  int surfaces = 0;  ///< that the paths met before this one
  const PathWave* wave = nullptr;
  int begin = 0, lanes = 0;
  const SurfacePack* surface = nullptr;
  PathWave* next = nullptr;
  ShadowQueue* asked = nullptr;  ///< a lamp each, the environment, a directional light each
  ShadowQueue* last = nullptr;   ///< rays of which only the light they end in counts
  float* radiance = nullptr;     ///< RGB a ray; added to
};

struct PathKernels {
  const char* name;  ///< of the instruction set
  void (*fetch)(const FetchJob& job, SurfacePack& surface);
  void (*shade)(const ShadeJob& job);
};

/// The kernels that this processor can run, the fastest first.
std::span<const PathKernels> UsablePathKernels();

}  // namespace lfm
