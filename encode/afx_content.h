// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"
#include "encode/afx.h"
#include "encode/vrml_scene.h"
#include "resample/direction_map.h"

namespace lfm::afx {

/// What the shapes of a file say, all of them together; nothing of the pictures is known yet.
/// Indices are checked, numbers are finite.

struct TileName {
  std::string name;
  int line = 0;
};

/// A surface map: a triangle's corner, or all of it for a plain texture.
struct SurfaceEntry {
  int triangle = 0, tile = 0;
  int view_entry = -1;                     ///< index into Content::views; -1: a plain texture
  std::array<Eigen::Vector2f, 3> corners;  ///< texture coordinates of the triangle's corners
  int line = 0;
};

/// A view map of a vertex: its term number `term`.
struct ViewEntry {
  int vertex = 0, term = 0, tile = 0;
  Eigen::Vector2f origin = {0, 0}, size = {0, 0};
  int light_map = -1;  ///< index into Content::light_maps
  int line = 0;
};

struct LightMap {
  Eigen::Vector3f scale = {1, 1, 1}, bias = {0, 0, 0};
  bool subtracted = false;
  int line = 0;
};

struct Content {
  TriangleMesh mesh;                          ///< without normals
  std::vector<Eigen::Matrix3d> given_frames;  ///< zero where none is given
  std::vector<TileName> tiles;                ///< none twice
  std::vector<LightMap> light_maps;           ///< those with view maps
  std::vector<LightMap> textures;             ///< of `plain`, one each
  std::vector<SurfaceEntry> plain, surfaces;
  std::vector<ViewEntry> views;
  DirectionMap direction_map = DirectionMap::kOrthographic;
};

/// Collects the shapes that have LFM_Appearance. `name` stands for the file in messages.
Content CollectContent(const vrml::Scene& scene, const std::string& name,
                       const AfxReadOptions& options);

}  // namespace lfm::afx
