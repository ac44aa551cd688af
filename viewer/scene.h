// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/pose.h"
#include "core/triangle_mesh.h"
#include "encode/model.h"

namespace lfm {

/// Where a model stands in a scene: p_world = world_from_model * (scale * p_model).
struct Placement {
  static constexpr double kFarthestMm = 1e9;  ///< of a translation's coordinates
  static constexpr double kLeastScale = 1e-6, kMostScale = 1e6;

  Pose world_from_model;
  double scale = 1;  ///< positive

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_in_model) const {
    return world_from_model * (scale * point_in_model);
  }
};

/// A model of a scene, shared with whoever shows it.
struct PlacedModel {
  std::string name;  ///< for people
  std::shared_ptr<const LightFieldModel> model;
  Placement placement;
};
using Scene = std::vector<PlacedModel>;      ///< all of them with a model
inline constexpr size_t kMostModels = 1000;  ///< of a scene in a file or page

/// The model where it is; it must outlive the scene.
Scene SceneOf(const LightFieldModel& model);

/// A model of a scene that has not been read yet.
struct SceneEntry {
  std::filesystem::path file;
  Placement placement;
};

/// Whether `file` is a scene by its name (.json), and no model.
bool IsSceneFile(const std::filesystem::path& file);
/// Reads a scene file (docs/formats.md):
///   {"models": [{"file": "bust.glb", "translation": [x, y, z], "rotation": [w, x, y, z],
///                "scale": 1}, ...]}
/// (mm). Files are relative to the scene's folder, or absolute; whether they are there is not
/// looked at. A missing transform leaves the model where it is. Throws Error on missing, unknown or
/// non-finite values, a scale that is not in [1e-6, 1e6], coordinates beyond 1e9 mm, a scene in
/// place of a model, no model, more than 1000, and more than 4 MB of text.
std::vector<SceneEntry> ReadSceneFile(const std::filesystem::path& file);

/// The inverse, with absolute file names; atomic. Throws Error when it cannot be written.
void WriteSceneFile(std::span<const SceneEntry> entries, const std::filesystem::path& file);

/// What a command's MODEL names: a scene's models, or one model where it is.
std::vector<SceneEntry> SceneEntriesOf(const std::filesystem::path& model_or_scene);

/// All models' vertices and triangles in the world, one model after the other; nothing else of the
/// meshes. Throws Error when they are more than an int counts.
TriangleMesh SceneMesh(std::span<const PlacedModel> scene);

/// Half the diagonal of the smallest model's bounding box, mm in the world; 0 without a model that
/// has a vertex.
double SmallestRadius(std::span<const PlacedModel> scene);

/// Where a model of this mesh stands beside the scene, upright and in its own size: to the right
/// along x, apart by a tenth of the wider of the two, the lowest points of both on one level and
/// their middles on one line in y. The identity when either has no vertex.
Placement PlaceBeside(std::span<const PlacedModel> scene, const TriangleMesh& mesh);

}  // namespace lfm
