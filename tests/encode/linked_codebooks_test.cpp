// SPDX-License-Identifier: BSD-3-Clause
#include "encode/linked_codebooks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "resample/light_field.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

// Colours of a smooth function of the surface point, in two patch sizes.
struct Scene {
  TriangleMesh mesh = MakeSphere(2);
  std::vector<MapGroup> groups;
};
Scene MakeScene() {
  Scene scene;
  for (const int n : {5, 9}) {
    MapGroup group{n, {}, {3 * PatchSampleCount(n), 1, {}, {}}, 100, 0};
    for (int t = 0; t < static_cast<int>(scene.mesh.triangles.size()); ++t) {
      if ((t % 3 == 0) != (n == 5)) continue;
      group.owners.push_back(t);
      group.vectors.weights.push_back(1);
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i + j < n; ++i) {
          const Eigen::Vector3d weights = PatchSampleWeights(n, i, j);
          Eigen::Vector3d p = Eigen::Vector3d::Zero();
          for (int c = 0; c < 3; ++c) {
            p += weights[c] * scene.mesh.vertices[scene.mesh.triangles[t][c]];
          }
          for (int c = 0; c < 3; ++c) {
            group.vectors.values.push_back(
                static_cast<float>(std::sin(0.09 * p[c]) + 0.3 * std::cos(0.2 * p[(c + 1) % 3])));
          }
        }
      }
    }
    scene.groups.push_back(std::move(group));
  }
  return scene;
}

struct Errors {
  double jumps = 0, squared = 0;
};
Errors Measure(const Scene& scene, const std::vector<Codebook>& books) {
  std::vector<int> edge_samples(scene.mesh.triangles.size());
  std::vector<const float*> code(scene.mesh.triangles.size());
  Errors errors;
  for (size_t g = 0; g < scene.groups.size(); ++g) {
    const MapGroup& group = scene.groups[g];
    const int d = group.vectors.dimensions;
    for (size_t i = 0; i < group.owners.size(); ++i) {
      edge_samples[group.owners[i]] = group.edge_samples;
      const float* own = books[g].values.data() + size_t{1} * books[g].indices[i] * d;
      code[group.owners[i]] = own;
      for (int k = 0; k < d; ++k) {
        errors.squared += std::pow(own[k] - group.vectors.values[i * d + k], 2);
      }
    }
  }
  for (const EdgeLink& link : FindEdgeLinks(scene.mesh, edge_samples, PatchChannels::kColors)) {
    const auto at = [&](int t, const Eigen::Vector2i& sample, int c) {
      return code[t][3 * PatchSampleIndex(edge_samples[t], sample.x(), sample.y()) + c];
    };
    for (int c = 0; c < 3; ++c) {
      const double other = (1 - link.share) * at(link.neighbor, link.other[0], c) +
                           link.share * at(link.neighbor, link.other[1], c);
      errors.jumps += std::pow(at(link.triangle, link.own, c) - other, 2);
    }
  }
  return errors;
}

TEST(LinkedCodebooks, JumpsFallWithTheirWeightAtLittleLoss) {
  const Scene scene = MakeScene();
  const std::vector<int> codes = {12, 24};
  const auto with = [&](double weight) {
    return Measure(scene, QuantizeLinkedGroups(scene.mesh, PatchChannels::kColors, scene.groups,
                                               codes, {.edge_weight = weight}));
  };
  const Errors plain = with(0);
  double before = plain.jumps;
  for (const double weight : {1.0, 4.0}) {
    const Errors linked = with(weight);
    EXPECT_LT(linked.jumps, 0.8 * before) << weight;
    EXPECT_LT(linked.squared, 1.5 * plain.squared);
    EXPECT_LT(linked.squared + weight * linked.jumps, plain.squared + weight * plain.jumps);
    before = linked.jumps;
  }
}

TEST(LinkedCodebooks, WithoutWeightEachGroupIsByItself) {
  const Scene scene = MakeScene();
  const std::vector<Codebook> books = QuantizeLinkedGroups(
      scene.mesh, PatchChannels::kColors, scene.groups, std::vector<int>{12, 24}, {});
  for (size_t g = 0; g < books.size(); ++g) {
    const Codebook alone = QuantizeVectors(scene.groups[g].vectors, g == 0 ? 12 : 24, {});
    EXPECT_EQ(books[g].indices, alone.indices);
    EXPECT_EQ(books[g].values, alone.values);
  }
}

// As many codes as maps: what changes is that neighbours of different sizes are drawn together,
// which interpolate differently between their samples.
TEST(LinkedCodebooks, EnoughCodesLoseNextToNothing) {
  const Scene scene = MakeScene();
  const std::vector<int> codes = {1000, 1000};
  double energy = 0;
  for (const MapGroup& group : scene.groups) {
    for (const float value : group.vectors.values) energy += static_cast<double>(value) * value;
  }
  const Errors errors =
      Measure(scene, QuantizeLinkedGroups(scene.mesh, PatchChannels::kColors, scene.groups, codes,
                                          {.edge_weight = 4}));
  EXPECT_LE(errors.squared, 1e-4 * energy);
}

TEST(LinkedCodebooks, NoGroupsNoBooks) {
  const Scene scene = MakeScene();
  EXPECT_TRUE(
      QuantizeLinkedGroups(scene.mesh, PatchChannels::kColors, {}, {}, {.edge_weight = 4}).empty());
}

}  // namespace
}  // namespace lfm::testing
