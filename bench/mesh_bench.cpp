// SPDX-License-Identifier: BSD-3-Clause
// From points to a mesh: time and peak memory over the number of points. The largest cloud is the
// one that has to stay within 4 GiB; it comes last, since a process's peak never falls.
#include <benchmark/benchmark.h>

#include "core/process_memory.h"
#include "core/progress.h"
#include "mesh/mesh.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

void BuildMeshOfPoints(benchmark::State& state) {
  const PointCloud cloud = test::MakeBumpyBall(state.range(0));
  const CalibResult calib = test::MakeCalib(24, 400, 40);
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
