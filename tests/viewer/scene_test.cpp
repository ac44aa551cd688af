// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

constexpr double kPoint_abs = 1e-12;

std::vector<SceneEntry> Parsed(const std::string& text, const std::string& name = "scene.json") {
  const ScratchFolder scratch;
  std::ofstream(scratch.folder / name, std::ios::binary) << text;
  return ReadSceneFile(scratch.folder / name);
}

// One model with these keys besides its file.
std::string WithKeys(const std::string& keys) {
  return R"({"models": [{"file": "a.glb")" + keys + "}]}";
}

void ExpectNear(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  EXPECT_NEAR((a - b).norm(), 0, kPoint_abs) << a.transpose() << ", not " << b.transpose();
}

// What is thrown names the file and `place`, in one line.
void ExpectRefused(const std::string& text, const std::string& place) {
  try {
    Parsed(text);
    ADD_FAILURE() << "accepted: " << text.substr(0, 200);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("scene.json: "), std::string::npos) << message;
    EXPECT_NE(message.find(place), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(Scene, PlacesItsModels) {
  const ScratchFolder scratch;
  const std::string turned = std::to_string(std::numbers::sqrt2 / 2);
  WriteFileAtomically(scratch.folder / "scene.json",
                      R"({"models": [{"file": "bust.glb"},
      {"file": "more/star of silver.lfz", "translation": [10, -20, 30], "scale": 2},
      {"file": "/elsewhere/vase.wrl", "rotation": [)" +
                          turned + ", 0, 0, " + turned + "]},\n" +
                          R"({"file": "../all.glb", "translation": [1, 2, 3],
       "rotation": [0, 1, 0, 0], "scale": 0.5}]})");
  const std::vector<SceneEntry> entries = ReadSceneFile(scratch.folder / "scene.json");
  ASSERT_EQ(entries.size(), 4u);
  EXPECT_EQ(entries[0].file, scratch.folder / "bust.glb");
  EXPECT_EQ(entries[1].file, scratch.folder / "more" / "star of silver.lfz");
  EXPECT_EQ(entries[2].file, "/elsewhere/vase.wrl");
  EXPECT_EQ(entries[3].file, scratch.folder / ".." / "all.glb");
  const Eigen::Vector3d p(5, 7, 11);
  ExpectNear(entries[0].placement * p, p);
  ExpectNear(entries[1].placement * p, {20, -6, 52});
  ExpectNear(entries[2].placement * p, {-7, 5, 11});                  // a quarter turn about z
  ExpectNear(entries[3].placement * p, {1 + 2.5, 2 - 3.5, 3 - 5.5});  // half a turn about x
}

TEST(Scene, RotationsAreMadeUnit) {
  const Placement placement = Parsed(WithKeys(R"(, "rotation": [0.9995, 0, 0, 0])"))[0].placement;
  EXPECT_NEAR((placement.world_from_model.rotation - Eigen::Matrix3d::Identity()).norm(), 0, 1e-15);
}

TEST(Scene, FilesBesideAFileWithoutAFolder) {
  const ScratchFolder scratch;
  WriteFileAtomically(scratch.folder / "scene.json", WithKeys(""));
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(scratch.folder);
  const std::vector<SceneEntry> entries = ReadSceneFile("scene.json");
  std::filesystem::current_path(before);
  EXPECT_EQ(entries.at(0).file, "a.glb");
}

TEST(Scene, RefusesWhatIsNone) {
  ExpectRefused("", "");
  ExpectRefused("[]", "");
  ExpectRefused("{}", "models");
  ExpectRefused(R"({"models": 3})", "models");
  ExpectRefused(R"({"models": {}})", "models");
  ExpectRefused(R"({"models": []})", "models: expected one");
  ExpectRefused(R"({"models": ["a.glb"]})", "models[0]");
  ExpectRefused(R"({"models": [{}]})", "models[0].file");
  ExpectRefused(R"({"models": [{"file": "a.glb"}, {"file": 3}]})", "models[1].file");
  ExpectRefused(R"({"models": [{"file": ""}]})", "models[0].file");
  ExpectRefused(R"({"models": [{"file": "a.glb\u0000.png"}]})", "models[0].file");
  ExpectRefused(R"({"models": [{"file": "other.json"}]})", "models[0].file");
  ExpectRefused(R"({"models": [{"file": "a.glb"}], "version": 1})", "version");
  ExpectRefused(WithKeys(R"(, "transform": [])"), "models[0].transform");
  for (const std::string bad : {"3", "[1, 2]", "[1, 2, 3, 4]", "[1, 2, \"3\"]", "[1, 2, null]",
                                "[1e999, 0, 0]", "[0, 0, -1.1e9]", "[NaN, 0, 0]", "{}"}) {
    const std::string place = bad.find("999") != bad.npos || bad.find("NaN") != bad.npos
                                  ? "JSON"
                                  : "models[0].translation";
    ExpectRefused(WithKeys(R"(, "translation": )" + bad), place);
  }
  for (const std::string bad : {"[1, 0, 0]", "[0, 0, 0, 0]", "[1, 1, 0, 0]", "[0.99, 0, 0, 0]",
                                "[1e200, 0, 0, 0]", "0", "[[1, 0, 0, 0]]"}) {
    ExpectRefused(WithKeys(R"(, "rotation": )" + bad), "models[0].rotation");
  }
  for (const std::string bad : {"0", "-1", "0.9e-6", "1.1e6", "1e300", "\"1\"", "null", "[1]"}) {
    ExpectRefused(WithKeys(R"(, "scale": )" + bad), "models[0].scale");
  }
}

TEST(Scene, ExtremesAreTaken) {
  for (const std::string good : {"1e-6", "1e6"}) {
    EXPECT_NEAR(Parsed(WithKeys(R"(, "scale": )" + good))[0].placement.scale, std::stod(good), 0);
  }
  EXPECT_EQ(Parsed(WithKeys(R"(, "translation": [-1e9, 0, 1e9])"))[0]
                .placement.world_from_model.translation,
            Eigen::Vector3d(-1e9, 0, 1e9));
}

TEST(Scene, HoldsAThousandModelsAndNoMore) {
  std::string models = R"({"file": "a.glb"})";
  for (int i = 1; i < 1000; ++i) models += R"(,{"file": "a.glb"})";
  EXPECT_EQ(Parsed(R"({"models": [)" + models + "]}").size(), 1000u);
  ExpectRefused(R"({"models": [)" + models + R"(, {"file": "a.glb"}]})", "models");
  ExpectRefused(std::string(4000001, ' '), "4000001");
}

TEST(Scene, SurvivesPrefixesAndNoise) {
  const std::string good = WithKeys(R"(, "translation": [1, 2, 3], "rotation": [1, 0, 0, 0])");
  EXPECT_EQ(Parsed(good).size(), 1u);
  for (size_t size = 0; size < good.size(); ++size) ExpectRefused(good.substr(0, size), "");
  std::mt19937 random(4);
  for (int trial = 0; trial < 500; ++trial) {
    std::string damaged = good;
    damaged[random() % damaged.size()] = static_cast<char>(random());
    try {
      const Placement placement = Parsed(damaged).at(0).placement;
      EXPECT_TRUE((placement * Eigen::Vector3d(1, 1, 1)).allFinite()) << damaged;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("scene.json: "), std::string::npos) << error.what();
    }
  }
  ExpectRefused(std::string(100000, '['), "JSON");
}

TEST(Scene, MissingFilesAndFoldersAreErrors) {
  const ScratchFolder scratch;
  EXPECT_THROW(ReadSceneFile(scratch.folder / "absent.json"), Error);
  EXPECT_THROW(ReadSceneFile(scratch.folder), Error);
}

TEST(Scene, AModelIsASceneOfItself) {
  EXPECT_TRUE(IsSceneFile("a/scene.json"));
  for (const char* model :
       {"model.glb", "model.lfz", "model.wrl", "json", "a.json/model.glb", ""}) {
    EXPECT_FALSE(IsSceneFile(model)) << model;
  }
  const std::vector<SceneEntry> entries = SceneEntriesOf("some/model.glb");
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].file, "some/model.glb");
  ExpectNear(entries[0].placement * Eigen::Vector3d(1, 2, 3), {1, 2, 3});
  const ScratchFolder scratch;
  WriteFileAtomically(scratch.folder / "two.json",
                      R"({"models": [{"file": "a.glb"}, {"file": "b.glb"}]})");
  EXPECT_EQ(SceneEntriesOf(scratch.folder / "two.json").size(), 2u);
}

TriangleMesh Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1 ? high : low).x(), (i & 2 ? high : low).y(),
                               (i & 4 ? high : low).z());
  }
  mesh.triangles = {{0, 1, 3}, {4, 7, 5}};
  return mesh;
}

PlacedModel Placed(const TriangleMesh& mesh, const Placement& placement = {}) {
  LightFieldModel model;
  model.mesh = mesh;
  return {"model", std::make_shared<const LightFieldModel>(std::move(model)), placement};
}

Placement Moved(const Eigen::Vector3d& by, double scale = 1) {
  Placement placement;
  placement.world_from_model.translation = by;
  placement.scale = scale;
  return placement;
}

TEST(Scene, MeshHoldsEveryModelInTheWorld) {
  const TriangleMesh box = Box({0, 0, 0}, {1, 2, 3});
  TriangleMesh corner;
  corner.vertices = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  corner.triangles = {{0, 1, 2}};
  corner.normals.assign(3, Eigen::Vector3d::UnitZ());
  const std::vector<PlacedModel> scene = {Placed(box), Placed(corner, Moved({10, 20, 30}, 4)),
                                          Placed(box, Moved({0, 0, -5}))};
  const TriangleMesh mesh = SceneMesh(scene);
  ASSERT_EQ(mesh.vertices.size(), 19u);
  ExpectNear(mesh.vertices[7], {1, 2, 3});
  ExpectNear(mesh.vertices[8], {14, 20, 30});
  ExpectNear(mesh.vertices[10], {10, 20, 34});
  ExpectNear(mesh.vertices[18], {1, 2, -2});
  const std::vector<Eigen::Vector3i> triangles = {
      {0, 1, 3}, {4, 7, 5}, {8, 9, 10}, {11, 12, 14}, {15, 18, 16}};
  EXPECT_EQ(mesh.triangles, triangles);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(SceneMesh({}).vertices.empty());
}

TEST(Scene, MeshRefusesMoreThanAnIntCounts) {
  TriangleMesh mesh;
  mesh.vertices.assign(1 << 16, Eigen::Vector3d::Zero());
  const std::vector<PlacedModel> scene(1 << 15, Placed(mesh));  // 2^31 vertices
  EXPECT_THROW(SceneMesh(scene), Error);
}

TEST(Scene, SmallestRadiusIsThatOfTheModelAsItStands) {
  const TriangleMesh box = Box({0, 0, 0}, {2, 3, 6});  // a diagonal of 7
  EXPECT_DOUBLE_EQ(SmallestRadius({}), 0);
  const std::vector<PlacedModel> scene = {Placed(box, Moved({5, 5, 5}, 4)), Placed({}),
                                          Placed(Box({0, 0, 0}, {20, 30, 60}))};
  EXPECT_NEAR(SmallestRadius(scene), 14, 1e-9);
}

TEST(Scene, BesideIsToTheRight) {
  // 0 to 40 in x, 10 to 30 in y, from -5 in z.
  const std::vector<PlacedModel> scene = {
      Placed(Box({0, 10, -5}, {20, 20, 9})),
      Placed(Box({0, 0, 0}, {10, 10, 10}), Moved({20, 10, 0}, 2))};
  // 100 wide: it says how far apart.
  const TriangleMesh wide = Box({-70, 1, 1000}, {30, 7, 1001});
  const Placement beside = PlaceBeside(scene, wide);
  EXPECT_EQ(beside.scale, 1);
  ExpectNear(beside * Eigen::Vector3d(-70, 4, 1000), {50, 20, -5});
  // 10 wide: the scene says it.
  ExpectNear(PlaceBeside(scene, Box({5, 0, 0}, {15, 2, 8})) * Eigen::Vector3d(5, 1, 0),
             {44, 20, -5});
}

TEST(Scene, BesideNothingIsWhereItIs) {
  const TriangleMesh box = Box({3, 4, 5}, {6, 7, 8});
  ExpectNear(PlaceBeside({}, box) * Eigen::Vector3d(3, 4, 5), {3, 4, 5});
  const std::vector<PlacedModel> scene = {Placed(box)};
  ExpectNear(PlaceBeside(scene, {}) * Eigen::Vector3d(3, 4, 5), {3, 4, 5});
  const std::vector<PlacedModel> hollow = {Placed({})};
  ExpectNear(PlaceBeside(hollow, box) * Eigen::Vector3d(3, 4, 5), {3, 4, 5});
}

TEST(SceneFile, WritesWhatItReads) {
  const ScratchFolder scratch;
  std::vector<SceneEntry> entries = {{scratch.folder / "a.glb", {}},
                                     {scratch.folder / "b.lfz", {}}};
  entries[1].placement.world_from_model =
      Pose::FromQuaternion(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1, 2.5, -3});
  entries[1].placement.scale = 0.125;
  WriteSceneFile(entries, scratch.folder / "scene.json");
  const std::vector<SceneEntry> back = ReadSceneFile(scratch.folder / "scene.json");
  ASSERT_EQ(back.size(), 2u);
  for (size_t i = 0; i < back.size(); ++i) {
    const Placement &was = entries[i].placement, &is = back[i].placement;
    EXPECT_EQ(back[i].file, entries[i].file);
    EXPECT_LT((is.world_from_model.rotation - was.world_from_model.rotation).norm(), 1e-12);
    EXPECT_EQ(is.world_from_model.translation, was.world_from_model.translation);
    EXPECT_EQ(is.scale, was.scale);
  }
  entries[1].file = scratch.folder / "caf\xe9.lfz";  // no UTF-8
  EXPECT_THROW(WriteSceneFile(entries, scratch.folder / "scene.json"), Error);
  WriteFileAtomically(scratch.folder / "a_file", "");
  EXPECT_THROW(WriteSceneFile(entries, scratch.folder / "a_file" / "scene.json"), Error);
}

}  // namespace
}  // namespace lfm
