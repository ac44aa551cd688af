// SPDX-License-Identifier: BSD-3-Clause
#include "encode/shared_samples.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "resample/light_field.h"

namespace lfm {
namespace {

struct DirectedEdge {
  int low = 0, high = 0;  // vertex indices
  int patch = 0, edge = 0;
  bool reversed = false;  // runs from high to low
};

std::vector<SharedEdge> FindEdges(std::span<const Eigen::Vector3i> triangles,
                                  std::span<const int> edge_samples) {
  std::vector<DirectedEdge> directed;
  directed.reserve(triangles.size() * 3);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    for (int e = 0; e < 3; ++e) {
      const int from = triangles[t][e], to = triangles[t][(e + 1) % 3];
      directed.push_back({std::min(from, to), std::max(from, to), t, e, from > to});
    }
  }
  std::sort(directed.begin(), directed.end(), [](const DirectedEdge& a, const DirectedEdge& b) {
    return std::tie(a.low, a.high, a.patch, a.edge) < std::tie(b.low, b.high, b.patch, b.edge);
  });
  std::vector<SharedEdge> edges;
  for (size_t i = 0; i < directed.size(); ++i) {
    const DirectedEdge& d = directed[i];
    if (i == 0 || d.low != directed[i - 1].low || d.high != directed[i - 1].high) {
      edges.push_back({{}, 0});
    }
    const int n = edge_samples[d.patch];
    edges.back().uses.push_back({d.patch, d.edge, d.reversed, n});
    edges.back().segments = std::gcd(edges.back().segments, n - 1);
  }
  return edges;
}

std::vector<SharedCorner> FindCorners(std::span<const Eigen::Vector3i> triangles,
                                      std::span<const int> edge_samples) {
  std::vector<std::array<int, 3>> uses;  // vertex, patch, corner
  uses.reserve(triangles.size() * 3);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    for (int c = 0; c < 3; ++c) uses.push_back({triangles[t][c], t, c});
  }
  std::sort(uses.begin(), uses.end());
  std::vector<SharedCorner> corners;
  for (size_t i = 0; i < uses.size(); ++i) {
    if (i == 0 || uses[i][0] != uses[i - 1][0]) corners.emplace_back();
    corners.back().uses.push_back({uses[i][1], uses[i][2], edge_samples[uses[i][1]]});
  }
  return corners;
}

int UseSampleIndex(const EdgeUse& use, int step) {
  return EdgeSampleIndex(use.edge_samples, use.edge,
                         use.reversed ? use.edge_samples - 1 - step : step);
}

void AverageCorner(const SharedCorner& corner, int channels, std::span<const PatchValues> patches) {
  bool any_measured = false;
  for (const auto& use : corner.uses) any_measured |= patches[use.patch].measured;
  for (int c = 0; c < channels; ++c) {
    double sum = 0;
    int count = 0;
    for (const auto& use : corner.uses) {
      if (any_measured && !patches[use.patch].measured) continue;
      const int sample = CornerSampleIndex(use.edge_samples, use.corner);
      sum += patches[use.patch].values[sample * channels + c];
      ++count;
    }
    for (const auto& use : corner.uses) {
      const int sample = CornerSampleIndex(use.edge_samples, use.corner);
      patches[use.patch].values[sample * channels + c] = static_cast<float>(sum / count);
    }
  }
}

// A patch's samples along its side of an edge, in the first use's direction.
std::vector<double> SamplesAlong(const EdgeUse& use, int channels, int channel,
                                 const float* values) {
  std::vector<double> samples(use.edge_samples);
  for (int step = 0; step < use.edge_samples; ++step) {
    samples[step] = values[UseSampleIndex(use, step) * channels + channel];
  }
  return samples;
}

// The least squares fit of a function that is linear between `segments + 1` nodes to samples that
// divide each segment into equal steps; the end nodes keep the end samples. The normal equations
// are tridiagonal with constant coefficients (Thomas's algorithm).
std::vector<double> FitNodes(const std::vector<double>& samples, int segments) {
  const int ratio = (static_cast<int>(samples.size()) - 1) / segments;
  double diagonal = 0, beside = 0;
  std::vector<double> hat(ratio);
  for (int d = 0; d < ratio; ++d) {
    hat[d] = 1 - static_cast<double>(d) / ratio;
    diagonal += (d == 0 ? 1 : 2) * hat[d] * hat[d];
    beside += d == 0 ? 0 : hat[d] * (1 - hat[d]);
  }
  std::vector<double> nodes(segments + 1), factor(segments + 1, 0.0);
  nodes.front() = samples.front();
  nodes.back() = samples.back();
  for (int i = 1; i < segments; ++i) {
    double right = 0;
    for (int d = 1 - ratio; d < ratio; ++d) right += hat[std::abs(d)] * samples[i * ratio + d];
    if (i == segments - 1) right -= beside * nodes.back();
    const double pivot = diagonal - beside * factor[i - 1];
    factor[i] = beside / pivot;
    nodes[i] = (right - beside * nodes[i - 1]) / pivot;
  }
  for (int i = segments - 2; i >= 1; --i) nodes[i] -= factor[i] * nodes[i + 1];
  return nodes;
}

// The mean of the patches' fits. Their corners are equal already.
std::vector<double> SharedNodes(const SharedEdge& edge, int channels, int channel,
                                std::span<const PatchValues> patches) {
  bool any_measured = false;
  for (const EdgeUse& use : edge.uses) any_measured |= patches[use.patch].measured;
  std::vector<double> nodes(edge.segments + 1, 0.0);
  int count = 0;
  for (const EdgeUse& use : edge.uses) {
    if (any_measured && !patches[use.patch].measured) continue;
    ++count;
    const std::vector<double> fit =
        FitNodes(SamplesAlong(use, channels, channel, patches[use.patch].values), edge.segments);
    for (size_t i = 0; i < nodes.size(); ++i) nodes[i] += fit[i];
  }
  for (double& node : nodes) node /= count;
  return nodes;
}

// Two measured patches of equal n: their samples are the nodes.
bool AreAlike(const SharedEdge& edge, std::span<const PatchValues> patches) {
  return edge.uses.size() == 2 && edge.uses[0].edge_samples == edge.uses[1].edge_samples &&
         patches[edge.uses[0].patch].measured && patches[edge.uses[1].patch].measured;
}

void AverageAlike(const SharedEdge& edge, int channels, std::span<const PatchValues> patches) {
  const EdgeUse &a = edge.uses[0], &b = edge.uses[1];
  for (int step = 0; step < a.edge_samples; ++step) {
    float* first = patches[a.patch].values + UseSampleIndex(a, step) * channels;
    float* second = patches[b.patch].values + UseSampleIndex(b, step) * channels;
    for (int c = 0; c < channels; ++c) {
      first[c] = second[c] = static_cast<float>((static_cast<double>(first[c]) + second[c]) / 2);
    }
  }
}

void AverageEdge(const SharedEdge& edge, int channels, std::span<const PatchValues> patches) {
  if (edge.uses.size() < 2) return;
  if (AreAlike(edge, patches)) return AverageAlike(edge, channels, patches);
  for (int c = 0; c < channels; ++c) {
    const std::vector<double> nodes = SharedNodes(edge, channels, c, patches);
    for (const EdgeUse& use : edge.uses) {
      const int ratio = (use.edge_samples - 1) / edge.segments;
      for (int step = 0; step < use.edge_samples; ++step) {
        const int node = step / ratio, rest = step % ratio;
        const double value = rest == 0
                                 ? nodes[node]
                                 : (nodes[node] * (ratio - rest) + nodes[node + 1] * rest) / ratio;
        patches[use.patch].values[UseSampleIndex(use, step) * channels + c] =
            static_cast<float>(value);
      }
    }
  }
}

}  // namespace

int EdgeSampleIndex(int n, int edge, int step) {
  if (edge == 0) return PatchSampleIndex(n, step, 0);
  if (edge == 1) return PatchSampleIndex(n, n - 1 - step, step);
  return PatchSampleIndex(n, 0, n - 1 - step);
}

int CornerSampleIndex(int n, int corner) { return EdgeSampleIndex(n, corner, 0); }

SharedSamples FindSharedSamples(std::span<const Eigen::Vector3i> triangles,
                                std::span<const int> edge_samples) {
  return {FindEdges(triangles, edge_samples), FindCorners(triangles, edge_samples)};
}

void MakeContinuous(const SharedSamples& shared, int channels,
                    std::span<const PatchValues> patches) {
  for (const SharedCorner& corner : shared.corners) AverageCorner(corner, channels, patches);
  for (const SharedEdge& edge : shared.edges) AverageEdge(edge, channels, patches);
}

void MakeCodesContinuous(const SharedSamples& shared, int channels,
                         std::span<uint8_t* const> patches) {
  for (const SharedEdge& edge : shared.edges) {
    if (edge.uses.size() < 2) continue;
    for (const EdgeUse& use : edge.uses) {
      const int ratio = (use.edge_samples - 1) / edge.segments;
      if (ratio == 1) continue;
      uint8_t* codes = patches[use.patch];
      for (int step = 0; step < use.edge_samples; ++step) {
        const int rest = step % ratio;
        if (rest == 0) continue;
        const int before = UseSampleIndex(use, step - rest) * channels;
        const int after = UseSampleIndex(use, step - rest + ratio) * channels;
        for (int c = 0; c < channels; ++c) {
          const int sum = codes[before + c] * (ratio - rest) + codes[after + c] * rest;
          codes[UseSampleIndex(use, step) * channels + c] =
              static_cast<uint8_t>((2 * sum + ratio) / (2 * ratio));
        }
      }
    }
  }
}

}  // namespace lfm
