// SPDX-License-Identifier: BSD-3-Clause
// How fast a clustered model is relit (Yamada 2009, Equation 15): lfm-bench-relight [MODEL.lfr].
// Without a model, one of random numbers: 640 x 422 pixels, 253 lights, RGB, 128 clusters of 4
// terms, residuals in 30 % of the lights. Frames a second for each share of residuals, instruction
// set and number of threads, beside what reading the same bytes alone takes, and beside the dense
// product R I in float16. Wall time is the best of the repetitions; the processor's time (the
// process's, a thread's share) does not count what other programs took.
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/light_sampling.h"
#include "fields/relightable_file.h"
#include "fields/relighting.h"

namespace lfm {
namespace {

constexpr int kRepetitions = 15;

RelightableModel RandomModel() {
  constexpr int kWidth = 640, kHeight = 422, kLights = 253, kClusters = 128, kTerms = 4,
                kResiduals = 76;
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<float>(random() % 2048) / 1024 - 1; };
  RelightableModel r;
  r.name = "random";
  r.points = int64_t{kWidth} * kHeight;
  r.width = kWidth;
  r.height = kHeight;
  r.channels = 3;
  r.directions.assign(kLights, Eigen::Vector3d::UnitZ());
  ClusteredModel& m = r.model;
  m.rows = r.points * r.channels;
  m.columns = kLights;
  for (int k = 0; k < 3 * kClusters; ++k) {  // every channel has its own
    FunctionRows basis = MakeFunctionRows(kTerms, kLights);
    for (int64_t t = 0; t < kTerms; ++t) std::generate_n(basis.Row(t), kLights, number);
    m.bases.push_back(std::move(basis));
  }
  m.first_residual.push_back(0);
  for (int64_t row = 0; row < m.rows; ++row) {
    m.cluster.push_back(static_cast<uint16_t>(row / r.points * kClusters + random() % kClusters));
    m.first_weight.push_back(row * kTerms);
    for (int t = 0; t < kTerms; ++t) m.weights.push_back(number());
    const auto step = static_cast<int>(1 + random() % (kLights - 1));  // 253 = 11 x 23
    int column = static_cast<int>(random() % kLights);
    for (int j = 0; j < kResiduals; ++j) {
      m.residual_column.push_back(static_cast<uint16_t>(column));
      m.residual_value.push_back(1 - static_cast<float>(j) / kResiduals);
      column = (column + step) % kLights;
    }
    m.first_residual.push_back(static_cast<int64_t>(m.residual_value.size()));
  }
  return r;
}

struct Times {
  double wall_in_seconds = 1e30, processor_in_seconds = 1e30;  // a thread's share
};

Times Measure(int threads, const std::function<void()>& body) {
  Times best;
  for (int i = 0; i < kRepetitions; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    body();
    best.processor_in_seconds =
        std::min(best.processor_in_seconds,
                 static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC / threads);
    best.wall_in_seconds =
        std::min(best.wall_in_seconds,
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

// Bytes a second that reading gets to, by as many threads.
Times ReadTime(const std::vector<uint64_t>& buffer, int threads) {
  constexpr int64_t kChunk = 1 << 15;
  std::vector<uint64_t> sums(buffer.size() / kChunk + 1);
  const Times times = Measure(threads, [&] {
    ParallelChunks(static_cast<int64_t>(buffer.size()), kChunk,
                   [&](int64_t begin, int64_t end, int64_t chunk) {
                     uint64_t sum[4] = {};
                     for (int64_t i = begin; i + 4 <= end; i += 4) {
                       for (int k = 0; k < 4; ++k) sum[k] += buffer[i + k];
                     }
                     sums[chunk] += sum[0] + sum[1] + sum[2] + sum[3];
                   });
  });
  if (std::accumulate(sums.begin(), sums.end(), uint64_t{0}) == 1) std::puts("");
  return times;
}

void PrintDense(const RelightableModel& r, int threads) {
  constexpr int64_t kShare = 8;  // of the rows, so that memory suffices
  const int64_t rows = r.model.rows / kShare;
  const int length = (r.model.columns + 15) / 16 * 16;
  const std::vector<uint16_t> dense(static_cast<size_t>(rows) * length, 0x3c00);
  const std::vector<float> light(static_cast<size_t>(length), 1.0f);
  std::vector<float> out(static_cast<size_t>(rows));
  const Times times = Measure(threads, [&] {
    ParallelChunks(rows, 1024, [&](int64_t begin, int64_t end, int64_t) {
      kernels::HalfProducts(kernels::BestRelightLevel(), dense.data() + begin * length, end - begin,
                            length, light.data(), out.data() + begin);
    });
  });
  std::printf("dense R I, float16, %d thread(s): %.1f frames/s (processor %.1f)\n", threads,
              1 / (times.wall_in_seconds * kShare), 1 / (times.processor_in_seconds * kShare));
}

void PrintRelighting(const RelightableModel& r, const Relighter& relighter,
                     const PreparedLight& light, kernels::RelightLevel level, int threads,
                     double bytes_in_second) {
  for (const int percent : {0, 3, 5, 10, 20, 30}) {
    const int residuals = std::min(relighter.MostResiduals(),
                                   static_cast<int>(0.01 * percent * r.model.columns + 0.5));
    const Times times = Measure(threads, [&] { relighter.Relight(light, residuals, level); });
    double stored = 0;  // of the residuals that are read
    if (!r.model.first_residual.empty()) {
      for (int64_t row = 0; row < r.model.rows; ++row) {
        stored += static_cast<double>(std::min<int64_t>(
            residuals, r.model.first_residual[row + 1] - r.model.first_residual[row]));
      }
    }
    const double bytes = 2.0 * static_cast<double>(r.model.weights.size()) +
                         2.0 * static_cast<double>(r.model.rows) +
                         stored * (r.model.columns <= 256 ? 3 : 4);
    std::printf(
        "%-10s %d %4d %% %4d residuals: %7.1f frames/s, processor %7.1f; reading alone "
        "%7.1f (%.1f MB)\n",
        kernels::NameOf(level), threads, percent, residuals, 1 / times.wall_in_seconds,
        1 / times.processor_in_seconds, bytes_in_second / bytes, bytes / 1e6);
  }
}

// What a rotated environment costs: a map of 1024 x 512 pixels over 253 lights.
void PrintSampling(int threads) {
  constexpr int kWidth = 1024, kHeight = 512, kLights = 253;
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kLights; ++i) {
    const double z = 1 - (2.0 * i + 1) / kLights, r = std::sqrt(1 - z * z), angle = 2.39996 * i;
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  Image map(kWidth, kHeight, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (size_t i = 0; i < map.size(); ++i) map.Data<float>()[i] = static_cast<float>(i % 7);
  const LightProbe probe = MakeLightProbe(map, "map");
  const LightCells cells = MakeLightCells(FieldColumns::kLights, directions);
  const Times made = Measure(threads, [&] { MakeLightCells(FieldColumns::kLights, directions); });
  double turn = 0;
  const Times upright = Measure(threads, [&] { SampleProbe(cells, probe, turn += 1.7); });
  const Times free = Measure(threads, [&] {
    SampleProbeTurned(cells, probe,
                      Eigen::AngleAxisd(turn += 0.1, Eigen::Vector3d::UnitX()).toRotationMatrix());
  });
  std::printf(
      "a map of %d x %d over %d lights, %d thread(s): cells %.0f ms; turned about the "
      "vertical %.2f ms, about any axis %.2f ms (processor %.2f, %.2f)\n",
      kWidth, kHeight, kLights, threads, 1e3 * made.wall_in_seconds, 1e3 * upright.wall_in_seconds,
      1e3 * free.wall_in_seconds, 1e3 * upright.processor_in_seconds,
      1e3 * free.processor_in_seconds);
}

int Main(int argc, char** argv) {
  const RelightableModel r = argc > 1 ? ReadRelightable(argv[1]) : RandomModel();
  const Relighter relighter(r);
  std::printf("%s: %lld points x %d channels, %d columns, %zu clusters, %.1f MB at run time\n",
              r.name.c_str(), static_cast<long long>(r.points), r.channels, r.model.columns,
              r.model.bases.size(), 1e-6 * static_cast<double>(relighter.MemoryBytes()));
  LightVector light = MakeLightVector(relighter.directions(), r.channels);
  std::fill(light.values.begin(), light.values.end(), 0.01f);
  const PreparedLight prepared = relighter.Prepare(light);
  std::vector<uint64_t> buffer(size_t{64} << 17, 1);  // 64 MiB
  for (const int threads : {1, 2}) {
    SetThreadCount(threads);
    const Times read = ReadTime(buffer, threads);
    const double bytes_in_second = 8.0 * static_cast<double>(buffer.size()) / read.wall_in_seconds;
    const Times prepare = Measure(threads, [&] { relighter.Prepare(light); });
    std::printf("%d thread(s): reads %.1f GB/s; products of a light %.3f ms\n", threads,
                1e-9 * bytes_in_second, 1e3 * prepare.wall_in_seconds);
    PrintSampling(threads);
    PrintDense(r, threads);
    for (const kernels::RelightLevel level : kernels::kRelightLevels) {
      if (!kernels::Runs(level)) continue;
      PrintRelighting(r, relighter, prepared, level, threads, bytes_in_second);
    }
  }
  return 0;
}

}  // namespace
}  // namespace lfm

int main(int argc, char** argv) {
  try {
    return lfm::Main(argc, argv);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-relight: error: %s\n", error.what());
    return 2;
  }
}
