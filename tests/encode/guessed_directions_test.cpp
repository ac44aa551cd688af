// SPDX-License-Identifier: BSD-3-Clause
#include "encode/guessed_directions.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/glb_container.h"
#include "tests/encode/synthetic_light_field.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

constexpr int kGrid = 5;  // 25 bits: the last byte is not full
constexpr const char* kExtension = "LFM_surface_light_field";

/// Directions seen at random; triangle 3 is seen by nobody.
SyntheticLightField RandomlySeen() {
  SyntheticLightField field = MakeLightField(
      MakeSphere(1), kGrid, 20, [](int) { return 3; }, GlossyAppearance);
  std::mt19937 random(7);
  for (auto& triangle : field.triangles) {
    for (auto& weights : triangle.weights) {
      for (uint8_t& seen : weights.seen) seen = random() % 8 == 0 ? 1 : 0;
    }
  }
  field.triangles[3].photos.clear();
  field.triangles[3].values.clear();
  for (auto& weights : field.triangles[3].weights) weights = {};
  return field;
}

TEST(GuessedDirections, AreThoseThatNoTriangleAroundTheVertexSees) {
  const SyntheticLightField field = RandomlySeen();
  const EncodeResult result = Encode(field.Source(), {.terms = 1}, SilentProgress());
  const LightFieldModel& model = result.model;
  EXPECT_EQ(GuessedBytes(kGrid), 4u);
  ASSERT_EQ(model.guessed.size(), 4 * model.mesh.vertices.size());
  int guessed = 0;
  for (int v = 0; v < static_cast<int>(model.mesh.vertices.size()); ++v) {
    for (int q = 0; q < kGrid * kGrid; ++q) {
      bool seen = false;
      for (size_t t = 0; t < field.triangles.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
          const auto& of_corner = field.triangles[t].weights[static_cast<size_t>(c)].seen;
          if (field.mesh.triangles[t][c] == v && !of_corner.empty()) {
            seen = seen || of_corner[static_cast<size_t>(q)] == 1;
          }
        }
      }
      EXPECT_EQ(model.IsGuessed(v, q), !seen) << v << " " << q;
      guessed += seen ? 0 : 1;
    }
  }
  const auto all = static_cast<int>(model.mesh.vertices.size()) * kGrid * kGrid;
  EXPECT_GT(guessed, all / 5);
  EXPECT_LT(guessed, all * 4 / 5);
}

TEST(GuessedDirections, ComeBackFromAGlbAndMayBeAbsent) {
  const ScratchFolder scratch;
  const LightFieldModel model =
      Encode(RandomlySeen().Source(), {.terms = 1}, SilentProgress()).model;
  WriteGlb(model, scratch.folder / "model.glb");
  EXPECT_EQ(ReadGlb(scratch.folder / "model.glb").guessed, model.guessed);
  GlbContainer without = ParseGlb(ReadFile(scratch.folder / "model.glb"), "model.glb");
  without.json["extensions"][kExtension].erase("guessedDirections");
  const LightFieldModel back = ReadGlbBytes(BuildGlb(without), "model.glb");
  EXPECT_TRUE(back.guessed.empty());
  EXPECT_FALSE(back.IsGuessed(0, 0));
}

TEST(GuessedDirections, OfAnotherSizeAreRefused) {
  const ScratchFolder scratch;
  LightFieldModel model = Encode(RandomlySeen().Source(), {.terms = 1}, SilentProgress()).model;
  WriteGlb(model, scratch.folder / "model.glb");
  const GlbContainer good = ParseGlb(ReadFile(scratch.folder / "model.glb"), "model.glb");
  for (const char* other : {"vertexTerms", "frames", "triangles"}) {
    GlbContainer damaged = good;
    auto& extension = damaged.json["extensions"][kExtension];
    extension["guessedDirections"] = extension[other];
    EXPECT_THROW(ReadGlbBytes(BuildGlb(damaged), "model.glb"), Error) << other;
  }
  GlbContainer shorter = good;
  const int index = good.json["extensions"][kExtension]["guessedDirections"].get<int>();
  auto& accessor = shorter.json["accessors"][index];
  accessor["count"] = accessor["count"].get<int>() - 1;
  EXPECT_THROW(ReadGlbBytes(BuildGlb(shorter), "model.glb"), Error);
  model.guessed.pop_back();
  EXPECT_THROW(ValidateModel(model, "shorter"), Error);
  model.guessed.clear();
  EXPECT_NO_THROW(ValidateModel(model, "none"));
}

}  // namespace
}  // namespace lfm::testing
