// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/dancer_shape.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sample_data/bust_shape.h"
#include "sample_data/shapes/implicit.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kReach = 6;         // of blends
constexpr double kHeadScale = 0.29;  // of the bust's head
const V3 kStance(0, 8, 0);           // the figure's frame, behind the middle of its foot

struct Parts {
  double skin, hair, dress, shoes, foot;
};

double RaisedLeg(const V3& p) {
  const V3 hip(-3.6, 2, 63), knee(-8.5, 24.5, 67.5), ankle(-11, 46.5, 75.5);
  double d = Limb(p, hip, knee, 4.9, 3.1);
  d = SmoothUnion(d, Limb(p, knee, ankle, 2.9, 1.75), 3);
  return SmoothUnion(d, Ellipsoid(p, {-9.2, 32.5, 69.3}, {2.7, 6.5, 2.9}), 2.5);  // calf
}

double StandingLeg(const V3& p) {
  const V3 hip(3.7, 0.8, 62), knee(3.1, -0.8, 38), ankle(2.4, 0.9, 13.5);
  double d = Limb(p, hip, knee, 5.0, 3.1);
  d = SmoothUnion(d, Ellipsoid(p, {3.4, -1.4, 50}, {4.4, 4.4, 9}), 3);
  d = SmoothUnion(d, Limb(p, knee, ankle, 2.8, 1.8), 3);
  return SmoothUnion(d, Ellipsoid(p, {2.8, 1.6, 29.5}, {2.8, 2.9, 7}), 2.5);  // calf
}

double Shoes(const V3& p) {
  double d = Limb(p, {2.2, -1.0, 4.6}, {2.4, 0.4, 11.5}, 1.5, 2.1);
  d = SmoothUnion(d, Ball(p, {2.4, 2.0, 13}, 1.7), 1.5);  // heel
  const double raised = Limb(p, {-11, 46.5, 75.3}, {-12, 57.5, 78.5}, 1.95, 1.2);
  return std::min(d, SmoothUnion(raised, Ball(p, {-11.1, 47.2, 77.4}, 1.5), 1.5));
}

double Torso(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Ellipsoid(p, {0, 1.2, 65}, {7.4, 5.8, 6});
  d = SmoothUnion(d, Ellipsoid(p, {0, 0.2, 73.5}, {5.2, 4.0, 7}), 3);
  d = SmoothUnion(d, Ellipsoid(p, {0, -1.0, 82}, {7.3, 4.9, 7.5}), 3);
  return SmoothUnion(d, Ellipsoid(m, {3.2, -4.4, 82.6}, {2.9, 2.6, 2.9}), 1.6);
}

double Arms(const V3& p) {
  const V3 left(8.6, -0.6, 88.8), left_elbow(15.2, -3, 98.5), left_wrist(9.5, -6.4, 108.6);
  const V3 right(-8.6, -0.6, 88.8), right_elbow(-20.5, -2.2, 85.6), right_wrist(-31, -7, 88.2);
  const auto arm = [&p](const V3& shoulder, const V3& elbow, const V3& wrist, const V3& tip) {
    double d = Limb(p, shoulder, elbow, 2.5, 1.9);
    d = SmoothUnion(d, Limb(p, elbow, wrist, 1.9, 1.3), 1.2);
    d = SmoothUnion(d, Limb(p, wrist, wrist + 0.55 * (tip - wrist), 1.35, 1.5), 1);
    return SmoothUnion(d, Limb(p, wrist + 0.45 * (tip - wrist), tip, 1.35, 0.8), 1);
  };
  return std::min(arm(left, left_elbow, left_wrist, {2.0, -7.2, 113.6}),
                  arm(right, right_elbow, right_wrist, {-38, -8.4, 91}));
}

V3 HeadFrame(const V3& p) {
  static const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.35, V3::UnitZ()) * Eigen::AngleAxisd(-0.16, V3::UnitX()))
          .inverse()
          .toRotationMatrix();
  return turn * (p - V3(-0.2, -2.2, 102.3)) / kHeadScale;
}

double Head(const V3& p) {
  double d = Limb(p, {0, -0.4, 88}, {-0.1, -1.6, 97}, 2.6, 2.4);
  d = SmoothUnion(d, Limb(Mirrored(p), {1.5, 0, 91}, {8.4, -0.4, 88.8}, 2.2, 2.5), 3);
  return SmoothUnion(d, kHeadScale * BustFaceDistance(HeadFrame(p)), 1.2);
}

double Hair(const V3& p) {
  const V3 h = HeadFrame(p);
  double d = Ellipsoid(h, {0, 4.5, 9.5}, {21.2, 23.8, 21});
  const double line = 0.87 * (13 - h.z() - 0.62 * (h.y() + 18) - 0.010 * h.x() * h.x());
  d = SmoothIntersection(d, line, 2);
  d = SmoothUnion(d, Ball(h, {0, 21, 25}, 11.5), 2.5);  // bun
  return kHeadScale * SmoothUnion(d, Ring(h, {0, 19, 19}, 9, 2), 2);
}

// A stiff skirt, higher behind, in waves that grow towards its rim.
double Tutu(const V3& p) {
  static const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(0.24, V3::UnitX()).inverse().toRotationMatrix();
  const V3 q = tilt * (p - V3(0, 1.0, 69));
  const double r = std::hypot(q.x(), q.y()), around = std::atan2(q.y(), q.x());
  const double out = std::min(r / 23, 1.2);
  const double wave = 1.3 * out * out * std::cos(15 * around);
  const double middle = wave - 1.8 * out * out;
  const double half = 0.8 + 1.9 * (1 - out) * (1 - out) * (out < 1);
  const double rim = r - 23 - 0.9 * std::cos(15 * around + 0.8);
  return SmoothIntersection(0.8 * (std::abs(q.z() - middle) - half), rim, 1.0);
}

double Foot(const V3& p) {
  double d = RoundDisc(p, kStance + V3(0, 0, 1.0), 25, 2.2, 0.8);
  return SmoothUnion(d, RoundDisc(p, kStance + V3(0, 0, 3.4), 21, 1.2, 0.6), 0.8);
}

Parts PartDistances(const V3& point) {
  const V3 p = point + kStance;
  Parts parts;
  const double legs =
      Bounded(p, {0, 20, 58}, 52, kReach, [&] { return std::min(RaisedLeg(p), StandingLeg(p)); });
  const double torso = Bounded(p, {0, 0, 76}, 17, kReach, [&] { return Torso(p); });
  const double arms = Bounded(p, {-12, -4, 98}, 30, kReach, [&] { return Arms(p); });
  const double head = Bounded(p, {0, -1, 99}, 17, kReach, [&] { return Head(p); });
  parts.skin = SmoothUnion(SmoothUnion(SmoothUnion(torso, legs, 2.5), head, 1.5), arms, 1.5);
  parts.hair = Bounded(p, {0, 1, 106}, 12, kReach, [&] { return Hair(p); });
  const double neckline = p.z() - 84.5 - 0.12 * p.x() * p.x() + (p.y() > 0 ? 0.35 * p.y() : 0.0);
  const double bodice = SmoothIntersection(torso - 0.55, 0.8 * neckline, 0.6);
  parts.dress = SmoothUnion(bodice, Bounded(p, {0, 1, 69}, 28, kReach, [&] { return Tutu(p); }), 2);
  parts.shoes = Bounded(p, {-5, 27, 45}, 56, kReach, [&] { return Shoes(p) - 0.15; });
  parts.foot = Foot(p);
  return parts;
}

double Distance(const V3& p) {
  const Parts parts = PartDistances(p);
  double d = SmoothUnion(parts.skin, parts.shoes, 0.6);
  d = SmoothUnion(d, parts.hair, 0.5);
  d = SmoothUnion(d, parts.dress, 0.7);
  d = SmoothUnion(d, parts.foot, 0.8);
  return SmoothIntersection(d, -p.z(), 0.8);
}

double Smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Paint Blend(const Paint& a, const Paint& b, double t) {
  const float w = static_cast<float>(t);
  return {a.diffuse + w * (b.diffuse - a.diffuse), a.coat + w * (b.coat - a.coat),
          a.alpha + w * (b.alpha - a.alpha)};
}

Paint DressPaint(const V3& p, uint64_t seed) {
  const Paint silk = {{0.16f, 0.27f, 0.46f}, {0.24f, 0.30f, 0.40f}, 0.24f};
  const Paint pale = {{0.55f, 0.58f, 0.62f}, {0.28f, 0.28f, 0.30f}, 0.26f};
  const Paint gold = {{0.46f, 0.31f, 0.08f}, {0.40f, 0.30f, 0.12f}, 0.22f};
  const V3 q = p + kStance - V3(0, 1, 0);
  const double r = std::hypot(q.x(), q.y());
  const double tutu = Smoothstep(77, 74, p.z()) * Smoothstep(8, 10, r);
  Paint paint = Blend(silk, pale, tutu * (0.8 + 0.2 * GradientNoise(p / 3, seed)));
  paint = Blend(paint, gold, Smoothstep(0.9, 0.5, std::abs(r - 20.5)) * tutu);
  const double lace = std::abs(std::remainder(p.z() + 0.8 * std::abs(p.x()), 5.0));
  return Blend(paint, gold, Smoothstep(0.7, 0.4, lace) * (1 - tutu) * Smoothstep(72, 74, p.z()));
}

Paint DancerPaint(const V3& p, uint64_t seed) {
  const Parts d = PartDistances(p);
  const double nearest = std::min({d.skin, d.hair, d.dress, d.shoes, d.foot});
  if (nearest == d.dress) return DressPaint(p, seed);
  const double soft = GradientNoise(p / 7, seed + 1);
  if (nearest == d.hair) return {{0.07f, 0.035f, 0.02f}, {0.16f, 0.12f, 0.09f}, 0.28f};
  if (nearest == d.shoes) return {{0.55f, 0.22f, 0.24f}, {0.34f, 0.24f, 0.24f}, 0.22f};
  if (nearest == d.foot) {
    const double vein = std::abs(GradientNoise(p / 9 + V3::Constant(0.6 * soft), seed + 2));
    return Blend({{0.50f, 0.48f, 0.42f}, {0.18f, 0.18f, 0.17f}, 0.22f},
                 {{0.10f, 0.19f, 0.15f}, {0.22f, 0.25f, 0.24f}, 0.24f},
                 Smoothstep(0.02, 0.14, vein));
  }
  Paint skin = {{0.50f, 0.32f, 0.22f}, {0.22f, 0.17f, 0.13f}, 0.30f};
  skin.diffuse *= static_cast<float>(1 + 0.12 * soft);
  const V3 h = HeadFrame(p + kStance);
  if (h.y() < -10 && std::abs(h.x()) < 17 && h.z() > -24) {
    const double lips = std::hypot(h.x() / 6.5, (h.z() + 12.6) / 3.2);
    skin = Blend(skin, {{0.40f, 0.12f, 0.10f}, {0.25f, 0.16f, 0.14f}, 0.25f},
                 Smoothstep(1.2, 0.8, lips));
    const double x = std::abs(h.x());
    const double eye = std::hypot((x - 7.3) / 1.6, h.z() - 2.8);
    skin = Blend(skin, {{0.03f, 0.025f, 0.03f}, {0.15f, 0.14f, 0.14f}, 0.25f},
                 Smoothstep(2.8, 2.0, eye));
    const double brow = std::abs(h.z() - 10 + 0.035 * (x - 7) * (x - 7));
    skin = Blend(skin, {{0.07f, 0.04f, 0.02f}, {0.14f, 0.11f, 0.09f}, 0.3f},
                 Smoothstep(1.8, 0.8, brow) * Smoothstep(2.5, 4, x) * Smoothstep(14, 12, x));
  }
  return skin;
}

}  // namespace

Shape MakeDancer(double edge_mm, uint64_t seed) {
  Shape shape = PolygoniseShape(Distance, {-42, -36, 0}, {28, 54, 118}, edge_mm, 2);
  PaintShape(shape, [seed](const V3& p) { return DancerPaint(p, seed); });
  return shape;
}

}  // namespace lfm
