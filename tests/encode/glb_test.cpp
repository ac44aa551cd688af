// SPDX-License-Identifier: BSD-3-Clause
#include "encode/glb.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/encode.h"
#include "encode/glb_container.h"
#include "encode/model_evaluation.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

namespace fs = std::filesystem;

LightFieldModel MakeModel(int levels, int grid, int terms, int max_texture_size = 4096) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(levels), grid, 40, [](int t) { return t % 2 == 0 ? 5 : 3; }, GlossyAppearance);
  return Encode(field.Source(), {.terms = terms, .max_texture_size = max_texture_size},
                SilentProgress())
      .model;
}

class Glb : public ::testing::Test {
 protected:
  Glb() : folder_(fs::temp_directory_path() / ("lfm_glb_test_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Glb() override { fs::remove_all(folder_); }
  std::string Written(const LightFieldModel& model) {
    WriteGlb(model, folder_ / "model.glb");
    return ReadFile(folder_ / "model.glb");
  }
  fs::path folder_;
};

void ExpectEqualPages(const std::vector<Image>& a, const std::vector<Image>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].width(), b[i].width());
    EXPECT_EQ(a[i].Bytes(), b[i].Bytes());
  }
}

void ExpectEqualRanges(const std::vector<MapRange>& a, const std::vector<MapRange>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].scale, b[i].scale);
    EXPECT_EQ(a[i].bias, b[i].bias);
  }
}

TEST_F(Glb, ComesBackBitByBit) {
  const LightFieldModel model = MakeModel(2, 8, 2, 256);
  const fs::path file = folder_ / "model.glb";
  const int64_t size = WriteGlb(model, file);
  EXPECT_EQ(size, static_cast<int64_t>(fs::file_size(file)));
  const LightFieldModel back = ReadGlb(file);
  ExpectEqualPages(back.mean_pages, model.mean_pages);
  ASSERT_EQ(back.terms, 2);
  for (int k = 0; k < 2; ++k) {
    ExpectEqualPages(back.surface_pages[k], model.surface_pages[k]);
    ExpectEqualPages(back.view_pages[k], model.view_pages[k]);
  }
  ExpectEqualRanges(back.surface_ranges, model.surface_ranges);
  ExpectEqualRanges(back.view_ranges, model.view_ranges);
  EXPECT_EQ(back.vertex_terms, model.vertex_terms);
  EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
  EXPECT_EQ(back.direction_map, model.direction_map);
  EXPECT_EQ(back.grid, model.grid);
  EXPECT_EQ(back.MapsBytes(), model.MapsBytes());
  for (size_t v = 0; v < model.vertex_frames.size(); ++v) {
    EXPECT_LE((back.mesh.vertices[v] - model.mesh.vertices[v]).norm(), 1e-5);
    EXPECT_LE((back.vertex_frames[v] - model.vertex_frames[v]).norm(), 1e-6);
  }
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    EXPECT_EQ(back.placements[t].page, model.placements[t].page);
    EXPECT_EQ(back.placements[t].origin, model.placements[t].origin);
    EXPECT_EQ(back.placements[t].flipped, model.placements[t].flipped);
    EXPECT_EQ(back.placements[t].edge_samples, model.placements[t].edge_samples);
    const Eigen::Vector3d to_eye = TriangleNormal(model.mesh, t);
    EXPECT_LE((EvaluateModel(back, t, {0.5, 0.2, 0.3}, to_eye) -
               EvaluateModel(model, t, {0.5, 0.2, 0.3}, to_eye))
                  .norm(),
              1e-5);
  }
}

TEST_F(Glb, WritesTheSameBytesTwice) {
  const LightFieldModel model = MakeModel(1, 6, 2);
  EXPECT_EQ(Written(model), Written(model));
}

TEST_F(Glb, HoldsAModelWithoutTerms) {
  const LightFieldModel model = MakeModel(1, 6, 0);
  const LightFieldModel back = ReadGlbBytes(Written(model), "model.glb");
  EXPECT_EQ(back.terms, 0);
  ExpectEqualPages(back.mean_pages, model.mean_pages);
}

// The plain mesh of any glTF viewer: corners at the centres of their samples' texels, and the
// object upright, in metres.
TEST_F(Glb, PlainMeshPointsAtTheCornerSamples) {
  const LightFieldModel model = MakeModel(1, 6, 1);
  const std::string bytes = Written(model);
  const GlbContainer glb = ParseGlb(bytes, "model.glb");
  const auto floats = [&](const std::string& attribute) {
    const int index = glb.json["meshes"][0]["primitives"][0]["attributes"][attribute];
    const auto& accessor = glb.json["accessors"][index];
    const auto& view = glb.json["bufferViews"][accessor["bufferView"].get<int>()];
    const auto* begin =
        reinterpret_cast<const float*>(glb.binary.data() + view["byteOffset"].get<size_t>());
    return std::vector<float>(begin, begin + view["byteLength"].get<size_t>() / sizeof(float));
  };
  const std::vector<float> uv = floats("TEXCOORD_0"), position = floats("POSITION");
  ASSERT_EQ(uv.size(), 6 * model.placements.size());
  const Image& page = model.mean_pages[0];
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    for (int c = 0; c < 3; ++c) {
      const float x = uv[2 * (3 * t + c)] * page.width() - 0.5f;
      const float y = uv[2 * (3 * t + c) + 1] * page.height() - 0.5f;
      ASSERT_NEAR(x, std::round(x), 1e-3);
      ASSERT_NEAR(y, std::round(y), 1e-3);
      const Eigen::Vector3f shown =
          EvaluateModel(model, t, Eigen::Vector3d::Unit(c), {0, 0, 1}, {0});
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(255 * shown[channel], page.At<uint8_t>(std::lround(x), std::lround(y), channel),
                    1e-3);
        EXPECT_FLOAT_EQ(
            position[3 * (3 * t + c) + channel],
            static_cast<float>(model.mesh.vertices[model.mesh.triangles[t][c]][channel]));
      }
    }
  }
  const auto& node = glb.json["nodes"][0];
  const Eigen::Quaterniond rotation(
      node["rotation"][3].get<double>(), node["rotation"][0].get<double>(),
      node["rotation"][1].get<double>(), node["rotation"][2].get<double>());
  EXPECT_LE((rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_EQ(node["scale"], nlohmann::json({0.001, 0.001, 0.001}));
}

TEST_F(Glb, RefusesEveryTruncatedPrefix) {
  const std::string bytes = Written(MakeModel(0, 3, 1));
  for (size_t length = 0; length < bytes.size(); ++length) {
    const std::string prefix(bytes.data(), length);  // a block of exactly this size
    ASSERT_THROW(ReadGlbBytes(prefix, "model.glb"), Error) << length;
  }
  EXPECT_NO_THROW(ReadGlbBytes(bytes, "model.glb"));
  EXPECT_THROW(ReadGlbBytes(bytes + "tail", "model.glb"), Error);
}

// Refuses, or returns something that is safe to evaluate everywhere.
bool AcceptedSafely(const std::string& bytes) {
  LightFieldModel model;
  try {
    model = ReadGlbBytes(bytes, "model.glb");
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("model.glb: ", 0), 0U) << error.what();
    return false;
  }
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    for (const Eigen::Vector3d& w : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0),
                                     Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0.5, 0.5)}) {
      const Eigen::Vector3f color = EvaluateModel(model, t, w, {0, 0, 1});
      EXPECT_TRUE(color.allFinite());
    }
  }
  return true;
}

TEST_F(Glb, SurvivesFlippedBytes) {
  const std::string bytes = Written(MakeModel(0, 3, 1));
  std::mt19937 random(1);
  int refused = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::string damaged = bytes;
    for (int flips = 0; flips < 1 + trial % 3; ++flips) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    refused += !AcceptedSafely(damaged);
  }
  EXPECT_GT(refused, 1000);
}

// Every leaf of the document, replaced by hostile values one at a time.
void ForEachLeaf(nlohmann::json& node, const std::function<void(nlohmann::json&)>& visit) {
  if (node.is_structured() && !node.empty()) {
    for (auto& child : node) ForEachLeaf(child, visit);
  }
  visit(node);
}

TEST_F(Glb, SurvivesHostileDocuments) {
  const GlbContainer good = ParseGlb(Written(MakeModel(0, 3, 1)), "model.glb");
  const std::vector<nlohmann::json> hostile = {-1,
                                               0,
                                               1,
                                               2,
                                               3,
                                               7,
                                               65535,
                                               2147483647,
                                               4294967296,
                                               UINT64_MAX,
                                               0.5,
                                               1e300,
                                               "x",
                                               nullptr,
                                               true,
                                               nlohmann::json::array(),
                                               nlohmann::json::object(),
                                               {0, 0, 0, 0, 0, 0, 0, 0}};
  int refused = 0, tried = 0;
  GlbContainer damaged = good;
  ForEachLeaf(damaged.json, [&](nlohmann::json& leaf) {
    const nlohmann::json before = leaf;
    for (const nlohmann::json& value : hostile) {
      leaf = value;
      refused += !AcceptedSafely(BuildGlb(damaged));
      ++tried;
    }
    leaf = before;
  });
  EXPECT_GT(refused, tried / 4);
  EXPECT_EQ(damaged.json, good.json);
}

TEST_F(Glb, RefusesADocumentThatIsNestedTooDeeply) {
  GlbContainer container = ParseGlb(Written(MakeModel(0, 3, 1)), "model.glb");
  nlohmann::json nested = nlohmann::json::array();
  for (int depth = 0; depth < 1000; ++depth) nested = nlohmann::json::array({nested});
  container.json["extras"] = nested;
  EXPECT_THROW(ParseGlb(BuildGlb(container), "model.glb"), Error);
}

// The published schema lists the keys that are written, no more and no fewer.
TEST_F(Glb, SchemaListsTheKeys) {
  const nlohmann::json schema =
      nlohmann::json::parse(ReadFile(LFM_SOURCE_DIR "/docs/LFM_surface_light_field.schema.json"));
  LightFieldModel model = MakeModel(0, 3, 1);
  model.mean_in_terms = true;  // written where it is so
  const GlbContainer glb = ParseGlb(Written(model), "model.glb");
  const auto& extension = glb.json["extensions"]["LFM_surface_light_field"];
  for (const auto& [key, value] : extension.items()) {
    EXPECT_TRUE(schema["properties"].contains(key)) << key;
  }
  // The others: one list of patches, as models without terms and earlier ones have it, blocks, and
  // view maps with grids of their own.
  size_t others = 0;
  for (const char* key : {"placements", "blocks", "viewTileCounts"}) {
    EXPECT_TRUE(schema["properties"].contains(key)) << key;
    EXPECT_FALSE(extension.contains(key)) << key;
    ++others;
  }
  EXPECT_EQ(schema["properties"].size(), extension.size() + others);
  for (const std::string key : schema["required"]) EXPECT_TRUE(extension.contains(key)) << key;
}

// Places of tiles that do not fit an int, or lie to the left of their page.
TEST_F(Glb, RefusesTilesThatOverflow) {
  const LightFieldModel good = MakeModel(1, 6, 2);
  EXPECT_NO_THROW(ValidateModel(good, "good"));
  LightFieldModel tall = good;
  tall.view_tiles_per_row = 1;
  tall.view_tiles_per_page = std::numeric_limits<int>::max();
  EXPECT_THROW(ValidateModel(tall, "tall"), Error);
  LightFieldModel wide = good;
  wide.view_tiles_per_row = wide.view_tiles_per_page = std::numeric_limits<int>::max();
  EXPECT_THROW(ValidateModel(wide, "wide"), Error);
  LightFieldModel negative = good;
  negative.view_slots[0] = -7;
  EXPECT_THROW(ValidateModel(negative, "negative"), Error);
}

TEST_F(Glb, RefusesMissingKeys) {
  const GlbContainer good = ParseGlb(Written(MakeModel(0, 3, 1)), "model.glb");
  const std::string extension = "LFM_surface_light_field";
  for (const auto& [key, value] : good.json["extensions"][extension].items()) {
    if (key == "guessedDirections") continue;  // may be absent
    GlbContainer damaged = good;
    damaged.json["extensions"][extension].erase(key);
    EXPECT_THROW(ReadGlbBytes(BuildGlb(damaged), "model.glb"), Error) << key;
  }
  GlbContainer plain = good;
  plain.json.erase("extensions");
  EXPECT_THROW(ReadGlbBytes(BuildGlb(plain), "model.glb"), Error);
}

TEST_F(Glb, RefusesPicturesThatLieAboutTheirSize) {
  const std::string bytes = Written(MakeModel(0, 3, 1));
  const GlbContainer good = ParseGlb(bytes, "model.glb");
  const size_t header = good.binary.find("IHDR");
  ASSERT_NE(header, std::string::npos);
  for (const std::string& size :
       {std::string("\0\0\x3f\xff\0\0\x3f\xff", 8), std::string("\xff\xff\xff\xff\0\0\0\1", 8),
        std::string("\0\0\0\0\0\0\0\0", 8)}) {
    GlbContainer damaged = good;
    damaged.binary.replace(header + 4, 8, size);
    EXPECT_THROW(ReadGlbBytes(BuildGlb(damaged), "model.glb"), Error);
  }
}

TEST_F(Glb, NamesTheFileAndWhatToDo) {
  WriteFileAtomically(folder_ / "short.glb", "glTF");
  try {
    ReadGlb(folder_ / "short.glb");
    FAIL();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("short.glb"), std::string::npos);
    EXPECT_NE(message.find("lfm-encode"), std::string::npos);
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_THROW(ReadGlb(folder_ / "missing.glb"), Error);
  EXPECT_THROW(ReadGlb(folder_), Error);
}

// Khronos' validator finds neither errors nor warnings.
TEST_F(Glb, PassesTheKhronosValidator) {
  const char* from_environment = std::getenv("LFM_NODE_MODULES");
  const fs::path modules = from_environment != nullptr ? from_environment : LFM_NODE_MODULES;
  if (!fs::exists(modules / "gltf-validator")) {
    if (std::getenv("LFM_ALLOW_MISSING_VALIDATOR") != nullptr) {
      GTEST_SKIP() << "gltf-validator is not installed in " << modules;
    }
    FAIL() << "gltf-validator is not installed in " << modules
           << "; run scripts/install-deps, or npm install --prefix build/node gltf-validator";
  }
  for (const int terms : {0, 2}) {
    WriteGlb(MakeModel(2, 8, terms, 256), folder_ / "model.glb");
    const std::string command = "node '" LFM_SOURCE_DIR "/tests/encode/validate_glb.cjs' '" +
                                modules.string() + "' '" + (folder_ / "model.glb").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << terms << " terms";
  }
}

}  // namespace
}  // namespace lfm::testing
