// SPDX-License-Identifier: BSD-3-Clause
// Ways to factorise one vertex light field of the paper's size (Chen 2002, Table 1 and Section 6):
// rings of six triangles with some 314 samples each, about a hundred of 300 photographs in front of
// each, a view grid of 32 x 32, RGB. K = 3. Counters: rows, cols, and the relative error
// ||F - F_K|| / ||F||, of the best possible one for PCA.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "encode/factored_operator.h"
#include "encode/nmf.h"
#include "encode/paper_factorization.h"
#include "encode/pca.h"
#include "encode/pca_solver.h"
#include "encode/precise_pca.h"
#include "encode/shared_samples.h"
#include "encode/vertex_factorization.h"
#include "tests/encode/dense_oracle.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr int kTerms = 3, kGrid = 32, kPhotos = 300;
constexpr int kEdgeSamples = 24;  // 300 samples a triangle
constexpr int kVertex = 20;       // of valence six

struct Workload {
  SyntheticLightField field = MakeLightField(
      MakeSphere(3), kGrid, kPhotos, [](int) { return kEdgeSamples; }, GlossyAppearance);
  VertexOperator centred, whole;  ///< mean view removed (PCA); as it is (NMF)
  SharedSamples shared;
  std::vector<float> plain_scale;
  RowMatrix dense, dense_whole;
};

VertexOperator Operator(const SyntheticLightField& field, const VertexRings& rings,
                        const std::function<PatchMean(int)>& mean) {
  const std::span<const int> ring(rings.triangles.data() + rings.offsets[kVertex],
                                  rings.triangles.data() + rings.offsets[kVertex + 1]);
  return BuildVertexOperator(field.Source(), kVertex, ring, mean);
}

// The mean over directions of each sample.
PatchMean MeanOf(const SyntheticLightField& field, int triangle) {
  const SyntheticLightField::Triangle& t = field.triangles[triangle];
  const size_t views = t.photos.size();
  PatchMean mean(t.values.size() / views);
  for (size_t k = 0; k < mean.size(); ++k) {
    for (size_t v = 0; v < views; ++v) {
      mean[k] += static_cast<float>(t.values[k * views + v]) / LightField::kOne;
    }
    mean[k] /= static_cast<float>(views);
  }
  return mean;
}

RowMatrix Dense(const VertexOperator& f, const std::vector<float>& plain_scale) {
  return FormMatrix(ScaledMap(f, plain_scale)) * static_cast<float>(f.max_abs);
}

const Workload& TheWorkload() {
  static const Workload* const workload = [] {
    auto* w = new Workload;
    const VertexRings rings = ComputeVertexRings(w->field.mesh);
    w->centred = Operator(w->field, rings, [&](int t) { return MeanOf(w->field, t); });
    w->whole = Operator(w->field, rings,
                        [&](int t) { return PatchMean(MeanOf(w->field, t).size(), 0.F); });
    std::vector<Eigen::Vector3i> triangles;
    for (const RingBlock& b : w->centred.blocks)
      triangles.push_back(w->field.mesh.triangles[b.triangle]);
    w->shared = FindSharedSamples(triangles, std::vector<int>(triangles.size(), kEdgeSamples));
    w->plain_scale.assign(kGrid * kGrid, 1.F);
    w->dense = Dense(w->centred, w->plain_scale);
    w->dense_whole = Dense(w->whole, w->plain_scale);
    return w;
  }();
  return *workload;
}

void SayHowGood(benchmark::State& state, const RowMatrix& f, const Eigen::MatrixXf& left,
                const Eigen::MatrixXf& right) {
  state.counters["rows"] = static_cast<double>(f.rows());
  state.counters["cols"] = static_cast<double>(f.cols());
  state.counters["error"] = static_cast<double>((f - left * right.transpose()).norm() / f.norm());
}

template <typename Result>
void SayHowGood(benchmark::State& state, const RowMatrix& f, const Result& r) {
  SayHowGood(state, f,
             Eigen::Map<const RowMatrix>(r.left.data(), f.rows(), r.width).leftCols(r.terms),
             Eigen::Map<const RowMatrix>(r.right.data(), f.cols(), r.width).leftCols(r.terms));
}

// (||F - F_K|| - optimum) / ||F||, judged in float64 on the matrix that the factors make there.
class Judge {
 public:
  explicit Judge(const Workload& w)
      : dense_(PreciseScaledMap(w.centred, w.plain_scale)
                   .multiply(Eigen::MatrixXd::Identity(w.centred.cols(), w.centred.cols()))),
        norm_(dense_.norm()) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> squares(dense_ * dense_.transpose(),
                                                                 Eigen::EigenvaluesOnly);
    optimum_ = std::sqrt(norm_ * norm_ - squares.eigenvalues().tail(kTerms).sum());
  }
  double AboveOptimum(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) const {
    return ((dense_ - left * right.transpose()).norm() - optimum_) / norm_;
  }

 private:
  Eigen::MatrixXd dense_;
  double norm_, optimum_ = 0;
};

const Judge& TheJudge() {
  static const Judge judge(TheWorkload());
  return judge;
}

void FactoredPca(benchmark::State& state) {
  const Workload& w = TheWorkload();
  const LinearMap map = ScaledMap(w.centred, w.plain_scale);
  PcaResult result;
  for (auto _ : state) result = ComputePca(map, {.terms = kTerms, .tolerance = 1e-6});
  SayHowGood(state, w.dense, result);
  const auto leading = [&](const std::vector<float>& x, int rows) -> Eigen::MatrixXd {
    return Eigen::Map<const RowMatrix>(x.data(), rows, result.width)
        .leftCols(result.terms)
        .cast<double>();
  };
  state.counters["above_optimum"] =
      TheJudge().AboveOptimum(leading(result.left, map.rows), leading(result.right, map.cols));
}

void FactoredPcaInDouble(benchmark::State& state) {
  const Workload& w = TheWorkload();
  const PreciseMap map = PreciseScaledMap(w.centred, w.plain_scale);
  PrecisePca result;
  for (auto _ : state) result = ComputePrecisePca(map, kTerms);
  state.counters["passes"] = result.passes;
  state.counters["above_optimum"] =
      TheJudge().AboveOptimum(result.left.leftCols(kTerms), result.right.leftCols(kTerms));
}

void FactoredClosedLoop(benchmark::State& state) {
  const Workload& w = TheWorkload();
  VertexTerms result;
  for (auto _ : state) result = FactorizeVertex(w.centred, w.shared, {.terms = kTerms});
  state.counters["error"] = std::sqrt(result.squared_errors.back() / result.squared_errors.front());
  state.counters["views"] = w.centred.blocks.front().views;
}

void DenseRandomisedPca(benchmark::State& state) {
  const Workload& w = TheWorkload();
  const LinearMap map = DenseMap(w.dense);
  PcaResult result;
  for (auto _ : state) result = ComputePca(map, {.terms = kTerms, .tolerance = 1e-6});
  SayHowGood(state, w.dense, result);
}

void PaperPowerIteration(benchmark::State& state) {
  const Workload& w = TheWorkload();
  const Eigen::MatrixXf f = w.dense;
  PaperFactors<float> result;
  for (auto _ : state) result = PaperPca<float>(f, {.terms = kTerms});
  SayHowGood(state, w.dense, result.left, result.right);
}

void FactoredNmf(benchmark::State& state) {
  const Workload& w = TheWorkload();
  const LinearMap map = ScaledMap(w.whole, w.plain_scale);
  NmfResult result;
  for (auto _ : state) result = ComputeNmf(map, {.terms = kTerms});
  state.counters["inside"] = result.iterations;
  state.counters["exact"] = result.exact_iterations;
  SayHowGood(state, w.dense_whole, result);
}

void PaperMultiplicativeNmf(benchmark::State& state) {
  const Workload& w = TheWorkload();
  const Eigen::MatrixXf f = w.dense_whole;
  PaperFactors<float> result;
  for (auto _ : state) {
    result = PaperNmf<float>(f, {.terms = kTerms, .tolerance = 1e-4, .max_iterations = 500});
  }
  SayHowGood(state, w.dense_whole, result.left, result.right);
}

BENCHMARK(FactoredPca)->Unit(benchmark::kMillisecond);
BENCHMARK(FactoredPcaInDouble)->Unit(benchmark::kMillisecond);
BENCHMARK(FactoredClosedLoop)->Unit(benchmark::kMillisecond);
BENCHMARK(FactoredNmf)->Unit(benchmark::kMillisecond);
BENCHMARK(DenseRandomisedPca)->Unit(benchmark::kMillisecond);
BENCHMARK(PaperPowerIteration)->Unit(benchmark::kMillisecond)->Iterations(2);
BENCHMARK(PaperMultiplicativeNmf)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace lfm::testing
