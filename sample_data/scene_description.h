// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/triangle_mesh.h"
#include "sample_data/lighting.h"
#include "sample_data/material.h"
#include "sample_data/paint.h"

namespace lfm {

/// What a texture varies over a surface: its diffuse colour (kFuzz and kConductor: `specular` too)
/// is multiplied by the texture's value.
enum class TextureKind { kNone, kChecker, kStripes, kNoise, kMarble, kImage };
/// Where a texture is looked up: `kSolid` at the point itself (mm, object frame before the scene's
/// transform), the others at coordinates in [0, 1]^2 by projection or from the mesh file.
enum class TextureMapping { kSolid, kPlanar, kCylinder, kSphere, kUv };

struct Texture {
  TextureKind kind = TextureKind::kNone;
  TextureMapping mapping = TextureMapping::kSolid;
  Eigen::Vector3f color_a = {1, 1, 1}, color_b = {0, 0, 0};  ///< linear; a procedure goes a to b
  double scale_mm = 10;                                      ///< size of a procedure's features
  uint64_t seed = 1;
  std::shared_ptr<const Image> image;  ///< kImage: float, linear RGB
};

/// One object: a mesh in the world frame (mm, outward, with normals) and what it is made of.
struct SceneObject {
  std::string name;
  TriangleMesh mesh;
  std::vector<Eigen::Vector2f> uv;  ///< a vertex; empty unless the texture needs it
  Material material;
  Texture texture;
  /// Paint a vertex, in place of material and texture (kind kPaint); empty otherwise.
  std::vector<Paint> paint;
  bool scan_white = true;  ///< painted white for the scanner
};

/// Light of parallel rays; `irradiance` on a surface that faces it.
struct DirectionalLight {
  Eigen::Vector3f to_light = {0, 0, 1};  ///< unit, world frame
  Eigen::Vector3f irradiance = {1, 1, 1};
};

/// Surroundings as a picture: equirectangular, float, linear RGB; column 0 looks along -x, the
/// middle along +x, the top row up (+z), as an eye in the middle sees it: +y at a quarter.
struct EnvironmentMap {
  std::shared_ptr<const Image> image;  ///< null: none
  float gain = 1;
};

/// All light of a scene. Studio lamps and the dim room are `studio`; the rest adds to them.
struct SceneLights {
  Lighting studio;
  std::vector<DirectionalLight> directional;
  EnvironmentMap environment;
};

/// What is recorded of a scene.
enum class SceneKind {
  kLightField,        ///< photographs and scans of objects on the platform
  kReflectanceField,  ///< one camera, many light directions (Yamada 2009)
  kTransportImage,    ///< one camera, every texel of a cube map as light (Mahajan 2007)
  kTransportMesh,     ///< the same at the vertices of a mesh, with several view directions
};

/// The fixed camera of reflectance fields and transport images; looks at `target`.
struct FixedView {
  int width = 256, height = 256;
  double fov_deg = 30;  ///< across the width
  Eigen::Vector3d eye = {0, -600, 300}, target = {0, 0, 50};
};

/// A scene, ready to render. World frame, mm, z up; on the platform for kLightField.
struct SceneDescription {
  std::string name;
  SceneKind kind = SceneKind::kLightField;
  std::vector<SceneObject> objects;
  SceneLights lights;
  FixedView view;
  int light_count = 253;              ///< kReflectanceField: directions over the upper hemisphere
  int cube_resolution = 32;           ///< kTransport*: texels a side of a cube face
  int view_directions = 1;            ///< kTransportMesh: fixed eye (1), or eyes round the object
  int bounces = 1;                    ///< of light between surfaces; 0 is direct light only
  std::vector<std::string> warnings;  ///< what was repaired in meshes brought along, a line each
};

}  // namespace lfm
