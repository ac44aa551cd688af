// SPDX-License-Identifier: BSD-3-Clause
// Rates of what every stage leans on: the lens model, ray casting, and picture files. Run
// build/release/bench/lfm-bench-core; compare the rows with each other, not with other machines.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/ray_scene.h"
#include "core/triangle_mesh.h"

namespace lfm {
namespace {

Camera PhoneCamera(bool distorted) {
  Camera camera{960, 720, 1100, 1100, 479.5, 359.5};
  if (distorted) {
    camera.k1 = -0.12;
    camera.k2 = 0.05;
    camera.p1 = 1e-3;
  }
  return camera;
}

void Projecting(benchmark::State& state) {
  const Camera camera = PhoneCamera(state.range(0) != 0);
  double x = 0;
  for (auto _ : state) {
    x = x > 100 ? -100 : x + 0.37;
    benchmark::DoNotOptimize(Project(camera, {x, 0.5 * x, 400}));
  }
}
BENCHMARK(Projecting)->ArgName("distorted")->Arg(0)->Arg(1);

void Unprojecting(benchmark::State& state) {
  const Camera camera = PhoneCamera(state.range(0) != 0);
  double x = 0;
  for (auto _ : state) {
    x = x > 900 ? 0 : x + 3.1;
    benchmark::DoNotOptimize(Unproject(camera, {x, 0.7 * x}));
  }
}
BENCHMARK(Unprojecting)->ArgName("distorted")->Arg(0)->Arg(1);

TriangleMesh BumpySphere(int rows) {
  TriangleMesh mesh;
  const int columns = 2 * rows;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double theta = std::numbers::pi * i / rows, phi = 2 * std::numbers::pi * j / columns;
      const double r = 50 + 3 * std::sin(9 * theta) * std::cos(7 * phi);
      mesh.vertices.emplace_back(r * std::sin(theta) * std::cos(phi),
                                 r * std::sin(theta) * std::sin(phi), r * std::cos(theta));
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int a = i * columns + j, b = i * columns + (j + 1) % columns;
      if (i > 0) mesh.triangles.emplace_back(a, a + columns, b);
      if (i + 1 < rows) mesh.triangles.emplace_back(b, a + columns, b + columns);
    }
  }
  return mesh;
}

void CastingRays(benchmark::State& state) {
  const RayScene scene(BumpySphere(static_cast<int>(state.range(0))));
  double angle = 0;
  for (auto _ : state) {
    angle += 0.01;
    const Eigen::Vector3d eye(300 * std::cos(angle), 300 * std::sin(angle), 40);
    benchmark::DoNotOptimize(scene.Intersect(eye, -eye.normalized()));
  }
}
BENCHMARK(CastingRays)->ArgName("rows")->Arg(32)->Arg(256);

void FindingClosestPoints(benchmark::State& state) {
  const RayScene scene(BumpySphere(static_cast<int>(state.range(0))));
  double angle = 0;
  for (auto _ : state) {
    angle += 0.01;
    benchmark::DoNotOptimize(scene.Closest({51 * std::cos(angle), 51 * std::sin(angle), 5}));
  }
}
BENCHMARK(FindingClosestPoints)->ArgName("rows")->Arg(32)->Arg(256);

Image NoisyPicture() {
  Image image(960, 720, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  uint32_t state = 1;
  for (size_t i = 0; i < image.size(); ++i) {
    state = state * 1664525u + 1013904223u;
    image.Data<uint8_t>()[i] = static_cast<uint8_t>(128 + (i / 3 % 960) / 16 + (state >> 30));
  }
  return image;
}

void EncodingPng(benchmark::State& state) {
  const Image image = NoisyPicture();
  for (auto _ : state) {
    benchmark::DoNotOptimize(EncodePng(image, static_cast<int>(state.range(0))));
  }
}
BENCHMARK(EncodingPng)->ArgName("level")->Arg(1)->Arg(2)->Arg(6)->Unit(benchmark::kMillisecond);

void DecodingPng(benchmark::State& state) {
  const std::vector<std::byte> png = EncodePng(NoisyPicture(), 2);
  for (auto _ : state) benchmark::DoNotOptimize(DecodeImage(png.data(), png.size(), "bench"));
}
BENCHMARK(DecodingPng)->Unit(benchmark::kMillisecond);

void ToLinear(benchmark::State& state) {
  const Image image = NoisyPicture();
  for (auto _ : state) benchmark::DoNotOptimize(ToLinearFloat(image));
}
BENCHMARK(ToLinear)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lfm
