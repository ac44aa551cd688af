// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scene_file.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/image.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using nlohmann::json;
using V3 = Eigen::Vector3d;

size_t VertexCount(const SceneDescription& scene) {
  size_t count = 0;
  for (const SceneObject& object : scene.objects) count += object.mesh.vertices.size();
  return count;
}

size_t TriangleCount(const SceneDescription& scene) {
  size_t count = 0;
  for (const SceneObject& object : scene.objects) count += object.mesh.triangles.size();
  return count;
}

const std::set<std::string> kSheets = {"ground", "table", "wall"};  // open: they end out of sight

using K = MaterialKind;

// What the papers ask of a scene.
struct Expectation {
  SceneKind kind;
  int width = 0, height = 0;              // of a fixed view whose size is given
  std::set<MaterialKind> materials = {};  // all of them; empty: any
};
const std::map<std::string, Expectation> kExpected = {
    // Chen 2002, Figure 1 and section 5, and the two extremes.
    {"bust", {SceneKind::kLightField, 0, 0, {K::kPaint}}},
    {"dancer", {SceneKind::kLightField, 0, 0, {K::kPaint}}},
    {"star", {SceneKind::kLightField, 0, 0, {K::kGlass, K::kConductor}}},
    {"turtle", {SceneKind::kLightField, 0, 0, {K::kFuzz, K::kPlastic}}},
    {"museum", {SceneKind::kLightField}},
    {"matte", {SceneKind::kLightField, 0, 0, {K::kLambert}}},
    {"chrome", {SceneKind::kLightField, 0, 0, {K::kConductor}}},
    {"statue", {SceneKind::kLightField}},
    // Yamada 2009, section 5.
    {"plant", {SceneKind::kReflectanceField, 640, 422}},
    {"helmet", {SceneKind::kReflectanceField, 640, 640}},
    {"knight",
     {SceneKind::kReflectanceField,
      512,
      512,
      {K::kConductor, K::kFuzz, K::kPlastic, K::kPaint, K::kLambert}}},
    // Mahajan 2007, Figures 1, 7, 9, 10, 11.
    {"hemisphere", {SceneKind::kTransportImage, 0, 0, {K::kPhong}}},
    {"ellipsoid", {SceneKind::kTransportImage, 0, 0, {K::kPhong}}},
    {"concave", {SceneKind::kTransportImage}},
    {"step", {SceneKind::kTransportImage}},
    {"grid1d", {SceneKind::kTransportImage}},
    {"grid2d", {SceneKind::kTransportImage}},
    {"face", {SceneKind::kTransportImage, 256, 256}},
    {"canopy", {SceneKind::kTransportImage, 1024, 1024}},
    {"ellipsoid_views", {SceneKind::kTransportMesh, 0, 0, {K::kPhong}}},
    {"statue_transport", {SceneKind::kTransportMesh}},
    {"street", {SceneKind::kTransportMesh}},
};

void ExpectSoundObject(const SceneObject& object, bool may_be_open) {
  const MeshTopology topology = ExamineTopology(object.mesh);
  EXPECT_TRUE(topology.manifold) << object.name;
  EXPECT_TRUE(topology.closed || may_be_open) << object.name;
  EXPECT_EQ(topology.degenerate_triangles, 0) << object.name;
  if (topology.closed) {
    EXPECT_GT(SignedVolume(object.mesh), 0) << object.name;
  }
  ASSERT_EQ(object.mesh.normals.size(), object.mesh.vertices.size()) << object.name;
  EXPECT_TRUE(object.paint.empty() || object.paint.size() == object.mesh.vertices.size());
  EXPECT_TRUE(object.uv.empty() || object.uv.size() == object.mesh.vertices.size());
  for (size_t v = 0; v < object.mesh.vertices.size(); ++v) {
    ASSERT_TRUE(object.mesh.vertices[v].allFinite()) << object.name;
    ASSERT_NEAR(object.mesh.normals[v].norm(), 1, 1e-6) << object.name;
  }
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, LoadsTinyAndIsWhatThePapersAskFor) {
  const SceneDescription scene = FindScene(GetParam(), SceneDetail::kTiny);
  EXPECT_EQ(scene.name, GetParam());
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_LT(TriangleCount(scene), 250'000u);
  ASSERT_TRUE(kExpected.contains(GetParam()));
  const Expectation& expected = kExpected.at(GetParam());
  EXPECT_EQ(scene.kind, expected.kind);
  Eigen::AlignedBox3d box;
  std::set<MaterialKind> materials;
  for (const SceneObject& object : scene.objects) {
    ExpectSoundObject(object,
                      scene.kind != SceneKind::kLightField && kSheets.contains(object.name));
    for (const V3& p : object.mesh.vertices) box.extend(p);
    materials.insert(object.material.kind);
  }
  if (!expected.materials.empty()) {
    EXPECT_EQ(materials, expected.materials);
  }
  if (scene.kind == SceneKind::kLightField) {
    // On the platform, clear of its tags.
    EXPECT_NEAR(box.min().z(), 0, 0.15);
    EXPECT_GT(box.max().z(), 45);
    EXPECT_LT(box.max().z(), 130);
    EXPECT_LE(box.sizes().head<2>().maxCoeff(), 130);
    EXPECT_FALSE(scene.lights.studio.lights.empty());
  } else {
    if (expected.width > 0) {
      EXPECT_EQ(scene.view.width, expected.width);
      EXPECT_EQ(scene.view.height, expected.height);
    }
    EXPECT_EQ(scene.light_count, 253);
    EXPECT_EQ(scene.cube_resolution, 32);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(SceneNames()),
                         [](const auto& scene) { return scene.param; });

TEST(Scenes, AreThoseOfThePapers) {
  std::vector<std::string> expected;
  for (const auto& [name, what] : kExpected) expected.push_back(name);
  EXPECT_EQ(SceneNames(), expected);
}

// Chen 2002, Figure 1; Mahajan 2007, Figures 10 and 11.
TEST(Scenes, MuseumHasAbout60000Polygons) {
  const SceneDescription museum = FindScene("museum", SceneDetail::kDefault);
  EXPECT_GE(TriangleCount(museum), 55'000u);
  EXPECT_LE(TriangleCount(museum), 65'000u);
  EXPECT_GE(museum.objects.size(), 20u);
}

TEST(Scenes, StatueHas24000AndStreet40000Vertices) {
  const SceneDescription statue = FindScene("statue_transport", SceneDetail::kDefault);
  EXPECT_NEAR(static_cast<double>(VertexCount(statue)), 24'000, 0.05 * 24'000);
  EXPECT_EQ(ExamineTopology(statue.objects[0].mesh).components, 1);
  const SceneDescription street = FindScene("street", SceneDetail::kDefault);
  EXPECT_NEAR(static_cast<double>(VertexCount(street)), 40'000, 0.05 * 40'000);
}

TEST(Scenes, MaterialsAreWhatTheirNamesPromise) {
  const SceneDescription chrome = FindScene("chrome", SceneDetail::kTiny);
  EXPECT_EQ(chrome.objects[0].material.alpha_u, 0);
  const SceneDescription star = FindScene("star", SceneDetail::kTiny);
  EXPECT_NE(star.objects[1].material.alpha_u, star.objects[1].material.alpha_v);
  const SceneDescription views = FindScene("ellipsoid_views", SceneDetail::kTiny);
  EXPECT_GT(views.view_directions, 1);
  const SceneDescription hemisphere = FindScene("hemisphere", SceneDetail::kTiny);
  EXPECT_EQ(hemisphere.objects[0].material.exponent, 100);
  EXPECT_EQ(hemisphere.bounces, 0);
}

TEST(FindScene, ListsTheNamesOfAnUnknownScene) {
  try {
    FindScene("bistro", SceneDetail::kTiny);
    FAIL();
  } catch (const Error& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("no scene 'bistro'"), what.npos);
    for (const std::string& name : SceneNames()) EXPECT_NE(what.find(name), what.npos) << name;
  }
  EXPECT_THROW(FindScene("absent.json", SceneDetail::kTiny), Error);
}

class SceneFileTest : public testing::Test {
 protected:
  static json Scene() {
    return json::parse(R"({"format": "lfm-scene", "version": 1, "name": "s", "kind": "light-field",
      "objects": [{"name": "box", "shape": {"generator": "box", "size_mm": [20, 20, 20]},
                   "material": {"kind": "lambert", "diffuse": [0.5, 0.5, 0.5]}}]})");
  }
  SceneDescription Load(const json& scene) {
    const std::filesystem::path file = scratch_.folder / "scene.json";
    std::ofstream(file) << scene.dump();
    return LoadScene(file, SceneDetail::kTiny);
  }
  std::string Failure(const json& scene) {
    try {
      Load(scene);
    } catch (const Error& e) {
      const std::string what = e.what();
      EXPECT_NE(what.find("scene.json"), what.npos) << what;
      EXPECT_EQ(what.find('\n'), what.npos) << what;
      return what;
    }
    return "no error";
  }
  ScratchFolder scratch_;
};

TEST_F(SceneFileTest, PlacesObjectsAndCopies) {
  json scene = Scene();
  json& object = scene["objects"][0];
  object["shape"]["size_mm"] = {2, 4, 6};
  object["scale"] = 2;
  object["rotate"] = {{"axis", {0, 0, 3}}, {"angle_deg", 90}};
  object["translate"] = {10, 0, 1};
  object["copies"] = {{0, 0, 0, 0}, {0, 0, 20, 180}};
  const SceneDescription loaded = Load(scene);
  const TriangleMesh& mesh = loaded.objects[0].mesh;
  const size_t half = mesh.vertices.size() / 2;
  Eigen::AlignedBox3d first, second;
  for (size_t v = 0; v < half; ++v) first.extend(mesh.vertices[v]);
  for (size_t v = half; v < 2 * half; ++v) second.extend(mesh.vertices[v]);
  EXPECT_LT((first.min() - V3(6, -2, 1)).norm(), 1e-9);
  EXPECT_LT((first.max() - V3(14, 2, 13)).norm(), 1e-9);
  EXPECT_LT((second.min() - V3(-14, -2, 21)).norm(), 1e-9);
  EXPECT_EQ(ExamineTopology(mesh).components, 2);
  EXPECT_FALSE(loaded.lights.studio.lights.empty());  // the default of a light field
}

TEST_F(SceneFileTest, ReadsMeshesPicturesAndLightsBesideIt) {
  std::ofstream(scratch_.folder / "m.obj") << "v 0 0 0\nv 9 0 0\nv 0 9 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                              "f 1/1 2/2 3/3\n";
  Image picture(4, 2, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  picture.At<uint8_t>(1, 0, 0) = 255;
  WriteImage(picture, scratch_.folder / "t.png");
  json scene = Scene();
  scene["objects"][0].erase("shape");
  scene["objects"][0]["mesh"] = "m.obj";
  scene["objects"][0]["texture"] = {{"kind", "image"}, {"mapping", "uv"}, {"file", "t.png"}};
  scene["lights"] = json::parse(R"({"studio": false,
    "area": [{"center": [0, 0, 500], "half_u": [0, 50, 0], "half_v": [50, 0, 0], "radiance": [2, 2, 2]}],
    "directional": [{"to_light": [0, 0, 2], "irradiance": [1, 2, 3]}],
    "environment": {"map": "builtin", "gain": 0.5}})");
  const SceneDescription loaded = Load(scene);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_NE(loaded.warnings[0].find("box: the mesh has holes"), std::string::npos);
  EXPECT_EQ(loaded.objects[0].uv.size(), 3u);
  ASSERT_TRUE(loaded.objects[0].texture.image);
  EXPECT_EQ(loaded.objects[0].texture.image->At<float>(1, 0, 0), 1.0f);
  EXPECT_EQ(loaded.lights.studio.lights.size(), 1u);
  EXPECT_EQ(loaded.lights.directional.at(0).to_light, Eigen::Vector3f(0, 0, 1));
  ASSERT_TRUE(loaded.lights.environment.image);
  EXPECT_EQ(loaded.lights.environment.gain, 0.5f);
}

struct BadScene {
  const char* pointer;  // where
  const char* value;    // what is put there; "-" removes it
  const char* message;
};

TEST_F(SceneFileTest, NamesFileAndKeyOfEveryProblem) {
  std::ofstream(scratch_.folder / "nan.obj") << "v 0 nan 0\n";
  std::ofstream(scratch_.folder / "text.png") << "this is no picture";
  const BadScene cases[] = {
      {"/format", "\"x\"", "format: expected \"lfm-scene\""},
      {"/version", "2", "version: expected a whole number between 1 and 1"},
      {"/kind", "\"movie\"", "kind: 'movie' is none of light-field"},
      {"/name", "3", "name: expected a string"},
      {"/colour", "1", "colour: unknown key"},
      {"/objects", "[]", "objects: expected one object or more"},
      {"/objects", "{}", "objects: expected an array"},
      {"/bounces", "-1", "bounces: expected a whole number"},
      {"/light_count", "10", "light_count: is only for reflectance-field"},
      {"/view", "{}", "view: is only for reflectance-field and transport"},
      {"/cube_resolution", "8", "cube_resolution: is only for transport"},
      {"/view_directions", "8", "view_directions: is only for transport-mesh"},
      {"/objects/0/name", "-", "objects[0].name: is missing"},
      {"/objects/0/mesh", "\"m.ply\"", "objects[0]: give either"},
      {"/objects/0/shape", "-", "objects[0]: give either"},
      {"/objects/0/shape/generator", "\"blob\"", "objects[0].shape.generator: there is no shape"},
      {"/objects/0/shape/size_mm", "[1, 2, 1e400]", "scene.json: is not valid JSON"},
      {"/objects/0/shape/colour", "1", "objects[0].shape.colour: unknown key"},
      {"/objects/0/scale", "0", "objects[0].scale: expected a number between"},
      {"/objects/0/scale", "[1, 1, 2]", "objects[0].scale: expected a number"},
      {"/objects/0/translate", "[0, 0]", "objects[0].translate: expected an array of 3"},
      {"/objects/0/translate", "[0, 0, -5]", "'box' leaves the platform"},
      {"/objects/0/translate", "[90, 0, 0]", "'box' leaves the platform"},
      {"/objects/0/rotate", "{\"axis\": [0, 0, 0]}", "objects[0].rotate.axis: expected three"},
      {"/objects/0/copies", "[]", "objects[0].copies: expected one row"},
      {"/objects/0/copies", "[[1, 2]]", "objects[0].copies: expected an array of rows of 4"},
      {"/objects/0/scan_white", "1", "objects[0].scan_white: expected true or false"},
      {"/objects/0/paint", "true", "objects[0].paint: replaces"},
      {"/objects/0/material/kind", "\"gold\"", "objects[0].material.kind: 'gold' is none of"},
      {"/objects/0/material/diffuse", "[1, 1, 2]", "objects[0].material.diffuse: expected three"},
      {"/objects/0/material/ior", "1.5", "objects[0].material.ior: unknown key"},
      {"/objects/0/material", R"({"kind": "glass", "ior": 0.5})",
       "material.ior: expected a number"},
      {"/objects/0/material", R"({"kind": "conductor", "alpha": 0.1, "alpha_u": 0.2})",
       "material.alpha: give alpha, or alpha_u and alpha_v"},
      {"/objects/0/material",
       R"({"kind": "phong", "diffuse": [0.6, 0.6, 0.6], "specular": [0.5, 0.5, 0.5]})",
       "material.specular: together with diffuse above 1"},
      {"/objects/0/texture", R"({"kind": "image", "mapping": "uv", "file": "none.png"})",
       "objects[0].texture.file: there is no file"},
      {"/objects/0/texture", R"({"kind": "image", "mapping": "planar", "file": "text.png"})",
       "objects[0].texture.file: "},
      {"/objects/0/texture", R"({"kind": "image", "file": "text.png"})",
       "objects[0].texture.mapping: a picture needs one of"},
      {"/objects/0/texture", R"({"kind": "noise", "scale_mm": 0})", "texture.scale_mm: expected"},
      {"/lights", R"({"studio": false})", "lights: there is no light at all"},
      {"/lights", R"({"environment": {"map": "none.exr"}})", "lights.environment.map: there is no"},
      {"/lights", R"({"environment": {"map": "text.png"}})", "lights.environment.map: "},
      {"/lights", R"({"environment": {"map": "builtin", "gain": -1}})",
       "environment.gain: expected"},
      {"/lights", R"({"area": [{}]})", "lights.area[0].half_u: the lamp has no area"},
      {"/lights", R"({"area": [{"half_u": [1, 0, 0], "half_v": [1, 1, 0]}]})", "at a right angle"},
      {"/lights", R"({"area": [{"half_u": [1, 0, 0], "half_v": [0, 1, 0]}]})", "more than 3 lamps"},
      {"/lights", R"({"directional": [{"to_light": [0, 0, 0]}]})", "directional[0].to_light"},
      {"/lights", R"({"sun": true})", "lights.sun: unknown key"},
  };
  for (const BadScene& c : cases) {
    json scene = Scene();
    const json::json_pointer pointer(c.pointer);
    std::string failure;
    if (std::string(c.value) == "-") {
      scene[pointer.parent_pointer()].erase(pointer.back());
      failure = Failure(scene);
    } else if (std::string(c.value).find("1e400") != std::string::npos) {
      const std::filesystem::path file = scratch_.folder / "scene.json";
      std::ofstream(file) << "{\"a\": " << c.value << "}";
      try {
        LoadScene(file, SceneDetail::kTiny);
      } catch (const Error& e) {
        failure = e.what();
      }
    } else {
      scene[pointer] = json::parse(c.value);
      failure = Failure(scene);
    }
    EXPECT_NE(failure.find(c.message), failure.npos)
        << c.pointer << " = " << c.value << "\n  gave: " << failure;
  }
}

TEST_F(SceneFileTest, NamesProblemsOfMeshesAndViews) {
  std::ofstream(scratch_.folder / "nan.obj") << "v 0 nan 0\n";
  json scene = Scene();
  scene["objects"][0].erase("shape");
  scene["objects"][0]["mesh"] = "none.obj";
  EXPECT_NE(Failure(scene).find("objects[0].mesh: there is no file"), std::string::npos);
  scene["objects"][0]["mesh"] = "nan.obj";
  EXPECT_NE(Failure(scene).find("vertex 0 is not finite"), std::string::npos);
  scene = Scene();
  scene["objects"].push_back(scene["objects"][0]);
  EXPECT_NE(Failure(scene).find("objects[1].name: 'box' is there twice"), std::string::npos);
  scene = Scene();
  scene["objects"][0]["texture"] = {{"kind", "noise"}, {"mapping", "uv"}};
  scene["objects"][0]["shape"] = {{"generator", "ellipsoid"}, {"radii_mm", {9, 9, 9}}};
  EXPECT_NE(Failure(scene).find("this shape has no texture coordinates"), std::string::npos);
  scene["objects"][0].erase("texture");
  scene["objects"][0].erase("material");
  scene["objects"][0]["paint"] = true;
  EXPECT_NE(Failure(scene).find("has no paint of its own"), std::string::npos);
  scene = Scene();
  scene["kind"] = "transport-image";
  scene["lights"] = json::object();
  EXPECT_NE(Failure(scene).find("lights: is only for light-field"), std::string::npos);
  scene.erase("lights");
  scene["view"] = {{"eye", {0, 0, 500}}, {"target", {0, 0, 0}}};
  EXPECT_NE(Failure(scene).find("view.eye: looks straight up or down"), std::string::npos);
  scene["view"] = {{"eye", {1, 2, 3}}, {"target", {1, 2, 3}}};
  EXPECT_NE(Failure(scene).find("view.target: the eye stands in its target"), std::string::npos);
  scene["view"] = {{"width", 0}};
  EXPECT_NE(Failure(scene).find("view.width: expected a whole number"), std::string::npos);
}

}  // namespace
}  // namespace lfm
