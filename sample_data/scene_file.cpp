// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scene_file.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "core/error.h"
#include "core/image.h"
#include "core/json_reader.h"
#include "sample_data/builtin_scenes.h"
#include "sample_data/environment_light.h"
#include "sample_data/mesh_import.h"
#include "sample_data/scene_surface.h"
#include "sample_data/shapes/shape_generators.h"
#include "sample_data/texture.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kFar = 1e5;           // mm; the largest coordinate in a scene file
constexpr double kPlatformReach = 75;  // mm from the axis, in x and y
constexpr size_t kMaxTriangles = 4'000'000;
const std::vector<std::string> kKinds = {"light-field", "reflectance-field", "transport-image",
                                         "transport-mesh"};

// How an object's shape is put into the scene.
struct Placement {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  V3 translation = V3::Zero();
  std::vector<std::pair<double, V3>> copies;  // turn about z (rad), then translation
};

Placement ReadPlacement(JsonReader& reader) {
  Placement place;
  place.scale = NumberInRange(reader, "scale", 1, 1e-6, 1e6);
  if (reader.Has("rotate")) {
    JsonReader rotate = reader.Object("rotate");
    const V3 axis = VectorInRange(rotate, "axis", V3::Zero(), -kFar, kFar);
    if (!(axis.norm() > 1e-9)) rotate.Fail("axis", "expected three numbers, not all 0");
    const double angle = NumberInRange(rotate, "angle_deg", 0, -360, 360) * std::numbers::pi / 180;
    rotate.Finish();
    place.rotation = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  }
  place.translation = VectorInRange(reader, "translate", V3::Zero(), -kFar, kFar);
  place.copies.emplace_back(0, V3::Zero());
  if (reader.Has("copies")) {
    place.copies.clear();
    for (const std::vector<double>& row : reader.NumberRows("copies", 4)) {
      place.copies.emplace_back(row[3] * std::numbers::pi / 180, V3(row[0], row[1], row[2]));
    }
    if (place.copies.empty()) reader.Fail("copies", "expected one row or more");
  }
  return place;
}

// The shape in the world frame, once for every copy.
Shape Placed(Shape shape, const Placement& place) {
  for (V3& p : shape.mesh.vertices) p = place.rotation * (place.scale * p) + place.translation;
  for (V3& n : shape.mesh.normals) n = place.rotation * n;
  Shape all;
  for (const auto& [turn, offset] : place.copies) {
    Shape copy = shape;
    const Eigen::Matrix3d about_z = Eigen::AngleAxisd(turn, V3::UnitZ()).toRotationMatrix();
    for (V3& p : copy.mesh.vertices) p = about_z * p;
    for (V3& n : copy.mesh.normals) n = about_z * n;
    AppendShape(all, copy, offset);
  }
  return all;
}

// The surface of an object that says nothing of its own: a mesh file's only material.
void TakeMaterial(const ImportedMesh& imported, SceneObject& object,
                  std::vector<std::string>& warnings) {
  if (imported.material.empty()) return;
  const std::set<int> used(imported.material.begin(), imported.material.end());
  if (used.size() > 1) {
    warnings.push_back(object.name +
                       ": the file's materials differ and are left out; \"paint\": true takes "
                       "their colours");
    return;
  }
  if (*used.begin() < 0) return;
  const ObjMaterial& material = imported.materials[*used.begin()];
  object.material.diffuse = material.diffuse;
  if (material.picture.empty() || imported.uv.empty()) return;
  object.texture.kind = TextureKind::kImage;
  object.texture.mapping = TextureMapping::kUv;
  object.texture.image = std::make_shared<Image>(ReadTextureImage(material.picture));
}

// A mesh file's shape; its colours become paint.
Shape ReadMeshShape(JsonReader& reader, const std::filesystem::path& folder, bool own_surface,
                    SceneObject& object, std::vector<std::string>& warnings) {
  ImportedMesh imported;
  const std::filesystem::path file = ExistingFile(reader, "mesh", folder);
  try {
    imported = ImportMesh(file);
    if (!own_surface) {
      TakeMaterial(imported, object, warnings);
      imported.mesh.colors = MaterialColors(imported);
    }
  } catch (const Error& e) {
    reader.Fail("mesh", e.what());
  }
  for (const std::string& warning : imported.warnings)
    warnings.push_back(object.name + ": " + warning);
  Shape shape = {std::move(imported.mesh), std::move(imported.uv), {}};
  if (shape.mesh.colors.empty()) return shape;
  for (size_t v = 0; v < shape.mesh.vertices.size(); ++v) {
    Eigen::Vector3f base;
    for (int c = 0; c < 3; ++c) base[c] = LinearFromSrgb(shape.mesh.colors[v][c]);
    shape.paint.push_back(PaintMesh(shape.mesh.vertices[v], base, 1));
  }
  return shape;
}

SceneObject ReadObject(JsonReader reader, const std::filesystem::path& folder, SceneDetail detail,
                       std::vector<std::string>& warnings) {
  SceneObject object;
  object.name = reader.Text("name");
  if (object.name.empty()) reader.Fail("name", "expected a name");
  if (reader.Has("shape") == reader.Has("mesh")) {
    reader.Fail("", "give either \"shape\" or \"mesh\"");
  }
  // The rest is read before anything slow is made.
  const Placement place = ReadPlacement(reader);
  const bool own_paint = reader.Has("paint") && reader.Bool("paint");
  if (own_paint) {
    if (reader.Has("material") || reader.Has("texture")) {
      reader.Fail("paint", "replaces \"material\" and \"texture\"; leave those out");
    }
    object.material.kind = MaterialKind::kPaint;
  } else {
    if (reader.Has("material")) object.material = ReadMaterial(reader.Object("material"));
    if (reader.Has("texture")) object.texture = ReadTexture(reader.Object("texture"), folder);
  }
  if (reader.Has("scan_white")) object.scan_white = reader.Bool("scan_white");
  Shape shape;
  if (reader.Has("shape")) {
    JsonReader parameters = reader.Object("shape");
    reader.Finish();
    shape = GenerateShape(parameters, detail);
  } else {
    const bool own_surface = own_paint || reader.Has("material") || reader.Has("texture");
    shape = ReadMeshShape(reader, folder, own_surface, object, warnings);
    reader.Finish();
  }
  if (own_paint && shape.paint.empty()) {
    reader.Fail("paint", "this shape has no paint of its own; give a material");
  }
  if (object.texture.mapping == TextureMapping::kUv && shape.uv.empty()) {
    reader.Fail("texture.mapping", "this shape has no texture coordinates; use a projection");
  }
  if (static_cast<double>(shape.mesh.triangles.size()) * static_cast<double>(place.copies.size()) >
      kMaxTriangles) {
    reader.Fail("copies", "the object would have more than 4 million triangles");
  }
  shape = Placed(std::move(shape), place);
  if (!own_paint) {
    shape.paint.clear();
    shape.mesh.colors.clear();
  }
  if (object.texture.mapping != TextureMapping::kUv) shape.uv.clear();
  object.mesh = std::move(shape.mesh);
  object.uv = std::move(shape.uv);
  object.paint = std::move(shape.paint);
  return object;
}

Eigen::Vector3f Radiance(JsonReader& reader, const std::string& key) {
  return VectorInRange(reader, key, V3::Ones(), 0, 1e6).cast<float>();
}

AreaLight ReadAreaLight(JsonReader reader) {
  AreaLight light;
  light.center = VectorInRange(reader, "center", V3::Zero(), -kFar, kFar);
  light.half_u = VectorInRange(reader, "half_u", V3::Zero(), -kFar, kFar);
  light.half_v = VectorInRange(reader, "half_v", V3::Zero(), -kFar, kFar);
  light.radiance = Radiance(reader, "radiance");
  if (!(light.Area() > 1e-6)) reader.Fail("half_u", "the lamp has no area");
  if (std::abs(light.half_u.normalized().dot(light.half_v.normalized())) > 1e-6) {
    reader.Fail("half_v", "must be at a right angle to half_u");
  }
  reader.Finish();
  return light;
}

DirectionalLight ReadDirectionalLight(JsonReader reader) {
  DirectionalLight light;
  const V3 to_light = VectorInRange(reader, "to_light", V3::UnitZ(), -kFar, kFar);
  if (!(to_light.norm() > 1e-9)) reader.Fail("to_light", "expected three numbers, not all 0");
  light.to_light = to_light.normalized().cast<float>();
  light.irradiance = Radiance(reader, "irradiance");
  reader.Finish();
  return light;
}

EnvironmentMap ReadEnvironment(JsonReader reader, const std::filesystem::path& folder) {
  const float gain = static_cast<float>(NumberInRange(reader, "gain", 1, 1e-6, 1e6));
  EnvironmentMap map;
  if (reader.Text("map") == "builtin") {
    map = MakeStudioEnvironment();
    map.gain = gain;
  } else {
    const std::filesystem::path file = ExistingFile(reader, "map", folder);
    try {
      map = ReadEnvironmentMap(file, gain);
    } catch (const Error& e) {
      reader.Fail("map", e.what());
    }
  }
  reader.Finish();
  return map;
}

SceneLights ReadLights(JsonReader reader, const std::filesystem::path& folder) {
  SceneLights lights;
  if (!reader.Has("studio") || reader.Bool("studio")) lights.studio = MakeStudioLighting();
  if (reader.Has("area")) {
    for (JsonReader& lamp : reader.Objects("area")) {
      lights.studio.lights.push_back(ReadAreaLight(lamp));
    }
    if (lights.studio.lights.size() > static_cast<size_t>(kMaxLights)) {
      reader.Fail("area", "more than 3 lamps (the studio has 3; switch it off to use others)");
    }
  }
  if (reader.Has("directional")) {
    for (JsonReader& light : reader.Objects("directional")) {
      lights.directional.push_back(ReadDirectionalLight(light));
    }
  }
  if (reader.Has("environment")) {
    lights.environment = ReadEnvironment(reader.Object("environment"), folder);
  }
  if (lights.studio.lights.empty() && lights.directional.empty() && !lights.environment.image) {
    reader.Fail("", "there is no light at all");
  }
  reader.Finish();
  return lights;
}

FixedView ReadView(JsonReader reader) {
  FixedView view;
  if (reader.Has("width")) view.width = reader.Integer("width", 1, 8192);
  if (reader.Has("height")) view.height = reader.Integer("height", 1, 8192);
  view.fov_deg = NumberInRange(reader, "fov_deg", view.fov_deg, 0.1, 170);
  view.eye = VectorInRange(reader, "eye", view.eye, -kFar, kFar);
  view.target = VectorInRange(reader, "target", view.target, -kFar, kFar);
  const V3 towards = view.target - view.eye;
  if (!(towards.norm() > 1e-6)) reader.Fail("target", "the eye stands in its target");
  if (towards.normalized().cross(V3::UnitZ()).norm() < 1e-3) {
    reader.Fail("eye", "looks straight up or down; turn the scene so that it does not");
  }
  reader.Finish();
  return view;
}

void RequireOnPlatform(const SceneObject& object, const std::string& file) {
  for (const V3& p : object.mesh.vertices) {
    if (p.z() < -0.5 || std::max(std::abs(p.x()), std::abs(p.y())) > kPlatformReach) {
      throw Error(file + ": objects: '" + object.name +
                  "' leaves the platform: it must stand on z >= 0, within 75 mm of the axis");
    }
  }
}

// Keys that only one kind of scene has.
void RequireKind(const JsonReader& reader, const std::string& key, bool allowed,
                 const char* kinds) {
  if (reader.Has(key) && !allowed)
    reader.Fail(key, std::string("is only for ") + kinds + " scenes");
}

SceneDescription ReadScene(const nlohmann::json& json, const std::string& file,
                           const std::filesystem::path& folder, SceneDetail detail) {
  JsonReader reader(json, file);
  if (reader.Text("format") != "lfm-scene") reader.Fail("format", "expected \"lfm-scene\"");
  reader.Integer("version", 1, 1);
  SceneDescription scene;
  scene.name = reader.Text("name");
  scene.kind = static_cast<SceneKind>(WordIndex(reader, "kind", kKinds));
  const bool field = scene.kind == SceneKind::kLightField;
  const bool reflectance = scene.kind == SceneKind::kReflectanceField;
  const bool mesh = scene.kind == SceneKind::kTransportMesh;
  RequireKind(reader, "lights", field, "light-field");
  RequireKind(reader, "view", !field, "reflectance-field and transport");
  RequireKind(reader, "light_count", reflectance, "reflectance-field");
  RequireKind(reader, "cube_resolution", !field && !reflectance, "transport");
  RequireKind(reader, "view_directions", mesh, "transport-mesh");
  if (field) {
    scene.lights.studio = MakeStudioLighting();
    if (reader.Has("lights")) scene.lights = ReadLights(reader.Object("lights"), folder);
  } else if (reader.Has("view")) {
    scene.view = ReadView(reader.Object("view"));
  }
  if (reader.Has("light_count")) scene.light_count = reader.Integer("light_count", 1, 100'000);
  if (reader.Has("cube_resolution")) {
    scene.cube_resolution = reader.Integer("cube_resolution", 1, 256);
  }
  if (reader.Has("view_directions")) {
    scene.view_directions = reader.Integer("view_directions", 1, 10'000);
  }
  if (reader.Has("bounces")) scene.bounces = reader.Integer("bounces", 0, 64);
  std::vector<JsonReader> objects = reader.Objects("objects");
  if (objects.empty()) reader.Fail("objects", "expected one object or more");
  reader.Finish();
  std::set<std::string> names;
  for (JsonReader& object : objects) {
    scene.objects.push_back(ReadObject(object, folder, detail, scene.warnings));
    if (!names.insert(scene.objects.back().name).second) {
      object.Fail("name", "'" + scene.objects.back().name + "' is there twice");
    }
    if (field) RequireOnPlatform(scene.objects.back(), file);
  }
  return scene;
}

}  // namespace

SceneDescription LoadScene(const std::filesystem::path& json, SceneDetail detail) {
  const std::filesystem::path folder = json.parent_path();
  return ReadScene(ReadJson(json), json.string(), folder.empty() ? "." : folder, detail);
}

SceneDescription FindScene(const std::string& name_or_file, SceneDetail detail) {
  const auto found = BuiltinSceneTexts().find(name_or_file);
  if (found != BuiltinSceneTexts().end()) {
    const std::string file = "built-in scene " + name_or_file;
    return ReadScene(nlohmann::json::parse(found->second), file, ".", detail);
  }
  if (name_or_file.find('/') != std::string::npos || name_or_file.ends_with(".json")) {
    return LoadScene(name_or_file, detail);
  }
  std::string all;
  for (const std::string& name : SceneNames()) all += (all.empty() ? "" : ", ") + name;
  throw Error("there is no scene '" + name_or_file + "'; there are " + all +
              "; or give the path of a scene file");
}

std::vector<std::string> SceneNames() {
  std::vector<std::string> names;
  for (const auto& [name, text] : BuiltinSceneTexts()) names.push_back(name);
  return names;
}

}  // namespace lfm
