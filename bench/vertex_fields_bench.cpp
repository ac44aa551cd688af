// SPDX-License-Identifier: BSD-3-Clause
// lfm-bench-vertex-fields WORK...: clustered sparse residual factorisation (Yamada 2009) on the
// vertex light fields of resampled captures, beside clustered PCA, PCA of all vertices together and
// nonnegative factors of the same clusters, each with as many terms as the same bytes hold. Errors
// are Equation 16 over the vertices of each kind, and PSNR over all.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "core/image_metrics.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "encode/nmf.h"
#include "fields/clustered_pca.h"
#include "fields/relightable_file.h"
#include "fields/residual.h"
#include "fields/sparse_clusters.h"
#include "fields/stored_numbers.h"
#include "fields/vertex_functions.h"

namespace lfm {
namespace {

constexpr int kClusters = 64, kMostNonnegativeTerms = 16;

/// Rows by how they vary: what does not depend on the view, what has a narrow peak, and the rest.
struct Kinds {
  std::vector<int64_t> diffuse, glossy, specular;
};

// Of what varies (the row without its mean): its share of the row's energy, and how much of it lies
// in the twentieth of the directions where it is largest.
Kinds SplitRows(RowsView rows) {
  constexpr double kDiffuseShare = 0.01, kPeakShare = 0.5;
  Kinds kinds;
  std::vector<double> squares(static_cast<size_t>(rows.columns));
  for (int64_t r = 0; r < rows.rows; ++r) {
    const float* row = rows.Row(r);
    double mean = 0, energy = 0, varying = 0, peak = 0;
    for (int i = 0; i < rows.columns; ++i) mean += row[i] / static_cast<double>(rows.columns);
    for (int i = 0; i < rows.columns; ++i) {
      squares[i] = (row[i] - mean) * (row[i] - mean);
      energy += double{row[i]} * row[i];
      varying += squares[i];
    }
    if (energy <= 0) continue;
    const auto few = squares.begin() + std::max(1, rows.columns / 20);
    std::nth_element(squares.begin(), few, squares.end(), std::greater<>());
    for (auto it = squares.begin(); it != few; ++it) peak += *it;
    (varying < kDiffuseShare * energy ? kinds.diffuse
     : peak > kPeakShare * varying    ? kinds.specular
                                      : kinds.glossy)
        .push_back(r);
  }
  return kinds;
}

double Psnr(const ClusteredModel& model, RowsView truth) {
  std::vector<double> sums(static_cast<size_t>(truth.rows));
  ParallelFor(0, truth.rows, [&](int64_t r) {
    std::vector<float> row(static_cast<size_t>(truth.columns));
    EvaluateRow(model, r, -1, row.data());
    for (int i = 0; i < truth.columns; ++i) {
      const double d = 255 * (double{truth.Row(r)[i]} - row[i]);
      sums[r] += d * d;
    }
  });
  double sum = 0;
  for (const double s : sums) sum += s;
  return PsnrFromMse(sum / (static_cast<double>(truth.rows) * truth.columns));
}

int64_t BytesOf(const Field& field, const ClusteredModel& model) {
  RelightableModel relightable = MakeRelightable(field);
  relightable.model = model;
  return CountBytes(relightable).Total();
}

// Bases and weights of the clusters in nonnegative factors.
ClusteredModel NonnegativeModel(RowsView rows, const Clustering& clustering, int terms) {
  ClusteredModel model;
  model.rows = rows.rows;
  model.columns = rows.columns;
  model.cluster.assign(clustering.cluster.begin(), clustering.cluster.end());
  model.first_weight.resize(static_cast<size_t>(rows.rows));
  const std::vector<std::vector<int64_t>> members = clustering.Members();
  for (const std::vector<int64_t>& cluster : members) {
    const FunctionRows own = GatherRows(rows, cluster);
    LinearMap map;
    map.rows = static_cast<int>(own.rows);
    map.cols = own.columns;
    for (const float v : own.values) map.max_abs = std::max(map.max_abs, double{std::abs(v)});
    map.multiply = [&own](const float* x, int width, float* y) {
      std::fill_n(y, own.rows * width, 0.0f);
      for (int64_t r = 0; r < own.rows; ++r) {
        for (int i = 0; i < own.columns; ++i) {
          for (int k = 0; k < width; ++k) y[r * width + k] += own.Row(r)[i] * x[i * width + k];
        }
      }
    };
    map.multiply_transposed = [&own](const float* y, int width, float* x) {
      std::fill_n(x, own.columns * width, 0.0f);
      for (int64_t r = 0; r < own.rows; ++r) {
        for (int i = 0; i < own.columns; ++i) {
          for (int k = 0; k < width; ++k) x[i * width + k] += own.Row(r)[i] * y[r * width + k];
        }
      }
    };
    NmfOptions options;
    options.terms = terms;
    const NmfResult factors = ComputeNmf(map, options);
    FunctionRows basis = MakeFunctionRows(factors.terms, rows.columns);
    for (int t = 0; t < factors.terms; ++t) {
      for (int i = 0; i < rows.columns; ++i) {
        basis.Row(t)[i] = factors.right[static_cast<size_t>(i) * factors.width + t];
      }
    }
    for (size_t r = 0; r < cluster.size(); ++r) {
      model.first_weight[cluster[r]] = static_cast<int64_t>(model.weights.size());
      for (int t = 0; t < factors.terms; ++t) {
        model.weights.push_back(factors.left[r * factors.width + t]);
      }
    }
    model.bases.push_back(std::move(basis));
  }
  return model;
}

struct Line {
  std::string name;
  ClusteredModel model;
  double seconds = 0;
};

template <typename Make>
Line Timed(const std::string& name, const Make& make) {
  const auto begin = std::chrono::steady_clock::now();
  ClusteredModel model = make();
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  return {name, std::move(model), time.count()};
}

// The most terms, at most `most`, whose model takes no more than `bytes`.
template <typename Make>
Line AtBytes(const std::string& name, const Field& field, int64_t bytes, int most,
             const Make& make) {
  Line best = Timed(name, [&] { return make(1); });
  for (int low = 1, high = most; low < high;) {
    const int terms = (low + high + 1) / 2;
    Line tried = Timed(name, [&] { return make(terms); });
    if (BytesOf(field, tried.model) > bytes) {
      high = terms - 1;
    } else {
      low = terms;
      best = std::move(tried);
      best.name = name + ", " + std::to_string(terms) + " terms";
    }
  }
  return best;
}

void Compare(const Field& field, const Kinds& kinds, int terms, int residuals) {
  const RowsView rows = field.functions.View();
  SparseClusterOptions sparse;
  sparse.clusters = kClusters;
  sparse.terms = terms;
  sparse.residuals = residuals;
  std::vector<Line> lines;
  lines.push_back(
      Timed("csrf, " + std::to_string(terms) + " terms, " + std::to_string(residuals) + " left",
            [&] { return ClusterSparse(field, sparse, SilentProgress()).model; }));
  const int64_t bytes = BytesOf(field, lines[0].model);

  const auto pca_of = [&](const Clustering& clustering, int count) {
    TermsOptions options;
    options.max_terms = count;
    return RoundToStored(ModelOfClusters(rows, clustering, options));
  };
  ClusterSearchOptions search;
  search.clusters = kClusters;
  search.terms = terms;
  const Clustering clustering = ClusterRows(rows, search);
  lines.push_back(Timed("clustered PCA with residual", [&] {
    return WithResidual(pca_of(clustering, terms), rows, {residuals, sparse.residual_threshold});
  }));
  lines.push_back(AtBytes("clustered PCA", field, bytes, rows.columns,
                          [&](int count) { return pca_of(clustering, count); }));
  const Clustering together{1, std::vector<int>(static_cast<size_t>(rows.rows), 0)};
  lines.push_back(AtBytes("PCA", field, bytes, rows.columns,
                          [&](int count) { return pca_of(together, count); }));
  lines.push_back(AtBytes("clustered NMF", field, bytes, kMostNonnegativeTerms, [&](int count) {
    return RoundToStored(NonnegativeModel(rows, clustering, count));
  }));
  for (const Line& line : lines) {
    std::printf(
        "%-34s %9.2f %9.5f %9.5f %9.5f %9.5f %8.2f %8.1f\n", line.name.c_str(),
        static_cast<double>(BytesOf(field, line.model)) * 1e-6, RelativeError(line.model, rows, -1),
        RelativeError(line.model, rows, -1, kinds.diffuse),
        RelativeError(line.model, rows, -1, kinds.glossy),
        RelativeError(line.model, rows, -1, kinds.specular), Psnr(line.model, rows), line.seconds);
    std::fflush(stdout);
  }
}

void Run(const std::string& work) {
  const LightField light_field = LightField::Open(work + "/resample/light_field.lfs");
  VertexFunctionOptions options;
  options.space = RadianceSpace::kSrgbCoded;
  const VertexFunctions functions = ReadVertexFunctions(light_field, options, SilentProgress());
  const Kinds kinds = SplitRows(functions.field.functions.View());
  std::printf("%s: %lld rows of %d directions; diffuse %zu, glossy %zu, specular %zu\n",
              work.c_str(), static_cast<long long>(functions.field.functions.rows),
              functions.field.functions.columns, kinds.diffuse.size(), kinds.glossy.size(),
              kinds.specular.size());
  std::printf("%-34s %9s %9s %9s %9s %9s %8s %8s\n", "", "MB", "error", "diffuse", "glossy",
              "specular", "dB", "s");
  for (const auto& [terms, residuals] : {std::pair{4, 12}, {4, 40}, {8, 8}}) {
    Compare(functions.field, kinds, terms, residuals);
  }
}

}  // namespace
}  // namespace lfm

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: lfm-bench-vertex-fields WORK...\n");
    return 2;
  }
  try {
    for (int i = 1; i < argc; ++i) lfm::Run(argv[i]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
