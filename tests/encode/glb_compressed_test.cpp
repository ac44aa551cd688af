// SPDX-License-Identifier: BSD-3-Clause
// Codebooks and blocks in model.glb.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/glb_container.h"
#include "encode/glb_format.h"
#include "encode/model_evaluation.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

LightFieldModel MakeModel(const MapCompressionOptions& compression, int terms = 2) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(2), 8, 40, [](int t) { return t % 2 == 0 ? 5 : 3; }, GlossyAppearance);
  return Encode(field.Source(),
                {.terms = terms,
                 .transport_db = 0,
                 .max_texture_size = 256,
                 .compression = compression},
                SilentProgress())
      .model;
}

class GlbCompressed : public ::testing::Test {
 protected:
  GlbCompressed()
      : folder_(fs::temp_directory_path() /
                ("lfm_glb_compressed_test_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~GlbCompressed() override { fs::remove_all(folder_); }
  std::string Written(const LightFieldModel& model) {
    WriteGlb(model, folder_ / "model.glb");
    return ReadFile(folder_ / "model.glb");
  }
  fs::path folder_;
};

const MapCompressionOptions kKinds[] = {{.vq_ratio = 3},
                                        {.blocks = PageBlocks::kBc1},
                                        {.blocks = PageBlocks::kBc4},
                                        {.vq_ratio = 3, .blocks = PageBlocks::kBc1},
                                        {.vq_ratio = 3, .blocks = PageBlocks::kBc4}};

TEST_F(GlbCompressed, ComesBackBitByBit) {
  for (const MapCompressionOptions& kind : kKinds) {
    const LightFieldModel model = MakeModel(kind);
    const std::string bytes = Written(model);
    const LightFieldModel back = ReadGlbBytes(bytes, "model.glb");
    EXPECT_EQ(back.MapsBytes(), model.MapsBytes());
    EXPECT_EQ(back.view_codes, model.view_codes);
    EXPECT_EQ(back.surface_placements.size(), model.surface_placements.size());
    EXPECT_EQ(back.blocks.empty(), model.blocks.empty());
    for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
      const Eigen::Vector3d to_eye = TriangleNormal(model.mesh, t);
      EXPECT_LE((EvaluateModel(back, t, {0.5, 0.2, 0.3}, to_eye) -
                 EvaluateModel(model, t, {0.5, 0.2, 0.3}, to_eye))
                    .norm(),
                1e-5);
    }
    EXPECT_EQ(Written(back), bytes);
  }
}

// Other viewers: the mean view that blocks decode to, as a picture.
TEST_F(GlbCompressed, OtherViewersGetTheMeanViewAsPictures) {
  for (const MapCompressionOptions& kind : kKinds) {
    const LightFieldModel model = MakeModel(kind);
    const GlbContainer glb = ParseGlb(Written(model), "model.glb");
    const json& image = glb.json["images"][glb.json["textures"][0]["source"].get<int>()];
    const json& view = glb.json["bufferViews"][image["bufferView"].get<int>()];
    const Image picture = DecodeImage(
        reinterpret_cast<const std::byte*>(glb.binary.data()) + view["byteOffset"].get<size_t>(),
        view["byteLength"].get<size_t>(), "mean");
    EXPECT_EQ(picture.Bytes(), model.mean_pages[0].Bytes());
  }
}

TEST_F(GlbCompressed, PassesTheValidator) {
  const fs::path modules = LFM_NODE_MODULES;
  ASSERT_TRUE(fs::exists(modules / "gltf-validator")) << "run scripts/install-deps";
  for (const MapCompressionOptions& kind : kKinds) {
    WriteGlb(MakeModel(kind), folder_ / "model.glb");
    const std::string command = "node '" LFM_SOURCE_DIR "/tests/encode/validate_glb.cjs' '" +
                                modules.string() + "' '" + (folder_ / "model.glb").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
}

TEST_F(GlbCompressed, MeanViewAloneMayBeShared) {
  const LightFieldModel model = MakeModel({.vq_ratio = 4}, 0);
  const LightFieldModel back = ReadGlbBytes(Written(model), "model.glb");
  EXPECT_EQ(back.MapsBytes(), model.MapsBytes());
  EXPECT_TRUE(back.surface_placements.empty());
}

std::string Changed(const std::string& bytes, const std::function<void(json& extension)>& change) {
  GlbContainer glb = ParseGlb(bytes, "model.glb");
  change(glb.json["extensions"][glb::kExtension]);
  return BuildGlb(glb);
}

TEST_F(GlbCompressed, HostileTablesAreErrors) {
  const std::string bytes = Written(MakeModel({.vq_ratio = 3, .blocks = PageBlocks::kBc1}));
  EXPECT_NO_THROW(ReadGlbBytes(bytes, "x"));
  const std::vector<std::function<void(json&)>> changes = {
      [](json& e) { e["meanCodebook"] = 3; },
      [](json& e) { e["meanCodebook"].erase("indices"); },
      [](json& e) { e["meanCodebook"]["indices"] = e["vertices"]; },
      [](json& e) { e["meanCodebook"]["indices"] = e["viewIndices"][0]; },
      [](json& e) { e["meanCodebook"]["placements"] = -1; },
      [](json& e) { e.erase("meanCodebook"); },
      [](json& e) { e["surfaceCodebooks"].erase(1); },
      [](json& e) { e["surfaceCodebooks"] = 7; },
      [](json& e) {
        std::swap(e["surfaceCodebooks"][0]["indices"], e["surfaceCodebooks"][0]["placements"]);
      },
      [](json& e) { e.erase("viewIndices"); },
      [](json& e) { e["viewIndices"][0] = e["surfaceCodebooks"][0]["indices"]; },
      [](json& e) { e["viewTilesPerPage"] = 1; },
      [](json& e) { e["viewTilesPerRow"] = 16384; },
      [](json& e) { e["grid"] = 256; },
      [](json& e) { e["blocks"] = json::array(); },
      [](json& e) { e["blocks"]["surfaceFormat"] = "bc7"; },
      [](json& e) { e["blocks"]["surfaceFormat"] = "bc4"; },
      [](json& e) { e["blocks"].erase("view"); },
      [](json& e) { e["blocks"]["mean"] = json::array(); },
      [](json& e) { e["blocks"]["mean"][0]["width"] = 16384; },
      [](json& e) { e["blocks"]["mean"][0]["width"] = 0; },
      [](json& e) { e["blocks"]["mean"][0]["height"] = 6; },
      [](json& e) { e["blocks"]["surface"][0][0]["bufferView"] = 100000; },
      [](json& e) { e["blocks"]["surface"][1] = json::array(); },
      [](json& e) { e["blocks"]["view"][0] = json::array(); },
      [](json& e) { e["version"] = 1; },
      [](json& e) { e["version"] = 5; },
      [](json& e) { e["viewTileCounts"] = 3; },
      [](json& e) { e["viewTileCounts"] = json::array(); },
      [](json& e) {
        e["viewTileCounts"] = json::array({{1, 2}, {1, 2}, {1, 2}});
      },
      [](json& e) {
        e["viewTileCounts"] = json::array({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
      },
      [](json& e) {
        e["viewTileCounts"] = json::array({{-1, 0, 0}, {9, 0, 0}, {9, 0, 0}});
      },
      [](json& e) {
        e["viewTileCounts"] = json::array({{1.5, 0, 0}, {9, 0, 0}, {9, 0, 0}});
      },
      [](json& e) {
        e["viewTileCounts"] = json::array({{0, 0, 1 << 27}, {9, 0, 0}, {9, 0, 0}});
      },
      [](json& e) {
        e["viewTileCounts"] = json::array({{0, 1u << 31, 0}, {9, 0, 0}, {9, 0, 0}});
      }};
  for (size_t i = 0; i < changes.size(); ++i) {
    EXPECT_THROW(ReadGlbBytes(Changed(bytes, changes[i]), "x"), Error) << i;
  }
}

// Any byte of the binary chunk may be wrong: an error, or a model that is safe to evaluate.
TEST_F(GlbCompressed, DamagedBytesAreSafe) {
  const std::string bytes = Written(MakeModel({.vq_ratio = 3, .blocks = PageBlocks::kBc4}));
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    std::string damaged = bytes;
    for (int i = 0; i < 4; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
    try {
      const LightFieldModel model = ReadGlbBytes(damaged, "damaged.glb");
      for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
        const Eigen::Vector3f color =
            EvaluateModel(model, t, {0.2, 0.3, 0.5}, Eigen::Vector3d(0, 0.6, 0.8));
        ASSERT_TRUE(color.allFinite());
      }
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).rfind("damaged.glb: ", 0), 0U) << error.what();
    }
  }
  for (size_t size = 0; size < bytes.size(); size += 97) {
    EXPECT_THROW(ReadGlbBytes(std::string_view(bytes).substr(0, size), "x"), Error);
  }
}

}  // namespace
}  // namespace lfm::testing
