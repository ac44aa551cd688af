// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/paint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample_data/bust_shape.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using Color = Eigen::Vector3f;

double Smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double LatticeGradient(int64_t x, int64_t y, int64_t z, uint64_t seed, const V3& offset) {
  uint64_t bits = ScrambleBits(seed ^ ScrambleBits(static_cast<uint64_t>(x) * 0x8da6b343ull ^
                                                   static_cast<uint64_t>(y) * 0xd8163841ull ^
                                                   static_cast<uint64_t>(z) * 0xcb1ab31full));
  static constexpr double kDirections[12][3] = {{1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0},
                                                {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
                                                {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}};
  const double* d = kDirections[bits % 12];
  return d[0] * offset.x() + d[1] * offset.y() + d[2] * offset.z();
}

double Fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double Turbulence(const V3& p, uint64_t seed) {
  return GradientNoise(p, seed) + 0.5 * GradientNoise(2.03 * p, seed + 1) +
         0.25 * GradientNoise(4.01 * p, seed + 2);
}

Paint Mix(const Paint& a, const Paint& b, double t) {
  const float w = static_cast<float>(t);
  return {a.diffuse + w * (b.diffuse - a.diffuse), a.coat + w * (b.coat - a.coat),
          a.alpha + w * (b.alpha - a.alpha)};
}

Paint SkinPaint(const V3& p, uint64_t seed) {
  Paint skin = {{0.40f, 0.245f, 0.155f}, {0.36f, 0.28f, 0.20f}, 0.27f};
  const double soft = Turbulence(p / 9, seed);
  skin.diffuse *= static_cast<float>(1 + 0.22 * soft + 0.10 * GradientNoise(p / 1.7, seed + 7));
  const Paint verdigris = {{0.20f, 0.30f, 0.24f}, {0.16f, 0.20f, 0.18f}, 0.34f};
  skin =
      Mix(skin, verdigris, 0.75 * Smoothstep(0.25, 0.75, Turbulence(p / 13 + V3(5, 2, 9), seed)));
  const V3 h = BustHeadFrame(p);
  if (h.y() < -10 && std::abs(h.x()) < 17) {
    const double x = std::abs(h.x());
    const double blush = std::exp(-((V3(x, h.y(), h.z()) - V3(10.5, -16, -5)).squaredNorm()) / 22);
    skin = Mix(skin, {{0.36f, 0.12f, 0.08f}, {0.30f, 0.20f, 0.15f}, 0.27f}, 0.7 * blush);
    const double lips = Smoothstep(
        1.1, 0.8, std::hypot(h.x() / 6.0, (h.z() + 12.6) / (2.9 - 0.02 * h.x() * h.x())));
    skin = Mix(skin, {{0.30f, 0.035f, 0.035f}, {0.30f, 0.16f, 0.15f}, 0.22f}, lips);
    const double brow_z = 9.6 - 0.035 * (x - 7) * (x - 7);
    const double brow = Smoothstep(1.5, 0.7, std::abs(h.z() - brow_z)) * Smoothstep(2.5, 4, x) *
                        Smoothstep(14.5, 12.5, x);
    skin = Mix(skin, {{0.035f, 0.025f, 0.02f}, {0.10f, 0.09f, 0.08f}, 0.32f}, 0.9 * brow);
    const double eye = std::hypot(x - 7.3, h.z() - 2.5);
    const double white = Smoothstep(5.15, 4.7, (V3(x, h.y(), h.z()) - V3(7.3, -14.0, 2.8)).norm()) *
                         Smoothstep(4.9, 4.2, eye);
    skin = Mix(skin, {{0.55f, 0.52f, 0.47f}, {0.18f, 0.18f, 0.18f}, 0.21f}, white);
    skin = Mix(skin, {{0.04f, 0.11f, 0.20f}, {0.20f, 0.22f, 0.25f}, 0.20f},
               white * Smoothstep(2.4, 1.8, eye));
    skin = Mix(skin, {{0.01f, 0.01f, 0.01f}, {0.15f, 0.15f, 0.15f}, 0.20f},
               white * Smoothstep(1.2, 0.7, eye));
  }
  return skin;
}

Paint HairPaint(const V3& p, uint64_t seed) {
  const V3 h = BustHeadFrame(p);
  const double around = std::atan2(h.x(), -(h.y() - 3));
  const double strand = GradientNoise(V3(9 * around, 0.12 * h.z(), 0.1 * h.y()), seed + 11);
  Paint hair = {{0.13f, 0.070f, 0.038f}, {0.33f, 0.25f, 0.17f}, 0.27f};
  hair.diffuse *= static_cast<float>(1 + 0.6 * strand);
  const double gilt = Smoothstep(0.15, 0.6, Turbulence(p / 7 + V3(1, 7, 3), seed));
  return Mix(hair, {{0.34f, 0.22f, 0.07f}, {0.42f, 0.32f, 0.16f}, 0.25f}, 0.7 * gilt);
}

Paint ClothPaint(const V3& p, uint64_t seed) {
  Paint cloth = {{0.30f, 0.045f, 0.065f}, {0.28f, 0.17f, 0.18f}, 0.30f};
  cloth.diffuse *= static_cast<float>(1 + 0.3 * Turbulence(p / 6, seed + 21));
  const Paint gold = {{0.46f, 0.32f, 0.09f}, {0.36f, 0.28f, 0.13f}, 0.25f};
  const Paint blue = {{0.05f, 0.10f, 0.32f}, {0.16f, 0.18f, 0.28f}, 0.28f};
  // Stripes along the folds, lozenges between them.
  const double along = 0.62 * p.x() + p.z() - 0.10 * p.y() - 0.35 * p.x();
  const double stripe = std::cos(2 * std::numbers::pi * along / 13);
  const double u = std::atan2(p.x(), -p.y()) * 30;
  const double lozenge = std::abs(std::remainder(u, 7.0)) + std::abs(std::remainder(along, 13.0));
  cloth = Mix(cloth, blue, Smoothstep(0.55, 0.75, stripe));
  cloth = Mix(cloth, gold, Smoothstep(2.2, 1.5, lozenge));
  return Mix(cloth, gold, Smoothstep(0.75, 0.9, -stripe));
}

Paint PedestalPaint(const V3& p, uint64_t seed) {
  Paint stone = {{0.16f, 0.22f, 0.19f}, {0.22f, 0.25f, 0.24f}, 0.24f};
  const double warp = Turbulence(p / 14, seed + 31);
  const double vein = std::abs(GradientNoise(p / 8 + V3(warp, -warp, warp), seed + 33));
  stone.diffuse *= static_cast<float>(1 + 0.35 * warp);
  return Mix(stone, {{0.55f, 0.53f, 0.47f}, {0.18f, 0.18f, 0.17f}, 0.22f},
             0.85 * Smoothstep(0.13, 0.02, vein));
}

}  // namespace

double GradientNoise(const V3& p, uint64_t seed) {
  const V3 floor = p.array().floor();
  const V3 f = p - floor;
  const int64_t x = static_cast<int64_t>(floor.x()), y = static_cast<int64_t>(floor.y());
  const int64_t z = static_cast<int64_t>(floor.z());
  const V3 w(Fade(f.x()), Fade(f.y()), Fade(f.z()));
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
    const double weight =
        (i ? w.x() : 1 - w.x()) * (j ? w.y() : 1 - w.y()) * (k ? w.z() : 1 - w.z());
    sum += weight * LatticeGradient(x + i, y + j, z + k, seed, f - V3(i, j, k));
  }
  return std::clamp(sum, -1.0, 1.0);
}

Paint PaintBust(const V3& point_mm, uint64_t seed) {
  const BustParts parts = BustPartDistances(point_mm);
  const double d[4] = {parts.skin, parts.hair, parts.cloth, parts.pedestal};
  const double nearest = *std::min_element(d, d + 4);
  Paint paint;
  paint.alpha = 0;
  double total = 0;
  for (int part = 0; part < 4; ++part) {
    const double weight = Smoothstep(0.7, 0, d[part] - nearest);
    if (weight <= 0) continue;
    const Paint own = part == 0   ? SkinPaint(point_mm, seed)
                      : part == 1 ? HairPaint(point_mm, seed)
                      : part == 2 ? ClothPaint(point_mm, seed)
                                  : PedestalPaint(point_mm, seed);
    paint.diffuse += static_cast<float>(weight) * own.diffuse;
    paint.coat += static_cast<float>(weight) * own.coat;
    paint.alpha += static_cast<float>(weight) * own.alpha;
    total += weight;
  }
  const float scale = static_cast<float>(1 / total);
  paint.diffuse *= scale;
  paint.coat *= scale;
  const double rub = 0.02 * GradientNoise(point_mm / 6, seed + 41);
  paint.alpha = std::clamp(paint.alpha * scale + static_cast<float>(rub), 0.2f, 0.35f);
  return paint;
}

Paint PaintMesh(const V3& point_mm, const Color& base, uint64_t seed) {
  const double soft = Turbulence(point_mm / 11, seed);
  Paint paint;
  paint.diffuse = 0.75f * base * static_cast<float>(1 + 0.3 * soft);
  paint.coat = Color::Constant(0.1f) + 0.5f * base;
  paint.alpha = std::clamp(
      static_cast<float>(0.275 + 0.075 * GradientNoise(point_mm / 15, seed + 3)), 0.2f, 0.35f);
  return paint;
}

}  // namespace lfm
