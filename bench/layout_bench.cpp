// SPDX-License-Identifier: BSD-3-Clause
// Where colour should live, and whether view maps should be shared: lfm-bench-layout WORK [EVERY].
// Every EVERY-th vertex light field of an object (40) is taken apart in float64, without
// quantisation: with monochrome surface maps and RGB view maps (M x 3N: the layout that Table 2 of
// Chen 2002 implies), the transpose (3M x N), separate channels (M x N three times), and with view
// maps out of a dictionary that all vertices share (the leading directions of the RGB view maps of
// as many other vertices; its bytes count). Terms are given to vertices by what they bring a byte.
// Prints PSNR at equal bytes.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "encode/factored_operator.h"
#include "encode/light_field_source.h"
#include "encode/mean_view.h"
#include "encode/pca_solver.h"
#include "encode/shared_samples.h"

namespace lfm {
namespace {

constexpr int kChannels = 3, kTermsToLearnFrom = 8, kMostTerms = 16;
constexpr double kRangeBytes = 16;  // scale and bias of both maps
constexpr double kBudgets[] = {1000, 2000, 4000, 8000, 16000, 32000};  // bytes a vertex
constexpr int kDictionaries[] = {32, 64, 128, 256};

using Matrix = Eigen::MatrixXd;

/// What one term of one vertex brings: squared error that it takes away, and bytes that it costs.
struct Term {
  double gain, bytes;
};

/// A way to lay terms out, with the terms of all vertices.
struct Layout {
  std::string name;
  std::vector<Term> terms;
  double shared_bytes = 0;  ///< a vertex
};

void AddTerms(const Matrix& gram, double bytes, std::vector<Term>& terms) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(gram, Eigen::EigenvaluesOnly);
  const Eigen::VectorXd& values = solver.eigenvalues();
  for (int k = 0; k < std::min<int>(kMostTerms, static_cast<int>(values.size())); ++k) {
    terms.push_back({std::max(values[values.size() - 1 - k], 0.0), bytes});
  }
}

/// The light field matrices of every so many vertices.
class VertexSample {
 public:
  VertexSample(const LightFieldSource& source, int first, int every)
      : source_(source), rings_(ComputeVertexRings(source.mesh)) {
    std::vector<int> edge_samples;
    for (size_t t = 0; t < source.mesh.triangles.size(); ++t) {
      edge_samples.push_back(source.patch(static_cast<int>(t)).edge_samples);
    }
    mean_ = ComputeMeanView(source, FindSharedSamples(source.mesh.triangles, edge_samples), 1,
                            SilentProgress());
    for (size_t v = first; v < source.mesh.vertices.size(); v += every) {
      vertices_.push_back(static_cast<int>(v));
    }
  }
  size_t size() const { return vertices_.size(); }
  /// M x 3N, mean view removed; empty where nobody saw anything.
  Matrix Of(size_t index) const {
    const int v = vertices_[index];
    const std::span<const int> ring(rings_.triangles.data() + rings_.offsets[v],
                                    rings_.triangles.data() + rings_.offsets[v + 1]);
    const VertexOperator f = BuildVertexOperator(source_, v, ring, [&](int triangle) {
      PatchMean values;
      for (const uint8_t code : mean_.codes[triangle]) {
        values.push_back(static_cast<float>(code) / 255);
      }
      return values;
    });
    if (f.rows == 0 || !(f.max_abs > 0)) return {};
    const std::vector<float> plain(f.directions, 1.F);
    return FormMatrix(ScaledMap(f, plain)).cast<double>() * f.max_abs;
  }

 private:
  const LightFieldSource& source_;
  VertexRings rings_;
  MeanView mean_;
  std::vector<int> vertices_;
};

struct VertexTerms {
  double energy = 0, entries = 0;
  std::vector<Term> monochrome, transposed, separate;
  Matrix views;  ///< 3N x kTermsToLearnFrom, sigma v
};

VertexTerms TakeApart(const Matrix& f) {
  VertexTerms result;
  if (f.size() == 0) return result;
  const auto m = static_cast<double>(f.rows());
  const Eigen::Index directions = f.cols() / kChannels;
  const auto n = static_cast<double>(directions);
  result.energy = f.squaredNorm();
  result.entries = static_cast<double>(f.size());
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(f * f.transpose());
  for (int k = 0; k < std::min<int>(kMostTerms, static_cast<int>(f.rows())); ++k) {
    result.monochrome.push_back(
        {std::max(solver.eigenvalues()[f.rows() - 1 - k], 0.0), m + kChannels * n + kRangeBytes});
  }
  result.views = f.transpose() * solver.eigenvectors().rightCols(
                                     std::min<Eigen::Index>(kTermsToLearnFrom, f.rows()));
  Matrix by_direction = Matrix::Zero(directions, directions);
  for (int c = 0; c < kChannels; ++c) {
    const Matrix channel = f.middleCols(c * directions, directions);
    by_direction += channel.transpose() * channel;
    AddTerms(channel * channel.transpose(), m + n + kRangeBytes, result.separate);
  }
  AddTerms(by_direction, kChannels * m + n + kRangeBytes, result.transposed);
  return result;
}

std::vector<VertexTerms> TakeApart(const VertexSample& sample) {
  std::vector<VertexTerms> vertices(sample.size());
  ParallelFor(0, static_cast<int64_t>(sample.size()),
              [&](int64_t i) { vertices[i] = TakeApart(sample.Of(i)); });
  return vertices;
}

double PsnrAt(const Layout& layout, double bytes_a_vertex, double vertices, double energy,
              double entries) {
  std::vector<Term> order = layout.terms;
  std::stable_sort(order.begin(), order.end(), [](const Term& a, const Term& b) {
    return a.gain * b.bytes > b.gain * a.bytes;
  });
  double left = (bytes_a_vertex - layout.shared_bytes) * vertices, error = energy;
  if (left < 0) return NAN;
  for (const Term& term : order) {
    const double share = std::min(1.0, left / term.bytes);
    error -= share * term.gain;
    left -= share * term.bytes;
    if (!(left > 0)) break;
  }
  return -10 * std::log10(std::max(error, 1e-12 * entries) / entries);
}

Matrix CommonDirections(const std::vector<VertexTerms>& vertices) {
  Matrix sum;
  for (const VertexTerms& vertex : vertices) {
    if (vertex.views.size() == 0) continue;
    if (sum.size() == 0) sum = Matrix::Zero(vertex.views.rows(), vertex.views.rows());
    sum.noalias() += vertex.views * vertex.views.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(sum);
  return solver.eigenvectors().rightCols(kDictionaries[std::size(kDictionaries) - 1]);
}

void Compare(const std::string& work, int every) {
  const LightField light_field = LightField::Open(work + "/resample/light_field.lfs");
  const LightFieldSource source = SourceFromLightField(light_field);
  const VertexSample sample(source, 0, every), others(source, every / 2, every);
  const std::vector<VertexTerms> vertices = TakeApart(sample);
  const auto count = static_cast<int64_t>(sample.size());
  std::vector<Layout> layouts = {{"monochrome surface maps, RGB view maps", {}},
                                 {"RGB surface maps, monochrome view maps", {}},
                                 {"separate channels", {}}};
  double energy = 0, entries = 0;
  for (const VertexTerms& v : vertices) {
    energy += v.energy;
    entries += v.entries;
    const std::vector<Term>* const terms[] = {&v.monochrome, &v.transposed, &v.separate};
    for (size_t i = 0; i < layouts.size(); ++i) {
      layouts[i].terms.insert(layouts[i].terms.end(), terms[i]->begin(), terms[i]->end());
    }
  }
  const Matrix directions = CommonDirections(TakeApart(others));
  for (const int size : kDictionaries) {
    Layout layout{"view maps out of " + std::to_string(size) + " shared ones", {}, 0};
    layout.shared_bytes = static_cast<double>(size) * static_cast<double>(directions.rows()) /
                          static_cast<double>(source.mesh.vertices.size());
    std::vector<std::vector<Term>> own(sample.size());
    ParallelFor(0, count, [&](int64_t i) {
      const Matrix f = sample.Of(i);
      if (f.size() == 0) return;
      const Matrix projected = f * directions.rightCols(size);
      AddTerms(projected.transpose() * projected,
               static_cast<double>(f.rows()) + size + kRangeBytes, own[i]);
    });
    for (const auto& terms : own)
      layout.terms.insert(layout.terms.end(), terms.begin(), terms.end());
    layouts.push_back(layout);
  }
  std::printf("%zu of %zu vertices; mean view alone %.2f dB\n\n| bytes a vertex |", sample.size(),
              source.mesh.vertices.size(), -10 * std::log10(energy / entries));
  for (const double budget : kBudgets) std::printf(" %.0f |", budget);
  std::printf("\n|---|---|---|---|---|---|---|\n");
  for (const Layout& layout : layouts) {
    std::printf("| %s |", layout.name.c_str());
    for (const double budget : kBudgets) {
      std::printf(" %.2f dB |",
                  PsnrAt(layout, budget, static_cast<double>(count), energy, entries));
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace lfm

int main(int argc, char** argv) {
  const int every = argc == 3 ? std::atoi(argv[2]) : 40;
  if (argc < 2 || argc > 3 || every < 2) {
    std::fprintf(stderr, "usage: lfm-bench-layout WORK [EVERY]\n");
    return 2;
  }
  try {
    lfm::Compare(argv[1], every);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-layout: error: %s\n", error.what());
    return 2;
  }
  return 0;
}
