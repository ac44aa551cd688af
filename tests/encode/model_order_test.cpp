// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/error.h"
#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "encode/model_layout.h"
#include "resample/light_field.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

LightFieldModel Glossy() {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 80, [](int t) { return t % 3 == 0 ? 4 : 7; }, GlossyAppearance);
  return Encode(field.Source(), {.tolerance = 1, .max_terms = 4, .transport_db = 0},
                SilentProgress())
      .model;
}

MeshOrder RandomOrder(const TriangleMesh& mesh, uint32_t seed) {
  MeshOrder order = KeptOrder(mesh);
  std::mt19937 random(seed);
  std::shuffle(order.vertices.begin(), order.vertices.end(), random);
  std::shuffle(order.triangles.begin(), order.triangles.end(), random);
  for (int& turn : order.turns) turn = static_cast<int>(random() % 3);
  return order;
}

TEST(ModelOrder, APatchIsTurnedSampleBySample) {
  for (const int n : {2, 3, 7}) {
    std::vector<uint8_t> values;
    for (int s = 0; s < 2 * PatchSampleCount(n); ++s) values.push_back(static_cast<uint8_t>(s));
    const auto at = [n](const std::vector<uint8_t>& patch, int i, int j) {
      return patch[2 * PatchSampleIndex(n, i, j)];
    };
    EXPECT_EQ(TurnPatch(n, 0, 2, values), values);
    const std::vector<uint8_t> turned = TurnPatch(n, 1, 2, values);
    // Corner 0 is what corner 1 was, and so on: corners lie at (0, 0), (n - 1, 0), (0, n - 1).
    EXPECT_EQ(at(turned, 0, 0), at(values, n - 1, 0));
    EXPECT_EQ(at(turned, n - 1, 0), at(values, 0, n - 1));
    EXPECT_EQ(at(turned, 0, n - 1), at(values, 0, 0));
    EXPECT_EQ(TurnPatch(n, 2, 2, turned), values);
  }
}

// At samples all three interpolations agree, whichever corner comes first.
TEST(ModelOrder, ShowsTheSameInAnyOrder) {
  const LightFieldModel model = Glossy();
  const MeshOrder order = RandomOrder(model.mesh, 3);
  const LightFieldModel other = ReorderModel(model, order);
  EXPECT_NO_THROW(ValidateModel(other, "other"));
  const Eigen::Vector3d to_eye = Eigen::Vector3d(0.2, -0.4, 0.7).normalized();
  for (size_t t = 0; t < order.triangles.size(); ++t) {
    const int n = other.placements[t].edge_samples;
    ASSERT_EQ(n, model.placements[order.triangles[t]].edge_samples);
    for (const auto& [i, j] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, n - 2)}) {
      const Eigen::Vector3d w = PatchSampleWeights(n, i, j);
      Eigen::Vector3d old;
      for (int c = 0; c < 3; ++c) old[(c + order.turns[t]) % 3] = w[c];
      EXPECT_LE((EvaluateModel(other, static_cast<int>(t), w, to_eye) -
                 EvaluateModel(model, order.triangles[t], old, to_eye))
                    .norm(),
                1e-6);
    }
  }
}

TEST(ModelOrder, TheInverseGivesTheModelBack) {
  const LightFieldModel model = Glossy();
  const MeshOrder order = RandomOrder(model.mesh, 4);
  const LightFieldModel back = ReorderModel(ReorderModel(model, order), Inverse(order));
  EXPECT_EQ(back.mesh.vertices, model.mesh.vertices);
  EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
  EXPECT_EQ(back.vertex_terms, model.vertex_terms);
  for (int k = 0; k < model.terms; ++k) {
    EXPECT_EQ(back.view_pages[k].front().Bytes(), model.view_pages[k].front().Bytes());
  }
  const LightFieldModel kept = ReorderModel(model, KeptOrder(model.mesh));
  EXPECT_EQ(kept.mesh.triangles, model.mesh.triangles);
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    EXPECT_EQ(ReadMean(kept, t), ReadMean(model, t)) << t;
  }
}

TEST(ModelOrder, RefusesTheOrderOfAnotherMesh) {
  const LightFieldModel model = Glossy();
  MeshOrder order = KeptOrder(model.mesh);
  order.turns.pop_back();
  EXPECT_THROW(ReorderModel(model, order), Error);
}

}  // namespace
}  // namespace lfm::testing
