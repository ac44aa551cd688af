// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/coat_shading.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

// Wider vectors where the machine has them; sanitizers start too late for the dispatcher.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LFM_WIDE_CLONES \
  __attribute__((target_clones("arch=skylake-avx512", "arch=haswell", "default")))
#else
#define LFM_WIDE_CLONES
#endif

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

struct Corners {
  int index[3];
  float weight[3];
};

Corners CornersOf(const CoatShading& shading, const SurfaceHit& hit) {
  const Eigen::Vector3i& t = shading.subject.mesh.triangles[hit.triangle];
  return {{t[0], t[1], t[2]}, {1 - hit.u - hit.v, hit.u, hit.v}};
}

LFM_WIDE_CLONES
void BlendBytes(const uint8_t* a, const uint8_t* b, const uint8_t* c, float wa, float wb, float wc,
                int count, float* out) {
  for (int i = 0; i < count; ++i) {
    out[i] = (wa * static_cast<float>(a[i]) + wb * static_cast<float>(b[i]) +
              wc * static_cast<float>(c[i])) *
             (1 / 255.0f);
  }
}

LFM_WIDE_CLONES
void BlendFloats(const float* a, const float* b, const float* c, float wa, float wb, float wc,
                 int count, float* out) {
  for (int i = 0; i < count; ++i) out[i] = wa * a[i] + wb * b[i] + wc * c[i];
}

LFM_WIDE_CLONES
void ReflectCells(const LampCells& cells, float px, float py, float pz, float nx, float ny,
                  float nz, float vx, float vy, float vz, float alpha, const float* visibility,
                  float* scale, float* bias) {
  const float a2 = alpha * alpha;
  const float nv = nx * vx + ny * vy + nz * vz;
  const float smith_v = std::sqrt(nv * nv * (1 - a2) + a2);
  const float a2_over_pi = a2 / std::numbers::pi_v<float>;
  for (int i = 0; i < cells.count; ++i) {
    const float dx = cells.x[i] - px, dy = cells.y[i] - py, dz = cells.z[i] - pz;
    const float inverse_r2 = 1 / (dx * dx + dy * dy + dz * dz);
    const float inverse_r = std::sqrt(inverse_r2);
    const float lx = dx * inverse_r, ly = dy * inverse_r, lz = dz * inverse_r;
    const float raw_nl = nx * lx + ny * ly + nz * lz;
    const float nl = raw_nl > 0 ? raw_nl : 0;
    const float raw_lamp = -(cells.nx[i] * lx + cells.ny[i] * ly + cells.nz[i] * lz);
    const float lamp = raw_lamp > 0 ? raw_lamp : 0;
    const float hx = lx + vx, hy = ly + vy, hz = lz + vz;
    const float inverse_h = 1 / std::sqrt(hx * hx + hy * hy + hz * hz + 1e-12f);
    const float nh = (nx * hx + ny * hy + nz * hz) * inverse_h;
    const float vh = (vx * hx + vy * hy + vz * hz) * inverse_h;
    const float t = nh * nh * (a2 - 1) + 1;
    const float d = a2_over_pi / (t * t);
    // Height-correlated Smith over 4 (n.v)(n.l).
    const float smith = 0.5f / (nl * smith_v + nv * std::sqrt(nl * nl * (1 - a2) + a2) + 1e-9f);
    const float m = 1 - vh, m2 = m * m;
    const float fresnel = m2 * m2 * m;
    const float w = d * smith * nl * lamp * inverse_r2 * cells.area[i] * visibility[i];
    scale[i] = w * (1 - fresnel);
    bias[i] = w * fresnel;
  }
}

}  // namespace

LampCells MakeLampCells(const Lighting& lighting) {
  LampCells cells;
  for (const AreaLight& light : lighting.lights) {
    const V3f n = light.Normal().cast<float>();
    for (int cell = 0; cell < kLightCells; ++cell) {
      const Eigen::Vector3d p = light.Point((cell % kLightCellsPerSide + 0.5) / kLightCellsPerSide,
                                            (cell / kLightCellsPerSide + 0.5) / kLightCellsPerSide);
      const int i = cells.count++;
      cells.x[i] = static_cast<float>(p.x());
      cells.y[i] = static_cast<float>(p.y());
      cells.z[i] = static_cast<float>(p.z());
      cells.nx[i] = n.x();
      cells.ny[i] = n.y();
      cells.nz[i] = n.z();
      cells.area[i] = static_cast<float>(light.Area() / kLightCells);
    }
  }
  return cells;
}

void ReflectLampCells(const LampCells& cells, const V3f& point, const V3f& n, const V3f& v,
                      float alpha, const float* visibility, float* scale, float* bias) {
  ReflectCells(cells, point.x(), point.y(), point.z(), n.x(), n.y(), n.z(), v.x(), v.y(), v.z(),
               alpha, visibility, scale, bias);
}

V3f CoatRadiance(const CoatShading& shading, const SurfaceHit& hit, const V3f& point,
                 const V3f& to_eye) {
  const Corners corners = CornersOf(shading, hit);
  const int* id = corners.index;
  const float* w = corners.weight;
  Eigen::Vector3d blended = Eigen::Vector3d::Zero();
  V3f coat = V3f::Zero();
  float alpha = 0;
  for (int c = 0; c < 3; ++c) {
    blended += w[c] * shading.subject.mesh.normals[id[c]];
    coat += w[c] * shading.subject.paint[id[c]].coat;
    alpha += w[c] * shading.subject.paint[id[c]].alpha;
  }
  V3f n = blended.normalized().cast<float>();
  const float facing = n.dot(to_eye);
  // At silhouettes the blended normal may lean away from the eye: bend it back to grazing.
  constexpr float kGrazing = 0.02f;
  if (facing < kGrazing) {
    if (facing < -0.5f) return V3f::Zero();
    n = (n + (kGrazing - facing) * to_eye).normalized();
  }
  const float nv = std::max(kGrazing * 0.5f, n.dot(to_eye));

  const BakedLight& light = shading.light;
  alignas(64) float visibility[kMaxLights * kLightCells];
  alignas(64) float scale[kMaxLights * kLightCells], bias[kMaxLights * kLightCells];
  const auto bytes = [&](int c) {
    return &light.cell_visibility[static_cast<size_t>(id[c]) * light.cells];
  };
  BlendBytes(bytes(0), bytes(1), bytes(2), w[0], w[1], w[2], light.cells, visibility);
  ReflectLampCells(shading.cells, point, n, to_eye, alpha, visibility, scale, bias);
  V3f radiance = V3f::Zero();
  for (size_t l = 0; l < shading.lighting.lights.size(); ++l) {
    float by_f0 = 0, rise = 0;
    for (int i = 0; i < kLightCells; ++i) {
      by_f0 += scale[l * kLightCells + i];
      rise += bias[l * kLightCells + i];
    }
    radiance +=
        shading.lighting.lights[l].radiance.cwiseProduct(by_f0 * coat + V3f::Constant(rise));
  }

  alignas(64) float harmonics[kHarmonics * 3];
  const auto bands = [&](int c) {
    return &light.harmonics[static_cast<size_t>(id[c]) * kHarmonics * 3];
  };
  BlendFloats(bands(0), bands(1), bands(2), w[0], w[1], w[2], kHarmonics * 3, harmonics);
  const CoatLobe lobe = shading.lobes.Lookup(nv, alpha);
  const V3f sideways = nv * n - to_eye;
  const float length = sideways.norm();
  V3f mean = static_cast<float>(lobe.mean_cos) * n;
  if (length > 1e-5f) mean += static_cast<float>(lobe.mean_sin) / length * sideways;
  const auto basis = EvaluateHarmonics(mean.normalized());
  V3f incident = V3f::Zero();
  for (int k = 0; k < kHarmonics; ++k) {
    const float weight = basis[k] * static_cast<float>(lobe.zonal[kHarmonicBand[k]]);
    incident += weight * V3f(harmonics[3 * k], harmonics[3 * k + 1], harmonics[3 * k + 2]);
  }
  const V3f albedo =
      static_cast<float>(lobe.scale) * coat + V3f::Constant(static_cast<float>(lobe.bias));
  return radiance + albedo.cwiseProduct(incident.cwiseMax(0.0f));
}

V3f BaseRadiance(const CoatShading& shading, const SurfaceHit& hit) {
  const Corners corners = CornersOf(shading, hit);
  return corners.weight[0] * shading.light.diffuse_radiance[corners.index[0]] +
         corners.weight[1] * shading.light.diffuse_radiance[corners.index[1]] +
         corners.weight[2] * shading.light.diffuse_radiance[corners.index[2]];
}

}  // namespace lfm
