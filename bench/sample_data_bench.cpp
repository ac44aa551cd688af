// SPDX-License-Identifier: BSD-3-Clause
// How many rays a second the path tracer gets through, against what Embree alone does with the very
// same rays: every packet is recorded, and replayed batch by batch right after the tracer's own
// run, so that both meet the same machine. Times are this thread's CPU seconds. `ratio` is the
// tracer's rays a second over Embree's; the aim is 0.6. Run
// build/release/bench/lfm-bench-sample-data.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>
#include <vector>

#include "sample_data/camera_path.h"
#include "sample_data/path_tracer.h"
#include "sample_data/subject.h"
#include "sample_data/traced_photo.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

double CpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// The bust on its platform: painted (opaque) or of glass.
struct Workload {
  Board board = DefaultBoard();
  SetReflectance reflectance{board};
  std::vector<SceneObject> objects;
  std::unique_ptr<TracedScene> scene;
  std::unique_ptr<PathTracer> tracer;
  std::vector<std::vector<PathRay>> batches;

  explicit Workload(bool glass) {
    const Subject bust = MakeBust(1, 1);
    SceneObject object;
    object.name = "bust";
    object.mesh = bust.mesh;
    if (glass) {
      object.material.kind = MaterialKind::kGlass;
      object.material.alpha_u = object.material.alpha_v = 0;
    } else {
      object.paint = bust.paint;
    }
    objects.push_back(std::move(object));
    scene = std::make_unique<TracedScene>(
        objects, MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}), &reflectance);
    SceneLights lights;
    lights.studio = MakeStudioLighting();
    tracer = std::make_unique<PathTracer>(*scene, lights, 1);
    // Tiles of 8 x 8 pixels, 16 samples each, all over a photograph that the bust fills.
    const Camera camera = MakePhotoCamera(960, 720);
    const Pose pose = LookAt(V3(40, -210, 110), V3(0, 0, 55), V3(0, 0, 1));
    const Eigen::Matrix3f world_from_camera = pose.rotation.transpose().cast<float>();
    for (int tile = 0; tile < 60; ++tile) {
      const int x0 = 60 + tile % 10 * 90, y0 = 50 + tile / 10 * 110;
      std::vector<PathRay> batch;
      for (int p = 0; p < 64; ++p) {
        for (uint32_t s = 0; s < 16; ++s) {
          const PathKey key{MakeSetKey(1, static_cast<uint64_t>(tile), p * 4 + s / 4), s % 4};
          const auto u = RandomPair(key, 0xffff);
          const V3f d =
              Unproject(camera, {x0 + p % 8 + u[0] - 0.5, y0 + p / 8 + u[1] - 0.5}).cast<float>();
          batch.push_back({pose.Center().cast<float>(), (world_from_camera * d).normalized(), key});
        }
      }
      batches.push_back(std::move(batch));
    }
  }
};

void Replay(RTCScene scene, RayLog& log) {
  RTCIntersectContext coherent, scattered;
  rtcInitIntersectContext(&coherent);
  rtcInitIntersectContext(&scattered);
  coherent.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  scattered.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for (RayPacket& p : log.camera) rtcIntersect16(p.valid, scene, &coherent, &p.rays);
  for (ShadowPacket& p : log.near_shadow) rtcOccluded16(p.valid, scene, &coherent, &p.rays);
  for (RayPacket& p : log.bounce) rtcIntersect16(p.valid, scene, &scattered, &p.rays);
  for (ShadowPacket& p : log.far_shadow) rtcOccluded16(p.valid, scene, &scattered, &p.rays);
}

void TracingPaths(benchmark::State& state) {
  const Workload work(state.range(0) != 0);
  std::vector<V3f> radiance(work.batches[0].size());
  double tracer_seconds = 0, embree_seconds = 0;
  RayCounts counts;
  for (auto _ : state) {
    for (const std::vector<PathRay>& batch : work.batches) {
      RayLog log;
      work.tracer->Trace(batch, radiance, &log);  // also warms the caches for both
      const double start = CpuSeconds();
      counts += work.tracer->Trace(batch, radiance);
      const double middle = CpuSeconds();
      Replay(work.scene->embree(), log);
      tracer_seconds += middle - start;
      embree_seconds += CpuSeconds() - middle;
    }
  }
  const double rays = static_cast<double>(counts.Total());
  state.counters["Mrays/s"] = rays / tracer_seconds * 1e-6;
  state.counters["Embree_Mrays/s"] = rays / embree_seconds * 1e-6;
  state.counters["ratio"] = embree_seconds / tracer_seconds;
  state.counters["shadow_share"] = static_cast<double>(counts.shadow) / rays;
}
BENCHMARK(TracingPaths)
    ->ArgName("glass")
    ->Arg(0)
    ->Arg(1)
    ->Iterations(8)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lfm
