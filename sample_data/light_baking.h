// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sample_data/harmonics.h"
#include "sample_data/lamp_visibility.h"
#include "sample_data/lighting.h"
#include "sample_data/path_tracer.h"
#include "sample_data/studio_scene.h"
#include "sample_data/subject.h"

namespace lfm {

/// Irradiance over a patch, on a grid of (columns x rows) nodes that includes its edges.
struct PatchIrradiance {
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector3f> irradiance;  ///< row by row

  /// Bilinear, at `a` mm along u and `b` mm along v.
  Eigen::Vector3f Sample(const Patch& patch, double a, double b) const;
};

/// Calls body(node, point, normal) for every node of a patch's grid, on all threads.
void ForEachPatchNode(
    const Patch& patch, int columns, int rows,
    const std::function<void(size_t node, const Eigen::Vector3f&, const Eigen::Vector3f&)>& body);

/// All light that does not depend on the view, computed once a capture.
struct BakedLight {
  /// Of each vertex of the object: radiance that leaves its diffuse base in every direction.
  std::vector<Eigen::Vector3f> diffuse_radiance;
  /// Share of each lamp cell (lights x kLightCells) that a vertex sees, 0 to 255; vertex-major.
  std::vector<uint8_t> cell_visibility;
  int cells = 0;
  /// Incident radiance from the surroundings, the set and the object itself, as spherical
  /// harmonics: kHarmonics x RGB a vertex. Below the vertex's horizon it is mirrored from above,
  /// so that a lobe near the horizon does not darken.
  std::vector<float> harmonics;
  std::vector<PatchIrradiance> patches;  ///< as StudioScene::patches()
  RayCounts rays;                        ///< that baking took
};

struct BakeOptions {
  int rays_per_cell = 9;        ///< shadow rays a lamp cell, where the lamp is partly hidden
  int gather_rays = 128;        ///< rays a vertex for surroundings and interreflection
  double plate_spacing_mm = 1;  ///< grid of the plate; the table's is 8 times as wide
  uint64_t seed = 1;
};

/// Bakes lamps (with shadows), surroundings, and one bounce of interreflection between object,
/// plate and table. The base reflects what the coat lets through: diffuse (1 - coat).
BakedLight BakeLight(const StudioScene& scene, const Subject& subject, const Lighting& lighting,
                     const SetReflectance& reflectance, const BakeOptions& options,
                     Progress& progress);
/// The same once a seed (options.seed is not used), as independent as baking with each alone; what
/// has no random numbers, the lamps' light, is baked once. At least one seed.
std::vector<BakedLight> BakeLights(const StudioScene& scene, const Subject& subject,
                                   const Lighting& lighting, const SetReflectance& reflectance,
                                   const BakeOptions& options, std::span<const uint64_t> seeds,
                                   Progress& progress);
/// What the diffuse base of a paint reflects of the light that falls on it.
Eigen::Vector3f BaseAlbedo(const Paint& paint);

}  // namespace lfm
