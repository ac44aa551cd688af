// SPDX-License-Identifier: BSD-3-Clause
// From points to a mesh: time and peak memory over the number of points. The largest cloud is the
// one that has to stay within 4 GiB; it comes last, since a process's peak never falls.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "core/process_memory.h"
#include "core/progress.h"
#include "mesh/mesh.h"

namespace lfm {
namespace {

// Points spread evenly over a ball with bumps that stands on the platform, with noise.
PointCloud BumpyCloud(int64_t count) {
  PointCloud cloud;
  cloud.points.reserve(count);
  cloud.normals.reserve(count);
  cloud.confidence.assign(count, 1);
  uint64_t state = 1;
  for (int64_t i = 0; i < count; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(i);
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3d out(r * std::cos(turn), r * std::sin(turn), z);
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double noise = static_cast<double>(state >> 40) * 0x1.0p-24 - 0.5;
    const double radius = 40 + 0.5 * std::sin(9 * out.x()) * std::sin(9 * out.y()) + 0.2 * noise;
    cloud.points.push_back(radius * out + Eigen::Vector3d(0, 0, 39));
    cloud.normals.push_back(out);
  }
  return cloud;
}

CalibResult RingOfCameras() {
  CalibResult calib;
  Camera camera;
  camera.width = 960;
  camera.height = 720;
  camera.fx = camera.fy = 1700;
  camera.cx = 479.5;
  camera.cy = 359.5;
  calib.cameras["camera"] = camera;
  for (int i = 0; i < 24; ++i) {
    const double turn = 2 * std::numbers::pi * i / 24;
    PosedImage photo;
    photo.id = "photo" + std::to_string(i);
    photo.camera = "camera";
    photo.camera_from_world = LookAt({400 * std::cos(turn), 400 * std::sin(turn), 150}, {0, 0, 40},
                                     Eigen::Vector3d::UnitZ());
    calib.photos.push_back(photo);
  }
  return calib;
}

void BuildMeshOfPoints(benchmark::State& state) {
  const PointCloud cloud = BumpyCloud(state.range(0));
  const CalibResult calib = RingOfCameras();
  MeshOptions options;
  options.triangle_count = 10000;
  for (auto _ : state) {
    benchmark::DoNotOptimize(BuildMesh(cloud, {}, calib, options, SilentProgress()));
  }
  state.counters["peak_mib"] = PeakMemoryMib();
}
BENCHMARK(BuildMeshOfPoints)
    ->Arg(200000)
    ->Arg(2000000)
    ->Arg(20000000)
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace lfm
