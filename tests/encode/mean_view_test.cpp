// SPDX-License-Identifier: BSD-3-Clause
#include "encode/mean_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

MeanView MeanOf(const SyntheticLightField& field, double guessed_weight) {
  std::vector<int> sizes;
  for (const auto& triangle : field.triangles) sizes.push_back(triangle.edge_samples);
  return ComputeMeanView(field.Source(), FindSharedSamples(field.mesh.triangles, sizes),
                         guessed_weight, SilentProgress());
}

SyntheticLightField Glossy() {
  return MakeLightField(
      MakeSphere(1), 8, 60, [](int) { return 7; }, GlossyAppearance);
}

// By the definition: seen directions count one, guessed ones less, over the three corners.
TEST(MeanView, IsTheWeightedMeanOverTheGrids) {
  const SyntheticLightField field = Glossy();
  for (const double guessed : {0.1, 1.0}) {
    const MeanView view = MeanOf(field, guessed);
    for (int t = 0; t < 4; ++t) {
      const int sample = PatchSampleIndex(7, 2, 2);  // inside: no neighbour has a say
      for (int channel = 0; channel < 3; ++channel) {
        double sum = 0, total = 0;
        for (int corner = 0; corner < 3; ++corner) {
          for (int q = 0; q < 64; ++q) {
            const double weight = field.triangles[t].weights[corner].seen[q] ? 1 : guessed;
            sum += weight * ResampledValue(field, t, corner, sample, channel, q);
            total += weight;
          }
        }
        EXPECT_NEAR(view.codes[t][3 * sample + channel], 255 * sum / total, 0.51);
      }
    }
  }
}

TEST(MeanView, SharedSamplesAreEqual) {
  const SyntheticLightField field = Glossy();
  const MeanView view = MeanOf(field, 0.2);
  const std::vector<int> sizes(field.triangles.size(), 7);
  const SharedSamples shared = FindSharedSamples(field.mesh.triangles, sizes);
  for (const SharedEdge& edge : shared.edges) {
    ASSERT_EQ(edge.uses.size(), 2u);
    for (int step = 0; step < 7; ++step) {
      const auto sample = [&](const EdgeUse& use) {
        return 3 * EdgeSampleIndex(7, use.edge, use.reversed ? 6 - step : step);
      };
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(view.codes[edge.uses[0].patch][sample(edge.uses[0]) + c],
                  view.codes[edge.uses[1].patch][sample(edge.uses[1]) + c]);
      }
    }
  }
}

TEST(MeanView, CompletionsStayInRangeWhereColorsSaturate) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 60, [](int t) { return t % 2 == 0 ? 9 : 17; },
      [](const Eigen::Vector3d& p, const Eigen::Vector3d&) -> Eigen::Vector3d {
        return Eigen::Vector3d::Constant(0.5 + std::sin(0.09 * p.x()) * std::sin(0.11 * p.z()));
      });
  const MeanView view = MeanOf(field, 0.2);
  int worst = 0, touched = 0;
  for (size_t t = 0; t < view.codes.size(); ++t) {
    const int n = field.triangles[t].edge_samples;
    for (int i = 0; i <= n - 2; ++i) {
      const int j = n - 2 - i;
      const int a = view.codes[t][3 * PatchSampleIndex(n, i, j)];
      const int b = view.codes[t][3 * PatchSampleIndex(n, i + 1, j)];
      const int c = view.codes[t][3 * PatchSampleIndex(n, i, j + 1)];
      worst = std::max({worst, b + c - a - 255, a - b - c});
      touched += b + c - a >= 250 || b + c - a <= 5;
    }
  }
  EXPECT_GT(touched, 50);
  EXPECT_LE(worst, 4);
}

TEST(MeanView, ImputedValuesAboveOneAreClamped) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(0), 4, 40, [](int) { return 4; },
      [](const Eigen::Vector3d&, const Eigen::Vector3d&) -> Eigen::Vector3d {
        return Eigen::Vector3d::Constant(1.7);
      });
  for (const auto& codes : MeanOf(field, 0.2).codes) {
    for (const uint8_t code : codes) ASSERT_EQ(code, 255);
  }
}

TEST(SpreadVertexColors, FillsHolesSmoothlyAndIslandsWithTheMean) {
  TriangleMesh mesh = MakeSphere(2);
  const int island = static_cast<int>(mesh.vertices.size());
  for (int k = 0; k < 3; ++k) mesh.vertices.push_back({200.0 + k, 200.0 * k, 0});
  mesh.triangles.push_back({island, island + 1, island + 2});
  std::vector<Eigen::Vector3f> colors(mesh.vertices.size(), Eigen::Vector3f::Zero());
  std::vector<uint8_t> known(mesh.vertices.size(), 0);
  for (size_t v = 0; v + 3 < mesh.vertices.size(); ++v) {
    known[v] = mesh.vertices[v].z() < 20;
    if (known[v]) colors[v] = Eigen::Vector3f::Constant(mesh.vertices[v].x() > 0 ? 0.8f : 0.4f);
  }
  const auto filled = SpreadVertexColors(mesh, colors, known);
  for (size_t v = 0; v < filled.size(); ++v) {
    if (known[v]) {
      EXPECT_EQ(filled[v], colors[v]);
    } else {
      EXPECT_GE(filled[v].minCoeff(), 0.399f);
      EXPECT_LE(filled[v].maxCoeff(), 0.801f);
    }
  }
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  int count = 0;
  for (size_t v = 0; v < filled.size(); ++v) {
    if (known[v]) mean += colors[v];
    count += known[v];
  }
  EXPECT_LE((filled[island] - mean / static_cast<float>(count)).norm(), 1e-5);
}

TEST(SpreadVertexColors, NothingKnownChangesNothing) {
  const TriangleMesh mesh = MakeSphere(0);
  const std::vector<Eigen::Vector3f> colors(6, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(SpreadVertexColors(mesh, colors, std::vector<uint8_t>(6, 0)), colors);
}

}  // namespace
}  // namespace lfm::testing
