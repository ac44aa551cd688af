// SPDX-License-Identifier: BSD-3-Clause
#include "encode/mean_view.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kSmoothingSweeps = 50;  // over filled vertices; holes are a few triangles wide
constexpr int kCompletionRounds = 8;  // each halves what is lacking, or better

// How much each view counts in the mean; the weights sum to one.
std::vector<double> ViewShares(const LightFieldSource& source, int triangle, size_t views,
                               double guessed_weight, LightField::WeightBuffer& buffer) {
  std::vector<double> shares(views, 0.0), guessed(views, 0.0);
  for (int corner = 0; corner < 3; ++corner) {
    const ViewWeights weights = source.weights(triangle, corner, buffer);
    for (size_t q = 0; q < weights.seen.size(); ++q) {
      std::vector<double>& sum = weights.seen[q] ? shares : guessed;
      for (size_t e = 3 * q; e < 3 * q + 3; ++e) sum[weights.view[e]] += weights.weight[e];
    }
  }
  double total = 0;
  for (size_t v = 0; v < views; ++v) total += shares[v];
  const double factor = total > 0 ? guessed_weight : 1;
  total = 0;
  for (size_t v = 0; v < views; ++v) total += shares[v] += factor * guessed[v];
  for (double& share : shares) share /= total;
  return shares;
}

// The mean over the view grids of what is added to blended views at each corner (columns), RGB;
// weighted as above.
Eigen::Matrix3d MeanChange(const LightFieldSource& source, int triangle, double guessed_weight,
                           LightField::WeightBuffer& buffer) {
  Eigen::Matrix3d seen = Eigen::Matrix3d::Zero(), guessed = Eigen::Matrix3d::Zero();
  double seen_count = 0, guessed_count = 0;
  for (int corner = 0; corner < 3; ++corner) {
    const ViewWeights weights = source.weights(triangle, corner, buffer);
    const std::vector<float> change = source.change(triangle, corner, weights);
    const size_t directions = weights.seen.size();
    for (size_t q = 0; q < directions; ++q) {
      Eigen::Matrix3d& sum = weights.seen[q] ? seen : guessed;
      (weights.seen[q] ? seen_count : guessed_count) += 1;
      for (int e = 0; e < 9; ++e) sum(e % 3, e / 3) += change[e * directions + q];
    }
  }
  const double factor = seen_count > 0 ? guessed_weight : 1;
  return (seen + factor * guessed) / (seen_count + factor * guessed_count);
}

std::vector<float> PatchMeanValues(const LightFieldSource& source, int triangle,
                                   double guessed_weight) {
  const TrianglePatch patch = source.patch(triangle);
  const size_t views = patch.photos.size();
  std::vector<float> mean(static_cast<size_t>(PatchSampleCount(patch.edge_samples)) * 3, 0.f);
  if (views == 0) return mean;
  LightField::WeightBuffer buffer;
  const std::vector<double> shares = ViewShares(source, triangle, views, guessed_weight, buffer);
  for (size_t row = 0; row < mean.size(); ++row) {
    double sum = 0;
    for (size_t v = 0; v < views; ++v) sum += shares[v] * patch.values[row * views + v];
    mean[row] = static_cast<float>(sum / LightField::kOne);
  }
  if (!source.change) return mean;
  const Eigen::Matrix3d change = MeanChange(source, triangle, guessed_weight, buffer);
  const int n = patch.edge_samples;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const Eigen::Vector3d added = change * PatchSampleWeights(n, i, j);
      for (int c = 0; c < 3; ++c) {
        mean[3 * PatchSampleIndex(n, i, j) + c] += static_cast<float>(added[c]);
      }
    }
  }
  return mean;
}

struct VertexColors {
  std::vector<Eigen::Vector3f> colors;
  std::vector<uint8_t> known;
};

VertexColors MeasuredVertexColors(const LightFieldSource& source, std::span<const int> edge_samples,
                                  const std::vector<std::vector<float>>& means,
                                  const std::vector<uint8_t>& measured) {
  const size_t vertices = source.mesh.vertices.size();
  VertexColors result{std::vector<Eigen::Vector3f>(vertices, Eigen::Vector3f::Zero()),
                      std::vector<uint8_t>(vertices, 0)};
  std::vector<int> count(vertices, 0);
  for (size_t t = 0; t < means.size(); ++t) {
    if (!measured[t]) continue;
    for (int c = 0; c < 3; ++c) {
      const float* sample = means[t].data() + 3 * CornerSampleIndex(edge_samples[t], c);
      const int vertex = source.mesh.triangles[t][c];
      result.colors[vertex] += Eigen::Vector3f(sample[0], sample[1], sample[2]);
      ++count[vertex];
    }
  }
  for (size_t v = 0; v < vertices; ++v) {
    result.known[v] = count[v] > 0;
    if (count[v] > 0) result.colors[v] /= static_cast<float>(count[v]);
  }
  return result;
}

void FillUnseen(const LightFieldSource& source, std::span<const int> edge_samples,
                const std::vector<uint8_t>& measured, std::vector<std::vector<float>>& means) {
  VertexColors vertices = MeasuredVertexColors(source, edge_samples, means, measured);
  const std::vector<Eigen::Vector3f> colors =
      SpreadVertexColors(source.mesh, std::move(vertices.colors), std::move(vertices.known));
  for (size_t t = 0; t < means.size(); ++t) {
    if (measured[t]) continue;
    const int n = edge_samples[t];
    const Eigen::Vector3i& corners = source.mesh.triangles[t];
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const Eigen::Vector3f w = PatchSampleWeights(n, i, j).cast<float>();
        const Eigen::Vector3f color =
            w[0] * colors[corners[0]] + w[1] * colors[corners[1]] + w[2] * colors[corners[2]];
        std::copy_n(color.data(), 3, means[t].data() + 3 * PatchSampleIndex(n, i, j));
      }
    }
  }
}

// The sample a = (i, j) of a cell on the hypotenuse, and its two neighbours on it.
struct DiagonalCell {
  int a, b, c;
};
DiagonalCell CellOnHypotenuse(int n, int i) {
  const int j = n - 2 - i;
  return {3 * PatchSampleIndex(n, i, j), 3 * PatchSampleIndex(n, i + 1, j),
          3 * PatchSampleIndex(n, i, j + 1)};
}

// The gutter texel beyond the hypotenuse must hold b + c - a (docs/formats.md), in [0, 1]. Moves a
// where it does not; twice as far on an edge, where the neighbour's sample is averaged with it.
bool MoveTowardsCompletions(int n, std::vector<float>& mean) {
  bool moved = false;
  for (int i = 0; i <= n - 2; ++i) {
    const DiagonalCell cell = CellOnHypotenuse(n, i);
    const bool on_edge = i == 0 || i == n - 2;
    for (int c = 0; c < 3; ++c) {
      float& a = mean[cell.a + c];
      const float sum = mean[cell.b + c] + mean[cell.c + c];
      const float wanted = std::clamp(a, std::max(0.f, sum - 1), std::min(1.f, sum));
      moved |= wanted != a;
      a += (on_edge ? 2.f : 1.f) * (wanted - a);
    }
  }
  return moved;
}

void MakeCompletable(const SharedSamples& shared, std::span<const int> edge_samples,
                     std::span<const PatchValues> patches, std::vector<std::vector<float>>& means) {
  for (int round = 0; round < kCompletionRounds; ++round) {
    bool moved = false;
    for (size_t t = 0; t < means.size(); ++t) {
      moved |= MoveTowardsCompletions(edge_samples[t], means[t]);
    }
    if (!moved) return;
    MakeContinuous(shared, 3, patches);
  }
}

// What rounding still lacks; only inner samples are moved.
void KeepCompletionsInRange(int n, std::vector<uint8_t>& codes) {
  for (int i = 1; i <= n - 3; ++i) {
    const DiagonalCell cell = CellOnHypotenuse(n, i);
    for (int c = 0; c < 3; ++c) {
      uint8_t& a = codes[cell.a + c];
      const int sum = codes[cell.b + c] + codes[cell.c + c];
      a = static_cast<uint8_t>(std::clamp<int>(a, std::max(0, sum - 255), std::min(255, sum)));
    }
  }
}

std::vector<std::vector<uint8_t>> QuantizeMean(const SharedSamples& shared,
                                               std::span<const int> edge_samples,
                                               const std::vector<std::vector<float>>& means) {
  std::vector<std::vector<uint8_t>> all;
  std::vector<uint8_t*> patches;
  for (const auto& mean : means) {
    auto& codes = all.emplace_back(mean.size());
    for (size_t k = 0; k < mean.size(); ++k) {
      codes[k] = static_cast<uint8_t>(std::lround(255 * std::clamp(mean[k], 0.f, 1.f)));
    }
    patches.push_back(codes.data());
  }
  MakeCodesContinuous(shared, 3, patches);
  for (size_t t = 0; t < means.size(); ++t) KeepCompletionsInRange(edge_samples[t], all[t]);
  return all;
}

// For each vertex its neighbours, flattened; repeats do no harm to an average.
struct Adjacency {
  std::vector<int> offsets, neighbors;
};

Adjacency VertexAdjacency(const TriangleMesh& mesh) {
  Adjacency adjacency;
  adjacency.offsets.assign(mesh.vertices.size() + 1, 0);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) adjacency.offsets[t[c] + 1] += 2;
  }
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    adjacency.offsets[v + 1] += adjacency.offsets[v];
  }
  adjacency.neighbors.resize(adjacency.offsets.back());
  std::vector<int> next = adjacency.offsets;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      adjacency.neighbors[next[t[c]]++] = t[(c + 1) % 3];
      adjacency.neighbors[next[t[c]]++] = t[(c + 2) % 3];
    }
  }
  return adjacency;
}

// One sweep: every vertex of `fill` becomes the mean of its neighbours that have a colour.
bool Sweep(const Adjacency& adjacency, const std::vector<uint8_t>& fill,
           std::vector<Eigen::Vector3f>& colors, std::vector<uint8_t>& has_color) {
  const std::vector<Eigen::Vector3f> before = colors;
  const std::vector<uint8_t> had_color = has_color;
  bool grew = false;
  for (size_t v = 0; v < colors.size(); ++v) {
    if (!fill[v]) continue;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int count = 0;
    for (int e = adjacency.offsets[v]; e < adjacency.offsets[v + 1]; ++e) {
      const int neighbor = adjacency.neighbors[e];
      if (!had_color[neighbor]) continue;
      sum += before[neighbor];
      ++count;
    }
    if (count == 0) continue;
    colors[v] = sum / static_cast<float>(count);
    grew |= !had_color[v];
    has_color[v] = 1;
  }
  return grew;
}

}  // namespace

std::vector<std::vector<uint8_t>> ContinuousMeanCodes(const SharedSamples& shared,
                                                      std::span<const int> edge_samples,
                                                      std::span<const uint8_t> measured,
                                                      std::vector<std::vector<float>> means) {
  std::vector<PatchValues> patches(means.size());
  for (size_t t = 0; t < means.size(); ++t) {
    patches[t] = {means[t].data(), measured[t] != 0};
    for (float& value : means[t]) value = std::clamp(value, 0.f, 1.f);
  }
  MakeContinuous(shared, 3, patches);
  MakeCompletable(shared, edge_samples, patches, means);
  return QuantizeMean(shared, edge_samples, means);
}

std::vector<Eigen::Vector3f> SpreadVertexColors(const TriangleMesh& mesh,
                                                std::vector<Eigen::Vector3f> colors,
                                                std::vector<uint8_t> known) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  std::vector<uint8_t> fill(known.size());
  for (size_t v = 0; v < known.size(); ++v) {
    fill[v] = !known[v];
    if (known[v]) sum += colors[v].cast<double>();
    count += known[v];
  }
  if (count == 0) return colors;
  const Adjacency adjacency = VertexAdjacency(mesh);
  while (Sweep(adjacency, fill, colors, known)) {
  }
  const Eigen::Vector3f mean = (sum / count).cast<float>();
  for (size_t v = 0; v < known.size(); ++v) {
    if (!known[v]) colors[v] = mean;
  }
  std::fill(known.begin(), known.end(), uint8_t{1});
  for (int sweep = 0; sweep < kSmoothingSweeps; ++sweep) Sweep(adjacency, fill, colors, known);
  return colors;
}

MeanView ComputeMeanView(const LightFieldSource& source, const SharedSamples& shared,
                         double guessed_weight, Progress& progress) {
  const int triangles = static_cast<int>(source.mesh.triangles.size());
  std::vector<std::vector<float>> means(triangles);
  std::vector<int> edge_samples(triangles);
  std::vector<uint8_t> measured(triangles);
  progress.Start("mean view", triangles);
  ParallelFor(0, triangles, [&](int64_t t) {
    const int triangle = static_cast<int>(t);
    CheckSourceTriangle(source, triangle);
    const TrianglePatch patch = source.patch(triangle);
    edge_samples[t] = patch.edge_samples;
    measured[t] = !patch.photos.empty();
    means[t] = PatchMeanValues(source, triangle, guessed_weight);
    progress.Advance();
  });
  const auto unseen = std::count(measured.begin(), measured.end(), 0);
  if (unseen == triangles) {
    throw Error(source.name +
                ": no photograph shows enough of any triangle; check poses and mesh, and run "
                "lfm-resample again");
  }
  if (unseen > 0) FillUnseen(source, edge_samples, measured, means);
  MeanView view;
  view.codes = ContinuousMeanCodes(shared, edge_samples, measured, std::move(means));
  view.unseen_triangles = static_cast<int>(unseen);
  return view;
}

}  // namespace lfm
