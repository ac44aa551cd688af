// SPDX-License-Identifier: BSD-3-Clause
#include "encode/shared_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "resample/light_field.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr double kJump_abs = 1e-6;

struct Patches {
  std::vector<int> edge_samples;
  std::vector<std::vector<float>> values;
  std::vector<PatchValues> Views(int unmeasured = -1) {
    std::vector<PatchValues> views;
    for (auto& v : values) {
      views.push_back({v.data(), static_cast<int>(views.size()) != unmeasured});
    }
    return views;
  }
};

Patches RandomPatches(const TriangleMesh& mesh, const std::vector<int>& sizes, int channels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  Patches patches;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int n = sizes[(t * 5 + 1) % sizes.size()];
    patches.edge_samples.push_back(n);
    auto& values = patches.values.emplace_back(PatchSampleCount(n) * channels);
    for (float& value : values) value = uniform(random);
  }
  return patches;
}

// The patch as a piecewise linear function along its edge, `along` in [0, 1].
double AlongEdge(const std::vector<float>& values, int n, int edge, double along, int channels,
                 int channel) {
  const double x = along * (n - 1);
  const int step = std::min(static_cast<int>(x), n - 2);
  const auto at = [&](int s) { return values[EdgeSampleIndex(n, edge, s) * channels + channel]; };
  return at(step) + (x - step) * (at(step + 1) - at(step));
}

double LargestJump(const TriangleMesh& mesh, const Patches& patches, int channels) {
  const auto neighbors = ComputeTriangleNeighbors(mesh);
  double largest = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const int other = neighbors[t][e];
      if (other < 0) continue;
      int other_edge = 0;
      while (mesh.triangles[other][other_edge] != mesh.triangles[t][(e + 1) % 3]) ++other_edge;
      for (double along = 0; along <= 1; along += 1.0 / 97) {
        for (int c = 0; c < channels; ++c) {
          const double own =
              AlongEdge(patches.values[t], patches.edge_samples[t], e, along, channels, c);
          const double their = AlongEdge(patches.values[other], patches.edge_samples[other],
                                         other_edge, 1 - along, channels, c);
          largest = std::max(largest, std::abs(own - their));
        }
      }
    }
  }
  return largest;
}

TEST(SharedSamples, EdgeIndicesFollowTheBarycentricWeights) {
  for (const int n : {2, 3, 7}) {
    for (int edge = 0; edge < 3; ++edge) {
      for (int step = 0; step < n; ++step) {
        Eigen::Vector3d expected = Eigen::Vector3d::Zero();
        expected[edge] = 1 - static_cast<double>(step) / (n - 1);
        expected[(edge + 1) % 3] = static_cast<double>(step) / (n - 1);
        int found = -1;
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i + j < n; ++i) {
            if ((PatchSampleWeights(n, i, j) - expected).norm() < 1e-12) {
              found = PatchSampleIndex(n, i, j);
            }
          }
        }
        EXPECT_EQ(EdgeSampleIndex(n, edge, step), found) << n << " " << edge << " " << step;
      }
      EXPECT_EQ(CornerSampleIndex(n, edge), EdgeSampleIndex(n, edge, 0));
    }
  }
}

TEST(SharedSamples, SegmentsAreTheGreatestCommonDivisor) {
  const std::vector<Eigen::Vector3i> triangles = {{0, 1, 2}, {2, 1, 3}};
  const std::vector<int> sizes = {13, 9};
  const SharedSamples shared = FindSharedSamples(triangles, sizes);
  ASSERT_EQ(shared.edges.size(), 5u);
  ASSERT_EQ(shared.corners.size(), 4u);
  for (const SharedEdge& edge : shared.edges) {
    if (edge.uses.size() == 2) {
      EXPECT_EQ(edge.segments, 4);
      EXPECT_NE(edge.uses[0].reversed, edge.uses[1].reversed);
    } else {
      EXPECT_EQ(edge.segments, edge.uses[0].edge_samples - 1);
    }
  }
}

TEST(SharedSamples, PatchesOfAnySizesBecomeContinuous) {
  const TriangleMesh mesh = MakeSphere(2);
  for (const auto& sizes : std::vector<std::vector<int>>{
           {9}, {5, 9, 17}, {13, 25, 17, 9}, {2, 3, 4, 5, 6, 7}, {16, 17}}) {
    for (const int channels : {1, 3}) {
      Patches patches = RandomPatches(mesh, sizes, channels);
      const SharedSamples shared = FindSharedSamples(mesh.triangles, patches.edge_samples);
      EXPECT_GT(LargestJump(mesh, patches, channels), 0.5);
      MakeContinuous(shared, channels, patches.Views());
      EXPECT_LE(LargestJump(mesh, patches, channels), kJump_abs);
    }
  }
}

TEST(SharedSamples, LinearFunctionsStayAsTheyAre) {
  const TriangleMesh mesh = MakeSphere(1);
  Patches patches = RandomPatches(mesh, {4, 5, 7, 13}, 1);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int n = patches.edge_samples[t];
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const Eigen::Vector3d w = PatchSampleWeights(n, i, j);
        double sum = 0;
        for (int c = 0; c < 3; ++c) sum += w[c] * mesh.vertices[mesh.triangles[t][c]].x();
        patches.values[t][PatchSampleIndex(n, i, j)] = static_cast<float>(sum);
      }
    }
  }
  const auto before = patches.values;
  MakeContinuous(FindSharedSamples(mesh.triangles, patches.edge_samples), 1, patches.Views());
  for (size_t t = 0; t < before.size(); ++t) {
    for (size_t s = 0; s < before[t].size(); ++s) {
      ASSERT_NEAR(patches.values[t][s], before[t][s], 2e-5);
    }
  }
}

TEST(SharedSamples, EqualSizesAreAveraged) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  Patches patches;
  patches.edge_samples = {3, 3};
  patches.values = {std::vector<float>(6, 1.f), std::vector<float>(6, 2.f)};
  MakeContinuous(FindSharedSamples(mesh.triangles, patches.edge_samples), 1, patches.Views());
  for (int step = 0; step < 3; ++step) {
    EXPECT_FLOAT_EQ(patches.values[0][EdgeSampleIndex(3, 1, step)], 1.5f);
    EXPECT_FLOAT_EQ(patches.values[1][EdgeSampleIndex(3, 0, step)], 1.5f);
  }
  EXPECT_FLOAT_EQ(patches.values[0][CornerSampleIndex(3, 0)], 1.f);
}

TEST(SharedSamples, UnmeasuredPatchesTakeAndDoNotGive) {
  const TriangleMesh mesh = MakeSphere(1);
  Patches patches = RandomPatches(mesh, {9}, 1);
  for (size_t t = 0; t < patches.values.size(); ++t) {
    std::fill(patches.values[t].begin(), patches.values[t].end(), t == 7 ? 100.f : 1.f);
  }
  MakeContinuous(FindSharedSamples(mesh.triangles, patches.edge_samples), 1, patches.Views(7));
  for (size_t t = 0; t < patches.values.size(); ++t) {
    if (t == 7) continue;
    for (const float value : patches.values[t]) ASSERT_EQ(value, 1.f);
  }
  for (int edge = 0; edge < 3; ++edge) {
    for (int step = 0; step < 9; ++step) {
      EXPECT_EQ(patches.values[7][EdgeSampleIndex(9, edge, step)], 1.f);
    }
  }
}

TEST(SharedSamples, RunningTwiceChangesNothingMore) {
  const TriangleMesh mesh = MakeSphere(1);
  Patches patches = RandomPatches(mesh, {5, 9, 7, 17}, 1);
  const SharedSamples shared = FindSharedSamples(mesh.triangles, patches.edge_samples);
  MakeContinuous(shared, 1, patches.Views());
  const auto once = patches.values;
  MakeContinuous(shared, 1, patches.Views());
  for (size_t t = 0; t < once.size(); ++t) {
    for (size_t s = 0; s < once[t].size(); ++s) ASSERT_NEAR(patches.values[t][s], once[t][s], 1e-6);
  }
}

// The finer patch alone decides where its neighbour is unmeasured: its nodes are the fit that no
// change of a node improves.
TEST(SharedSamples, NodesAreALeastSquaresFit) {
  const std::vector<Eigen::Vector3i> triangles = {{0, 1, 2}, {2, 1, 3}};
  const int n = 13, coarse = 5;
  std::vector<float> fine(PatchSampleCount(n)), other(PatchSampleCount(coarse));
  for (size_t k = 0; k < fine.size(); ++k) fine[k] = static_cast<float>((k * 37) % 11);
  const std::vector<float> before = fine;
  const std::vector<PatchValues> patches = {{fine.data(), true}, {other.data(), false}};
  MakeContinuous(FindSharedSamples(triangles, std::vector<int>{n, coarse}), 1, patches);
  const auto error = [&](int node, double change) {
    double sum = 0;
    for (int step = 0; step < n; ++step) {
      const int sample = EdgeSampleIndex(n, 1, step);
      const double hat = std::max(0.0, 1 - std::abs(step / 3.0 - node));
      sum += std::pow(fine[sample] + change * hat - before[sample], 2);
    }
    return sum;
  };
  for (int node = 1; node < 4; ++node) {
    EXPECT_LT(error(node, 0), error(node, 0.01));
    EXPECT_LT(error(node, 0), error(node, -0.01));
  }
}

TEST(SharedSamples, CodesDifferByHalfACodeAtMost) {
  const TriangleMesh mesh = MakeSphere(2);
  Patches patches = RandomPatches(mesh, {5, 9, 17, 7, 13}, 1);
  const SharedSamples shared = FindSharedSamples(mesh.triangles, patches.edge_samples);
  MakeContinuous(shared, 1, patches.Views());
  std::vector<std::vector<uint8_t>> codes;
  std::vector<uint8_t*> pointers;
  for (const auto& values : patches.values) {
    auto& c = codes.emplace_back();
    for (const float value : values) c.push_back(static_cast<uint8_t>(std::lround(255 * value)));
    pointers.push_back(c.data());
  }
  MakeCodesContinuous(shared, 1, pointers);
  for (size_t t = 0; t < codes.size(); ++t) {
    std::copy(codes[t].begin(), codes[t].end(), patches.values[t].begin());
  }
  // Half a code on either side, where both sides are finer than their nodes.
  EXPECT_LE(LargestJump(mesh, patches, 1), 1.0 + 1e-6);
}

}  // namespace
}  // namespace lfm::testing
