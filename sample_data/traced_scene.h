// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "sample_data/lanes/path_kernels.h"
#include "sample_data/lanes/scene_tables.h"
#include "sample_data/material.h"
#include "sample_data/scene_description.h"
#include "sample_data/studio_scene.h"
#include "sample_data/texture.h"

namespace lfm {

/// Orthonormal axes in which a BSDF is evaluated: z the shading normal, x the tangent.
struct ShadingFrame {
  Eigen::Vector3f x, y, z;
  Eigen::Vector3f Local(const Eigen::Vector3f& w) const { return {x.dot(w), y.dot(w), z.dot(w)}; }
  Eigen::Vector3f World(const Eigen::Vector3f& l) const {
    return l.x() * x + l.y() * y + l.z() * z;
  }
};

/// A point of a surface, ready to scatter the light of a path that came from the direction `o`.
struct SurfacePoint {
  int object = -1;  ///< index of the object; -1 for the set
  int patch = -1;   ///< of the set; -1 for an object
  Eigen::Vector3f position = {0, 0, 0};
  /// Unit normal of the triangle: outward for glass, on the side of `o` for everything opaque.
  Eigen::Vector3f facet = {0, 0, 1};
  ShadingFrame frame;  ///< z on the same side as `facet`, and of `o` as well
  Material material;
};

/// Objects and (optionally) the plate and table in one ray scene. World frame, mm; float32 inside.
/// Immutable, usable from many threads. The objects must outlive it.
///
/// Opaque surfaces have two sides. The shading normal is the interpolated vertex normal, bent
/// towards the eye where it would turn away from it, and, for lobes that mirror, so far that the
/// mirror direction stays outside the facet: no black edges. The tangent follows the texture
/// coordinates, or runs round the vertical axis where there are none.
class TracedScene {
 public:
  /// Throws Error, naming the object, for a mesh that ValidateMesh refuses and a surface that
  /// ValidateSurface refuses. `patches` may be empty; `reflectance` is needed when they are not.
  TracedScene(const std::vector<SceneObject>& objects, std::vector<Patch> patches,
              const SetReflectance* reflectance);
  ~TracedScene();
  TracedScene(const TracedScene&) = delete;
  TracedScene& operator=(const TracedScene&) = delete;

  const std::vector<SceneObject>& objects() const { return *objects_; }
  const std::vector<Patch>& patches() const { return patches_; }
  /// True when some surface lets light through or mirrors it perfectly: what paths that count no
  /// bounce can pass.
  bool HasSpecularPaths() const { return has_specular_paths_; }
  bool IsObject(unsigned geometry) const { return geometry < objects_->size(); }
  RTCScene embree() const { return scene_; }

  void Intersect(RayPacket& packet, RayOrder order) const;
  /// Afterwards tfar is negative in the lanes with `valid` -1 that have something on their way.
  void Occlude(const int* valid, RTCRay16& rays, RayOrder order) const;
  /// The point hit by lane `lane` of a packet, whose direction must be `direction` (unit).
  SurfacePoint Surface(const RayPacket& packet, int lane, const Eigen::Vector3f& direction) const;
  /// A point of an object, seen from direction `to_eye` (unit).
  SurfacePoint SurfaceAt(int object, int triangle, float u, float v,
                         const Eigen::Vector3f& to_eye) const;
  /// Where a ray that leaves `surface` in `direction` starts: off the facet, by a little more than
  /// float32 rounds (Waechter and Binder 2019 explain why that is needed).
  static Eigen::Vector3f Departure(const SurfacePoint& surface, const Eigen::Vector3f& direction);

  /// The scene for sample_data/lanes; valid as long as this is.
  const SceneTables& tables() const { return tables_; }
  /// Sets the colours of those of the first `lanes` points of a pack that are looked up one by one:
  /// textures and prints.
  void LookUpColors(const RayPacket& packet, int lanes, SurfacePack& pack) const;

 private:
  void Add(const SceneObject& object);
  void AddSet();
  void Attach(unsigned id, int first_triangle, int triangles);
  Material ColorsAt(int object, int triangle, float u, float v,
                    const Eigen::Vector3f& position) const;

  const std::vector<SceneObject>* objects_;
  std::vector<Patch> patches_;
  const SetReflectance* reflectance_;
  std::vector<TextureFrame> texture_frames_;  // an object each
  std::vector<float> vertices_, geometry_floats_, patch_floats_;
  std::vector<int32_t> triangles_, geometry_ints_;
  SceneTables tables_;
  bool has_specular_paths_ = false;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace lfm
