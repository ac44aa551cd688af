// SPDX-License-Identifier: BSD-3-Clause
// The mean view of model.glb, read without its terms.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "core/error.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/glb_container.h"
#include "encode/glb_format.h"
#include "encode/model_evaluation.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

using nlohmann::json;

LightFieldModel MakeModel(const EncodeOptions& options, int levels = 1) {
  EncodeOptions own = options;
  own.transport_db = 0;
  own.max_texture_size = 256;
  const SyntheticLightField field = MakeLightField(
      MakeSphere(levels), 8, 40, [](int t) { return t % 2 == 0 ? 5 : 3; }, GlossyAppearance);
  return Encode(field.Source(), own, SilentProgress()).model;
}

LightFieldModel Mean(const std::string& bytes) {
  return ReadGlbBytes(bytes, "model.glb", GlbContent::kMeanView);
}

std::vector<LightFieldModel> ModelsOfEveryForm() {
  return {MakeModel({.terms = 2}),
          MakeModel({.terms = 0}),
          MakeModel({.factorization = Factorization::kNmf, .terms = 2}),
          MakeModel({.term_gain = 0.5}),
          MakeModel({.terms = 2, .compression = {.vq_ratio = 3}}),
          MakeModel({.terms = 0, .compression = {.vq_ratio = 4}}),
          MakeModel({.terms = 2, .compression = {.blocks = PageBlocks::kBc1}}),
          MakeModel({.terms = 2, .compression = {.vq_ratio = 3, .blocks = PageBlocks::kBc4}})};
}

void ForEachPlace(const LightFieldModel& model,
                  const std::function<void(int t, const Eigen::Vector3d& weights,
                                           const Eigen::Vector3d& to_eye)>& visit) {
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    for (const Eigen::Vector3d& weights :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1),
          Eigen::Vector3d(0, 0.5, 0.5), Eigen::Vector3d(0.2, 0.5, 0.3)}) {
      visit(t, weights, TriangleNormal(model.mesh, t));
    }
  }
}

TEST(GlbMeanView, ShowsWhatTheWholeModelShowsWithoutTerms) {
  int forms = 0;
  bool own_grids = false, in_terms = false, shared = false, blocks = false;
  for (const LightFieldModel& model : ModelsOfEveryForm()) {
    const std::string bytes = GlbBytes(model);
    const LightFieldModel whole = ReadGlbBytes(bytes, "model.glb"), mean = Mean(bytes);
    own_grids = own_grids || !whole.view_tile_counts.empty();
    in_terms = in_terms || whole.mean_in_terms;
    shared = shared || !whole.view_codes.empty();
    blocks = blocks || !whole.blocks.empty();
    EXPECT_NO_THROW(ValidateModel(mean, "mean"));
    EXPECT_EQ(mean.terms, 0);
    EXPECT_FALSE(mean.mean_in_terms);
    EXPECT_EQ(mean.blocks.empty(), whole.blocks.empty());
    EXPECT_EQ(mean.mesh.triangles, whole.mesh.triangles);
    EXPECT_EQ(mean.mesh.vertices, whole.mesh.vertices);
    EXPECT_EQ(mean.mesh.normals, whole.mesh.normals);
    EXPECT_EQ(mean.guessed, whole.guessed);
    double of_terms = 0;
    ForEachPlace(whole, [&](int t, const Eigen::Vector3d& weights, const Eigen::Vector3d& to_eye) {
      const Eigen::Vector3f shown = EvaluateModel(mean, t, weights, to_eye);
      ASSERT_EQ(shown, EvaluateModel(whole, t, weights, to_eye, {.terms = 0})) << forms;
      of_terms += (EvaluateModel(whole, t, weights, to_eye) - shown).norm();
    });
    EXPECT_EQ(of_terms > 0, whole.terms > 0) << forms;
    // It is a model by itself.
    EXPECT_EQ(ReadGlbBytes(GlbBytes(mean), "mean.glb").MapsBytes(), mean.MapsBytes());
    ++forms;
  }
  EXPECT_TRUE(own_grids && in_terms && shared && blocks);
}

// Pages of terms are not decoded: damage there does not show. Damage to the mean view does.
TEST(GlbMeanView, LooksIntoNoOtherPictures) {
  const std::string bytes = GlbBytes(MakeModel({.terms = 1}, 0));
  const GlbContainer good = ParseGlb(bytes, "model.glb");
  const json& images = good.json["images"];
  const size_t mean_images = good.json["extensions"][glb::kExtension]["meanImages"].size();
  ASSERT_GT(images.size(), mean_images);
  for (size_t i = 0; i < images.size(); ++i) {
    GlbContainer damaged = good;
    const json& view = good.json["bufferViews"][images[i]["bufferView"].get<int>()];
    const size_t data = good.binary.find("IDAT", view["byteOffset"].get<size_t>()) + 4;
    damaged.binary.replace(data, 4, "\xff\xff\xff\xff");
    const std::string file = BuildGlb(damaged);
    EXPECT_THROW(ReadGlbBytes(file, "model.glb"), Error) << i;
    if (i < mean_images) {
      EXPECT_THROW(Mean(file), Error) << i;
    } else {
      EXPECT_EQ(Mean(file).mean_pages.at(0).Bytes(), Mean(bytes).mean_pages.at(0).Bytes()) << i;
    }
  }
}

// Of files that end early, lack a key, or say something else of a term's pages.
TEST(GlbMeanView, RefusesWhatTheWholeReaderRefuses) {
  for (const MapCompressionOptions& compression :
       {MapCompressionOptions{},
        MapCompressionOptions{.vq_ratio = 3, .blocks = PageBlocks::kBc1}}) {
    const std::string bytes = GlbBytes(MakeModel({.terms = 2, .compression = compression}, 0));
    EXPECT_NO_THROW(Mean(bytes));
    for (size_t size = 0; size < bytes.size(); size += 13) {
      EXPECT_THROW(Mean(bytes.substr(0, size)), Error) << size;
    }
    EXPECT_THROW(Mean(bytes + "tail"), Error);
    const GlbContainer good = ParseGlb(bytes, "model.glb");
    int refused = 0;
    for (const auto& [key, value] : good.json["extensions"][glb::kExtension].items()) {
      GlbContainer lacking = good;
      lacking.json["extensions"][glb::kExtension].erase(key);
      const std::string file = BuildGlb(lacking);
      try {
        ReadGlbBytes(file, "model.glb");
      } catch (const Error&) {
        EXPECT_THROW(Mean(file), Error) << key;
        ++refused;
      }
    }
    EXPECT_GT(refused, 10);
  }
  const std::string bytes = GlbBytes(MakeModel({.terms = 2}, 0));
  const GlbContainer good = ParseGlb(bytes, "model.glb");
  const std::vector<std::function<void(json&)>> changes = {
      [](json& e) { e["surfaceImages"].erase(1); },
      [](json& e) { e["viewImages"][0] = 3; },
      [](json& e) { e["viewImages"][0] = json::array({100000}); },
      [](json& e) { e["surfaceRanges"] = e["vertices"]; },
      [](json& e) { e["viewRanges"] = -1; },
      [](json& e) { e["vertexTerms"] = e["frames"]; },
      [](json& e) { e["meanInTerms"] = 1; },
      [](json& e) { e["terms"] = 3; },
      [](json& e) { e["terms"] = 0; }};
  for (size_t i = 0; i < changes.size(); ++i) {
    GlbContainer changed = good;
    changes[i](changed.json["extensions"][glb::kExtension]);
    EXPECT_THROW(ReadGlbBytes(BuildGlb(changed), "model.glb"), Error) << i;
    EXPECT_THROW(Mean(BuildGlb(changed)), Error) << i;
  }
  // The last picture, of view maps, says that it is larger than all pages may be.
  GlbContainer large = good;
  large.binary.replace(good.binary.rfind("IHDR") + 4, 8, std::string("\0\0\x40\0\0\0\x40\0", 8));
  EXPECT_THROW(Mean(BuildGlb(large)), Error);
}

// Any byte may be wrong: an error, or a model without terms that is safe to look at.
TEST(GlbMeanView, DamagedBytesAreSafe) {
  for (const MapCompressionOptions& compression :
       {MapCompressionOptions{},
        MapCompressionOptions{.vq_ratio = 3, .blocks = PageBlocks::kBc4}}) {
    const std::string bytes = GlbBytes(MakeModel({.terms = 2, .compression = compression}, 0));
    std::mt19937 random(5);
    int accepted = 0, refused = 0;
    for (int round = 0; round < 1000; ++round) {
      std::string damaged = bytes;
      for (int i = 0; i < 3; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
      try {
        const LightFieldModel mean = Mean(damaged);
        EXPECT_EQ(mean.terms, 0);
        ForEachPlace(mean, [&](int t, const Eigen::Vector3d& weights, const Eigen::Vector3d&) {
          ASSERT_TRUE(EvaluateModel(mean, t, weights, {0, 0.6, 0.8}).allFinite());
        });
        ++accepted;
      } catch (const Error& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with("model.glb: ")) << error.what();
        ++refused;
      }
    }
    EXPECT_GT(accepted, 0);
    EXPECT_GT(refused, 0);
  }
}

}  // namespace
}  // namespace lfm::testing
