// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr size_t kMostBytes = 4000000;

std::filesystem::path FileOf(JsonReader& entry, const std::filesystem::path& folder) {
  const std::string text = entry.Text("file");
  if (text.empty() || text.find('\0') != std::string::npos) {
    entry.Fail("file", "expected the name of a model, a .glb, .lfz or .wrl file");
  }
  if (IsSceneFile(text)) {
    entry.Fail("file", "expected a model, not another scene; list that scene's models here");
  }
  return folder / text;  // `text` alone where it is absolute
}

Placement PlacementOf(JsonReader& entry) {
  Placement placement;
  if (entry.Has("translation")) {
    const std::vector<double> t = entry.Numbers("translation", 3);
    placement.world_from_model.translation = {t[0], t[1], t[2]};
    if (!(placement.world_from_model.translation.cwiseAbs().maxCoeff() <= Placement::kFarthestMm)) {
      entry.Fail("translation", "expected no more than 1e9 mm");
    }
  }
  if (entry.Has("rotation")) {
    const std::vector<double> q = entry.Numbers("rotation", 4);
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    constexpr double kUnit_abs = 1e-3;
    if (!(std::abs(rotation.norm() - 1) <= kUnit_abs)) {
      entry.Fail("rotation", "expected a unit quaternion w, x, y, z");
    }
    placement.world_from_model.rotation = rotation.normalized().toRotationMatrix();
  }
  placement.scale = entry.NumberOr("scale", 1);
  if (!(placement.scale >= Placement::kLeastScale && placement.scale <= Placement::kMostScale)) {
    entry.Fail("scale", "expected a number between 1e-6 and 1e6");
  }
  return placement;
}

}  // namespace

bool IsSceneFile(const std::filesystem::path& file) { return file.extension() == ".json"; }

std::vector<SceneEntry> ReadSceneFile(const std::filesystem::path& file) {
  const nlohmann::json json = ParseJson(ReadFile(file, kMostBytes), file.string());
  JsonReader reader(json, file.string());
  std::vector<SceneEntry> entries;
  for (JsonReader& entry : reader.Objects("models")) {
    if (entries.size() == kMostModels) {
      reader.Fail("models", "expected no more than 1000; divide the scene among files");
    }
    entries.push_back({FileOf(entry, file.parent_path()), PlacementOf(entry)});
    entry.Finish();
  }
  if (entries.empty()) reader.Fail("models", "expected one at least");
  reader.Finish();
  return entries;
}

void WriteSceneFile(std::span<const SceneEntry> entries, const std::filesystem::path& file) {
  nlohmann::json models = nlohmann::json::array();
  for (const SceneEntry& entry : entries) {
    nlohmann::json model = PoseToJson(entry.placement.world_from_model);
    model["file"] = std::filesystem::absolute(entry.file).lexically_normal().string();
    model["scale"] = entry.placement.scale;
    models.push_back(std::move(model));
  }
  WriteJson({{"models", std::move(models)}}, file);
}

std::vector<SceneEntry> SceneEntriesOf(const std::filesystem::path& model_or_scene) {
  if (IsSceneFile(model_or_scene)) return ReadSceneFile(model_or_scene);
  return {{model_or_scene, {}}};
}

Scene SceneOf(const LightFieldModel& model) {
  // Shares the caller's model without owning it.
  return {{"the model", {std::shared_ptr<const LightFieldModel>(), &model}, {}}};
}

TriangleMesh SceneMesh(std::span<const PlacedModel> scene) {
  int64_t vertices = 0, triangles = 0;
  for (const PlacedModel& placed : scene) {
    vertices += static_cast<int64_t>(placed.model->mesh.vertices.size());
    triangles += static_cast<int64_t>(placed.model->mesh.triangles.size());
  }
  if (std::max(vertices, triangles) > std::numeric_limits<int>::max()) {
    throw Error("the scene has more than 2147483647 vertices or triangles; show fewer models");
  }
  TriangleMesh mesh;
  mesh.vertices.reserve(vertices);
  mesh.triangles.reserve(triangles);
  for (const PlacedModel& placed : scene) {
    const auto first = static_cast<int>(mesh.vertices.size());
    for (const Eigen::Vector3d& vertex : placed.model->mesh.vertices) {
      mesh.vertices.push_back(placed.placement * vertex);
    }
    for (const Eigen::Vector3i& triangle : placed.model->mesh.triangles) {
      mesh.triangles.emplace_back(triangle.array() + first);
    }
  }
  return mesh;
}

double SmallestRadius(std::span<const PlacedModel> scene) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const PlacedModel& placed : scene) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : placed.model->mesh.vertices) box.extend(vertex);
    if (!box.isEmpty()) {
      smallest = std::min(smallest, placed.placement.scale * box.diagonal().norm() / 2);
    }
  }
  return std::isfinite(smallest) ? smallest : 0;
}

Placement PlaceBeside(std::span<const PlacedModel> scene, const TriangleMesh& mesh) {
  Eigen::AlignedBox3d there, added;
  for (const PlacedModel& placed : scene) {
    for (const Eigen::Vector3d& vertex : placed.model->mesh.vertices) {
      there.extend(placed.placement * vertex);
    }
  }
  for (const Eigen::Vector3d& vertex : mesh.vertices) added.extend(vertex);
  Placement beside;
  if (there.isEmpty() || added.isEmpty()) return beside;
  const double gap = 0.1 * std::max(there.sizes().x(), added.sizes().x());
  beside.world_from_model.translation = {there.max().x() + gap - added.min().x(),
                                         there.center().y() - added.center().y(),
                                         there.min().z() - added.min().z()};
  return beside;
}

}  // namespace lfm
