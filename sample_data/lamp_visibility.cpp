// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/lamp_visibility.h"

#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kOffsetMm = 0.02f;

// Shares of one lamp's cells that are not hidden; the remaining rays are spent only where the
// first ray of each cell does not already agree with all others. Returns how many were asked.
int SeeCells(const StudioScene& scene, const AreaLight& light, const V3f& origin, int rays,
             float* visibility) {
  const int side = std::max(1, static_cast<int>(std::lround(std::sqrt(rays))));
  int seen[kLightCells] = {};
  for (int pass = 0; pass < side * side; ++pass) {
    RayPacket packet;
    // The middle of each cell comes first.
    const int sub = (pass + side * side / 2) % (side * side);
    for (int cell = 0; cell < kLightCells; ++cell) {
      const double s = (cell % kLightCellsPerSide + (sub % side + 0.5) / side) / kLightCellsPerSide;
      const double t = (cell / kLightCellsPerSide + (sub / side + 0.5) / side) / kLightCellsPerSide;
      const V3f direction = light.Point(s, t).cast<float>() - origin;
      packet.Set(cell, origin, direction, 0, 0.999f);
    }
    scene.Occlude(packet);
    int total = 0;
    for (int cell = 0; cell < kLightCells; ++cell) {
      seen[cell] += !StudioScene::Blocked(packet, cell);
      total += seen[cell];
    }
    if (pass == 0 && (total == 0 || total == kLightCells)) {
      for (int cell = 0; cell < kLightCells; ++cell)
        visibility[cell] = static_cast<float>(seen[cell]);
      return kLightCells;
    }
  }
  for (int cell = 0; cell < kLightCells; ++cell) {
    visibility[cell] = static_cast<float>(seen[cell]) / static_cast<float>(side * side);
  }
  return side * side * kLightCells;
}

}  // namespace

float LampForms(const AreaLight& light, const V3f& point, const V3f& normal, float* form) {
  float total = 0;
  const V3f lamp_normal = light.Normal().cast<float>();
  for (int cell = 0; cell < kLightCells; ++cell) {
    const V3f d = light
                      .Point((cell % kLightCellsPerSide + 0.5) / kLightCellsPerSide,
                             (cell / kLightCellsPerSide + 0.5) / kLightCellsPerSide)
                      .cast<float>() -
                  point;
    const float r2 = d.squaredNorm();
    const float cosines = std::max(0.0f, normal.dot(d)) * std::max(0.0f, -lamp_normal.dot(d));
    form[cell] = cosines / (r2 * r2) * static_cast<float>(light.Area() / kLightCells);
    total += form[cell];
  }
  return total;
}

LampLight GatherLamps(const StudioScene& scene, const Lighting& lighting, const V3f& point,
                      const V3f& normal, int rays_per_cell) {
  LampLight result;
  const V3f origin = point + kOffsetMm * normal;
  for (size_t l = 0; l < lighting.lights.size(); ++l) {
    const AreaLight& light = lighting.lights[l];
    float* visibility = result.visibility + l * kLightCells;
    float form[kLightCells];
    if (LampForms(light, point, normal, form) <= 0) continue;
    result.rays += SeeCells(scene, light, origin, rays_per_cell, visibility);
    float received = 0;
    for (int cell = 0; cell < kLightCells; ++cell) received += visibility[cell] * form[cell];
    result.irradiance += received * light.radiance;
  }
  return result;
}

}  // namespace lfm
