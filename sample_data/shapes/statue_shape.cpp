// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/statue_shape.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sample_data/bust_shape.h"
#include "sample_data/shapes/implicit.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kReach = 8;
constexpr double kHeadScale = 0.62;  // of the bust's head

// One petal of a ring of `count`, the ring turned by half a step where `half` is 1: the point is
// turned to the nearest petal's own axes (x across, y outwards).
V3 PetalFrame(const V3& p, int count, double half) {
  const double step = 2 * std::numbers::pi / count, around = std::atan2(p.y(), p.x());
  const double middle = (std::round(around / step - 0.5 * half) + 0.5 * half) * step;
  const double radius = std::hypot(p.x(), p.y());
  return {radius * std::sin(around - middle), radius * std::cos(around - middle), p.z()};
}

double Lotus(const V3& p) {
  const V3 q(p.x(), p.y() / 0.82, p.z());  // oval: narrower in depth
  double d = RoundDisc(q, {0, 0, 2.5}, 45, 3.5, 1.2);
  d = SmoothUnion(d, RoundDisc(q, {0, 0, 8}, 37, 5, 2), 2);
  d = SmoothUnion(d, RoundDisc(q, {0, 0, 17}, 38, 5.5, 2), 2);
  // Petals turned down and up, each a tilted ellipsoid with a keel.
  const auto petal = [](const V3& at, double tilt) {
    const V3 t = Eigen::AngleAxisd(tilt, V3::UnitX()) * at;
    const double leaf = Ellipsoid(t, V3::Zero(), {7.6, 3.4, 8.6});
    return SmoothUnion(leaf, Ellipsoid(t, {0, 2.4, 0}, {1.0, 1.8, 8.2}), 1.5);
  };
  const V3 up = PetalFrame(q, 16, 0), down = PetalFrame(q, 16, 1);
  d = SmoothUnion(d, petal(up - V3(0, 39, 17.5), 0.45), 1.0);
  d = SmoothUnion(d, petal(down - V3(0, 38.5, 9), -0.5), 1.0);
  return 0.85 * d;
}

double Legs(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Limb(m, {10, 8, 33}, {32, -7, 31}, 12, 9);
  d = SmoothUnion(d, Limb(m, {32, -7, 30.5}, {8, -24, 29.5}, 8.5, 6.5), 3);
  d = SmoothUnion(d, Ellipsoid(p, {0, 8, 32}, {26, 17, 11}), 8);
  d = SmoothUnion(d, Ellipsoid(p, {0, -10, 28}, {26, 14, 7}), 6);
  // The right foot lies on the left thigh, sole upwards.
  d = SmoothUnion(d, Limb(p, {-4, -23, 33}, {12, -20, 37}, 4.8, 4.2), 2.5);
  d = SmoothUnion(d, Limb(p, {12, -20, 37}, {19, -15, 38}, 3.8, 2.8), 1.5);
  // Folds of the robe run along the shins and fan out between them.
  const double along = m.x() * 0.45 - m.y() * 0.9;
  const double folds = std::cos(0.95 * (along + 0.9 * p.z()) + 1.6 * std::sin(0.11 * m.x()));
  const double fade = std::clamp((p.z() - 22) / 6, 0.0, 1.0);
  return d - 0.62 * folds * fade;
}

double Arms(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Limb(m, {20, 6, 72}, {29.5, 3, 50}, 7.2, 5.8);
  d = SmoothUnion(d, Limb(m, {29.5, 3, 50}, {11, -19, 42}, 5.8, 4.0), 2.5);
  // The hands lie in each other, thumbs touching.
  d = SmoothUnion(d, Limb(p, {11, -19.5, 42}, {-9, -22.5, 40.5}, 3.4, 2.2), 1.5);
  d = SmoothUnion(d, Limb(p, {-11, -18, 44.5}, {8, -21, 43.4}, 3.2, 2.0), 1.2);
  return SmoothUnion(d, Limb(m, {7, -19.5, 46}, {0.3, -21, 47.6}, 1.6, 1.2), 1.2);
}

double Torso(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Ellipsoid(p, {0, 8, 46}, {19, 14, 15});
  d = SmoothUnion(d, Ellipsoid(p, {0, 7, 63}, {20.5, 13, 16}), 8);
  d = SmoothUnion(d, Ball(m, {19.5, 7, 71.5}, 8.6), 7);
  d = SmoothUnion(d, Limb(m, {4, 7, 81}, {17, 7, 76}, 6, 5), 6);
  d = SmoothUnion(d, Ellipsoid(m, {8.5, -2.5, 68.5}, {8.5, 4.5, 7}), 4);
  return SmoothUnion(d, Ball(p, {0, -5.5, 45}, 4), 6);
}

// The robe leaves the right shoulder (x < 0) bare; its hem crosses the breast.
double Robe(const V3& p, double torso, double arms) {
  const double hem = 64 - 1.05 * p.x() - p.z() + 30 * std::clamp((p.y() - 6) / 12, 0.0, 1.0);
  const double body = SmoothUnion(torso, arms + 4 * std::clamp(0.5 - p.x() / 8, 0.0, 1.0), 4);
  const double axis = 0.72 * p.x() + 0.69 * p.z() + 2.0 * std::sin(0.09 * p.x() + 0.05 * p.y());
  const double folds = std::cos(0.88 * axis) + 0.35 * std::cos(1.76 * axis + 1);
  double d = body - 1.7 - 0.6 * folds;
  d = SmoothIntersection(d, 0.65 * -hem, 1.5);
  d = SmoothIntersection(d, 0.9 * (34 - p.z()), 2);
  const double roll = SmoothIntersection(body - 2.6, std::abs(0.65 * hem) - 1.5, 1.2);
  return SmoothUnion(d, SmoothIntersection(roll, 34 - p.z(), 1), 1);
}

double Head(const V3& p) {
  const V3 h = Eigen::AngleAxisd(-0.10, V3::UnitX()) * (p - V3(0, 1.5, 99)) / kHeadScale;
  const V3 m = Mirrored(h);
  double d = BustFaceDistance(h);
  d = SmoothUnion(d, Ellipsoid(m, {20, 4, -13}, {1.9, 3.4, 8}), 2);  // long ear lobes
  // Curled hair: a cap and the knot on top, studded all over.
  double hair = Ellipsoid(h, {0, 4.5, 9.5}, {21.0, 23.4, 20.4});
  hair = SmoothIntersection(hair, 0.87 * (13 - h.z() - 0.62 * (h.y() + 18)), 2);
  hair = SmoothUnion(hair, Ellipsoid(h, {0, 6, 29}, {11, 11, 9}), 4);
  const V3 c = h - V3(0, 5, 8);
  const double up = std::atan2(c.z(), std::hypot(c.x(), c.y())), around = std::atan2(c.y(), c.x());
  const double row = up * 9;
  const double columns = std::max(4.0, std::round(20 * std::cos(std::round(row) / 9)));
  // Each stud fades out where its row ends.
  const double in_row = std::cos(std::numbers::pi * (row - std::round(row)));
  hair -= 1.1 * in_row * (0.5 + 0.5 * std::cos(columns * around));
  d = SmoothUnion(d, hair, 0.8);
  const double neck = Limb(p, {0, 6, 76}, {0, 3.5, 94}, 8.2, 7.2);
  const double rings = 0.35 * std::cos(1.6 * p.z());
  return SmoothUnion(kHeadScale * d, neck - rings, 2);
}

double Distance(const V3& p) {
  const double lotus = p.z() - 32 > kReach ? p.z() - 32 : Lotus(p);
  const double legs = Bounded(p, {0, -4, 32}, 46, kReach, [&] { return Legs(p); });
  double d = SmoothUnion(lotus, legs, 1.2);
  const double torso = Bounded(p, {0, 6, 60}, 37, kReach, [&] { return Torso(p); });
  const double arms = Bounded(p, {0, -4, 56}, 44, kReach, [&] { return Arms(p); });
  const double bare = SmoothUnion(torso, arms, 3);
  const double robe = Bounded(p, {0, 2, 58}, 46, kReach, [&] { return Robe(p, torso, arms); });
  d = SmoothUnion(d, SmoothUnion(bare, robe, 0.8), 1.2);
  d = SmoothUnion(d, Bounded(p, {0, 4, 98}, 27, kReach, [&] { return Head(p); }), 2);
  return SmoothIntersection(d, -p.z(), 1.0);
}

}  // namespace

Shape MakeStatue(double edge_mm) {
  return PolygoniseShape(Distance, {-49, -42, 0}, {49, 42, 126}, edge_mm, 2.6);
}

}  // namespace lfm
