// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/occluder_shadow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr int kRaysPerCell = 4;
constexpr float kPi = std::numbers::pi_v<float>;

// Whether all cells that the surface faces are free.
bool IsFree(const LampLight& past_occluder, const Lighting& lighting, const V3f& point,
            const V3f& normal) {
  for (size_t l = 0; l < lighting.lights.size(); ++l) {
    float form[kLightCells];
    if (LampForms(lighting.lights[l], point, normal, form) <= 0) continue;
    const float* seen = past_occluder.visibility + l * kLightCells;
    if (std::any_of(seen, seen + kLightCells, [](float v) { return v < 1; })) return false;
  }
  return true;
}

// Irradiance that reached the point by `visibility` (0 to 1, a lamp cell each) and the occluder
// hides.
V3f HiddenIrradiance(const Lighting& lighting, const V3f& point, const V3f& normal,
                     const float* visibility, const LampLight& past_occluder) {
  V3f hidden = V3f::Zero();
  for (size_t l = 0; l < lighting.lights.size(); ++l) {
    float form[kLightCells];
    if (LampForms(lighting.lights[l], point, normal, form) <= 0) continue;
    float received = 0;
    for (int cell = 0; cell < kLightCells; ++cell) {
      const size_t i = l * kLightCells + cell;
      received += form[cell] * visibility[i] * (1 - past_occluder.visibility[i]);
    }
    hidden += received * lighting.lights[l].radiance;
  }
  return hidden;
}

void ShadowVertices(const StudioScene& occluder, const Subject& subject, const Lighting& lighting,
                    BakedLight& light) {
  ParallelFor(
      0, static_cast<int64_t>(subject.mesh.vertices.size()),
      [&](int64_t v) {
        const V3f point = subject.mesh.vertices[v].cast<float>();
        const V3f normal = subject.mesh.normals[v].cast<float>();
        const LampLight past = GatherLamps(occluder, lighting, point, normal, kRaysPerCell);
        if (IsFree(past, lighting, point, normal)) return;
        uint8_t* seen = &light.cell_visibility[v * light.cells];
        float visibility[kMaxLights * kLightCells];
        for (int c = 0; c < light.cells; ++c) visibility[c] = static_cast<float>(seen[c]) / 255;
        const V3f hidden = HiddenIrradiance(lighting, point, normal, visibility, past);
        const V3f lost = BaseAlbedo(subject.paint[v]).cwiseProduct(hidden) / kPi;
        light.diffuse_radiance[v] = (light.diffuse_radiance[v] - lost).cwiseMax(0.0f);
        for (int c = 0; c < light.cells; ++c) {
          seen[c] =
              static_cast<uint8_t>(std::lround(static_cast<float>(seen[c]) * past.visibility[c]));
        }
      },
      256);
}

}  // namespace

BakedLight ShadowLight(const BakedLight& light, const StudioScene& scene, const Subject& subject,
                       const Lighting& lighting, const Occluder& occluder) {
  BakedLight shadowed = light;
  const TriangleMesh mesh = OccluderMesh(occluder);
  const StudioScene alone(&mesh, {});
  ShadowVertices(alone, subject, lighting, shadowed);
  for (size_t p = 0; p < shadowed.patches.size(); ++p) {
    PatchIrradiance& grid = shadowed.patches[p];
    ForEachPatchNode(
        scene.patches()[p], grid.columns, grid.rows,
        [&](size_t node, const V3f& point, const V3f& normal) {
          const LampLight past = GatherLamps(alone, lighting, point, normal, kRaysPerCell);
          if (IsFree(past, lighting, point, normal)) return;
          const LampLight past_scene = GatherLamps(scene, lighting, point, normal, kRaysPerCell);
          const V3f hidden = HiddenIrradiance(lighting, point, normal, past_scene.visibility, past);
          grid.irradiance[node] = (grid.irradiance[node] - hidden).cwiseMax(0.0f);
        });
  }
  return shadowed;
}

}  // namespace lfm
