// SPDX-License-Identifier: BSD-3-Clause
#include "encode/linked_codebooks.h"

#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

constexpr int kRounds = 6;

// On how many edges of a patch a sample lies.
int EdgesAt(int n, int i, int j) { return (i == 0) + (j == 0) + (i + j == n - 1); }

class LinkedGroups {
 public:
  LinkedGroups(const TriangleMesh& mesh, PatchChannels channels, std::span<const MapGroup> groups,
               double edge_weight)
      : channels_(channels), groups_(groups), edge_weight_(edge_weight) {
    places_.resize(mesh.triangles.size());
    links_of_.resize(mesh.triangles.size());
    std::vector<int> edge_samples(mesh.triangles.size(), 0);
    for (size_t g = 0; g < groups.size(); ++g) {
      for (size_t i = 0; i < groups[g].owners.size(); ++i) {
        places_[groups[g].owners[i]] = {g, i};
        edge_samples[groups[g].owners[i]] = groups[g].edge_samples;
      }
      AddScales(groups[g]);
    }
    links_ = FindEdgeLinks(mesh, edge_samples, channels);
    for (size_t i = 0; i < links_.size(); ++i) {
      links_of_[links_[i].triangle].push_back(static_cast<int>(i));
    }
  }

  // Targets in the space in which plain distances count edges as they should; `books` in the
  // groups' units, or none yet.
  WeightedVectors Targets(size_t group, const std::vector<Codebook>& books) const {
    const MapGroup& own = groups_[group];
    const int d = own.vectors.dimensions;
    WeightedVectors targets = own.vectors;
    ParallelFor(
        0, static_cast<int64_t>(own.owners.size()),
        [&](int64_t i) {
          const float* x = own.vectors.values.data() + i * d;
          float* target = targets.values.data() + i * d;
          if (!books.empty()) DrawToNeighbors(own.owners[i], x, books, target);
          for (int k = 0; k < d; ++k) target[k] *= scales_[group][k];
        },
        16);
    return targets;
  }

  void Unscale(size_t group, Codebook& book) const {
    const size_t d = groups_[group].vectors.dimensions;
    for (size_t k = 0; k < book.values.size(); ++k) book.values[k] /= scales_[group][k % d];
  }

  // What is to be made small.
  double Cost(const std::vector<Codebook>& books) const {
    std::vector<double> costs(places_.size(), 0.0);
    ParallelFor(
        0, static_cast<int64_t>(places_.size()),
        [&](int64_t t) {
          if (Samples(t) > 0) costs[t] = TriangleCost(static_cast<int>(t), books);
        },
        16);
    double sum = 0;
    for (const double cost : costs) sum += cost;
    return sum;
  }

 private:
  struct Place {
    size_t group = 0, index = 0;
  };

  int Samples(int64_t triangle) const {
    const Place& place = places_[triangle];
    if (place.group >= groups_.size()) return 0;
    const MapGroup& group = groups_[place.group];
    const bool owns = place.index < group.owners.size() && group.owners[place.index] == triangle;
    return owns ? PatchSampleCount(group.edge_samples) : 0;
  }
  // Of a channel of a sample in a vector.
  int At(int samples, int sample, int channel) const {
    return channels_ == PatchChannels::kCorners ? channel * samples + sample : 3 * sample + channel;
  }

  void AddScales(const MapGroup& group) {
    const int n = group.edge_samples, samples = PatchSampleCount(n);
    std::vector<float>& scales = scales_.emplace_back(group.vectors.dimensions);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const double scale = std::sqrt(1 + edge_weight_ * EdgesAt(n, i, j));
        for (int c = 0; c < 3; ++c) {
          scales[At(samples, PatchSampleIndex(n, i, j), c)] = static_cast<float>(scale);
        }
      }
    }
  }

  const float* CodeOf(int triangle, const std::vector<Codebook>& books) const {
    const Place& place = places_[triangle];
    const Codebook& book = books[place.group];
    return book.values.data() +
           size_t{1} * book.indices[place.index] * groups_[place.group].vectors.dimensions;
  }

  double Shown(const EdgeLink& link, int channel, const std::vector<Codebook>& books) const {
    const int n = groups_[places_[link.neighbor].group].edge_samples;
    const float* code = CodeOf(link.neighbor, books);
    double value = 0;
    for (int i = 0; i < 2; ++i) {
      const int sample = PatchSampleIndex(n, link.other[i].x(), link.other[i].y());
      value += (i == 0 ? 1 - link.share : link.share) *
               static_cast<double>(code[At(PatchSampleCount(n), sample, channel)]);
    }
    return value;
  }

  // target = (x (1 + w (edges - links)) + w sum of what links show) / (1 + w edges).
  void DrawToNeighbors(int triangle, const float* x, const std::vector<Codebook>& books,
                       float* target) const {
    const int n = groups_[places_[triangle].group].edge_samples, samples = PatchSampleCount(n);
    for (const int l : links_of_[triangle]) {
      const EdgeLink& link = links_[l];
      const int sample = PatchSampleIndex(n, link.own.x(), link.own.y());
      const double share =
          edge_weight_ / (1 + edge_weight_ * EdgesAt(n, link.own.x(), link.own.y()));
      for (int c = 0; c < 3; ++c) {
        if (link.channels[c] < 0) continue;
        const int at = At(samples, sample, c);
        target[at] += static_cast<float>(share * (Shown(link, link.channels[c], books) - x[at]));
      }
    }
  }

  double TriangleCost(int triangle, const std::vector<Codebook>& books) const {
    const Place& place = places_[triangle];
    const WeightedVectors& vectors = groups_[place.group].vectors;
    const int n = groups_[place.group].edge_samples, samples = PatchSampleCount(n);
    const float* x = vectors.values.data() + place.index * vectors.dimensions;
    const float* y = CodeOf(triangle, books);
    const int length = vectors.dimensions / vectors.segments;
    const float* weights = vectors.weights.data() + place.index * vectors.segments;
    const auto cost = [&](int at, double wanted) {
      return weights[at / length] * (y[at] - wanted) * (y[at] - wanted);
    };
    double sum = 0;
    for (int at = 0; at < vectors.dimensions; ++at) sum += cost(at, x[at]);
    for (const int l : links_of_[triangle]) {
      const EdgeLink& link = links_[l];
      const int sample = PatchSampleIndex(n, link.own.x(), link.own.y());
      for (int c = 0; c < 3; ++c) {
        const int at = At(samples, sample, c);
        const double wanted = link.channels[c] < 0 ? x[at] : Shown(link, link.channels[c], books);
        sum += edge_weight_ * cost(at, wanted);
      }
    }
    return sum;
  }

  const PatchChannels channels_;
  std::span<const MapGroup> groups_;
  const double edge_weight_;
  std::vector<Place> places_;  // a triangle; of those without a patch the first
  std::vector<std::vector<float>> scales_;
  std::vector<EdgeLink> links_;
  std::vector<std::vector<int>> links_of_;  // a triangle
};

}  // namespace

std::vector<Codebook> QuantizeLinkedGroups(const TriangleMesh& mesh, PatchChannels channels,
                                           std::span<const MapGroup> groups,
                                           std::span<const int> codes,
                                           const LinkedCodebookOptions& options) {
  const LinkedGroups linked(mesh, channels, groups, options.edge_weight);
  std::vector<Codebook> books, best;
  for (size_t g = 0; g < groups.size(); ++g) {
    books.push_back(QuantizeVectors(linked.Targets(g, {}), codes[g], {.start = options.start}));
    linked.Unscale(g, books.back());
  }
  if (!(options.edge_weight > 0)) return books;
  best = books;
  double least = linked.Cost(books);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Codebook> next;
    for (size_t g = 0; g < groups.size(); ++g) {
      next.push_back(ImproveCodebook(linked.Targets(g, books), books[g], {.max_iterations = 3}));
      linked.Unscale(g, next.back());
    }
    books = std::move(next);
    const double cost = linked.Cost(books);
    if (!(cost < least)) continue;
    least = cost;
    best = books;
  }
  return best;
}

}  // namespace lfm
