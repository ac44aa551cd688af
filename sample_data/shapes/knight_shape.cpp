// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/knight_shape.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "sample_data/bust_shape.h"
#include "sample_data/shapes/implicit.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kReach = 6;
constexpr double kHeadScale = 0.34;  // of the bust's head

const V3 kRightHand(-6.5, -18.5, 70.5), kLeftHand(15, -15, 72);
const V3 kRightElbow(-21, -5, 74), kLeftElbow(22, -3, 75);
const V3 kRightShoulder(-14.5, 1, 92), kLeftShoulder(14.5, 1, 92);

// Overlapping plates: a saw-tooth along `along`, softened.
double Lames(double along, double period) {
  const double t = along / period - std::floor(along / period);
  const double rise = t < 0.7 ? t / 0.7 : (1 - t) / 0.3;
  return 0.55 * rise * rise * (3 - 2 * rise);
}

double Leg(const V3& m) {
  const V3 hip(6.5, 1, 60), knee(8.3, -1.5, 35), ankle(9.2, 1.5, 12);
  double d = Limb(m, hip, knee, 6.6, 4.6);
  const double greave =
      SmoothUnion(Limb(m, knee, ankle, 4.1, 3.2), Ellipsoid(m, {8.7, 2, 26}, {4.2, 4.2, 8}), 2.5);
  d = SmoothUnion(d, greave, 1.0);
  // Knee cop with a wing, its lames above and below.
  double cop = Ball(m, {8.3, -2.2, 35.5}, 5.0);
  cop = SmoothUnion(cop, Ellipsoid(m, {13.2, -0.5, 35.5}, {1.3, 4.2, 4.6}), 1.5);
  cop = SmoothUnion(cop, Limb(m, {8.3, -1.4, 39}, {8.3, -1.6, 32}, 5.0, 4.6), 0.8);
  d = SmoothUnion(d, cop, 0.5);
  // Pointed shoe in lames.
  double shoe = Limb(m, {9.4, 3, 8.5}, {10.5, -10, 7.4}, 3.8, 2.3);
  shoe = SmoothUnion(shoe, Limb(m, {10.5, -10, 7.2}, {11.2, -16.5, 6.6}, 2.2, 0.9), 2);
  shoe -= Lames(m.y() + 0.4 * m.z(), 3.1) * 0.8;
  return SmoothUnion(d, shoe, 0.8);
}

double PlateArm(const V3& p, const V3& shoulder, const V3& elbow, const V3& hand) {
  double d = Limb(p, shoulder, elbow, 4.6, 3.7);
  d = SmoothUnion(d, Ball(p, elbow, 4.5), 0.6);
  const V3 out = (elbow - 0.5 * (shoulder + hand)).normalized();
  d = SmoothUnion(d, Limb(p, elbow, elbow + 3.4 * out, 3.2, 0.8), 1.2);  // the cop's point
  const V3 wrist = elbow + 0.72 * (hand - elbow);
  d = SmoothUnion(d, Limb(p, elbow, wrist, 3.4, 3.0), 0.8);
  const V3 along = (hand - wrist).normalized();
  d = SmoothUnion(d, Limb(p, wrist - 2.4 * along, wrist + 1.2 * along, 4.3, 3.0), 0.4);  // cuff
  const double fist = SmoothUnion(Ball(p, hand, 3.3), Limb(p, wrist, hand, 2.9, 3.2), 1);
  return SmoothUnion(d, fist - 0.25 * std::cos(4.2 * (p - hand).dot(V3(0.8, 0.2, 0.6))), 0.6);
}

double Pauldron(const V3& m) {
  const V3 q = m - V3(15, 1, 92);
  double d = Ellipsoid(q, {0.4, 0, -0.5}, {6.8, 7.6, 6.6}) - Lames(-q.z() + 0.3 * q.x(), 4.2);
  return SmoothIntersection(d, -4.5 - q.z() - 0.5 * q.x(), 0.8);
}

V3 HeadFrame(const V3& p) {
  static const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(-0.22, V3::UnitZ()) * Eigen::AngleAxisd(0.05, V3::UnitX()))
          .inverse()
          .toRotationMatrix();
  return turn * (p - V3(0, -0.5, 107)) / kHeadScale;
}

// An open-faced helmet with a crest, cut out round the face. It is filled: the head is inside.
double Helm(const V3& p) {
  const V3 h = HeadFrame(p);
  double outer = Ellipsoid(h, {0, 3, 8}, {24.5, 28, 27});
  outer = SmoothUnion(outer, Limb(h, {0, 8, 30}, {0, 11, 37}, 8, 3), 10);
  outer = SmoothUnion(outer, Ellipsoid(h, {0, 3.5, 9}, {1.6, 30.5, 30}), 3);
  const double cheeks = Ellipsoid(h, {0, 3, -10}, {24, 25, 22});
  outer = SmoothUnion(outer, cheeks, 6);
  double d = SmoothIntersection(outer, -24 - h.z() + 0.25 * h.y(), 0.8);
  const double face = RoundBox(h, {0, -24, -12}, {13.5, 20, 22.5}, 10);
  d = SmoothCut(d, face, 1.0);
  const double rim = SmoothIntersection(outer - 0.7, std::abs(face - 0.8) - 1.3, 0.8);
  return kHeadScale * SmoothUnion(d, rim, 0.6);
}

double Torso(const V3& p) {
  double d = Ellipsoid(p, {0, 0.5, 84}, {13.2, 9.6, 13});
  d = SmoothUnion(d, Ellipsoid(p, {0, 0.5, 67}, {10.2, 7.8, 9}), 6);
  return SmoothUnion(d, Ellipsoid(p, {0, 1, 59}, {11.5, 8.6, 8}), 5);
}

double Armour(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Bounded(p, {0, -3, 33}, 38, kReach, [&] { return Leg(m); });
  const double arms = Bounded(p, {0, -6, 82}, 34, kReach, [&] {
    return std::min(PlateArm(p, kRightShoulder, kRightElbow, kRightHand),
                    PlateArm(p, kLeftShoulder, kLeftElbow, kLeftHand));
  });
  d = std::min(d, SmoothUnion(arms, Pauldron(m), 0.5));
  const double gorget = Ellipsoid(p, {0, 0.5, 95.5}, {10.5, 9.2, 4.2});
  d = SmoothUnion(d, gorget, 0.5);
  return std::min(d, Bounded(p, {0, 0, 108}, 16, kReach, [&] { return Helm(p); }));
}

// Mail: neck, arm pits, hips; covered with small rings.
double Mail(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Torso(p) - 0.3;
  d = SmoothUnion(d, Limb(p, {0, 0.5, 92}, {0, 0.5, 100}, 7.6, 6.0), 2);
  d = SmoothUnion(d, Limb(m, {8, 1, 90}, {14.5, 1, 91}, 6, 5), 3);
  d = SmoothUnion(d, Limb(m, {5, 1, 60}, {6.8, 1, 52}, 7, 6.8), 3);
  const double around = std::atan2(p.x(), -p.y()) * 10;
  return d - 0.14 * std::cos(3.2 * around) * std::cos(3.2 * p.z());
}

double Cloth(const V3& p) {
  // A tabard over breast and back, open at the sides below the belt.
  const double a = std::atan2(p.x(), -p.y());
  const double below = std::max(0.0, 66 - p.z());
  const double folds = std::cos(9 * a) * std::min(0.06 * below, 1.7);
  const double grow = 1.3 + 0.05 * below;
  const double side = std::hypot(p.x() / (11.2 + grow), p.y() / (9.2 + grow)) - 1;
  double d = Torso(p) - 1.1;
  const double skirt =
      SmoothIntersection(0.9 * (side * 10 - 0.55 * folds), std::abs(p.z() - 53) - 15, 1.0);
  d = SmoothUnion(SmoothIntersection(d, 60 - p.z(), 1), skirt, 2);
  d = SmoothIntersection(d, p.z() - 95 + 0.02 * p.x() * p.x(), 1.0);
  d = SmoothIntersection(d, std::abs(p.x()) - 12.2 + 0.06 * std::max(0.0, p.z() - 75), 1.0);
  const double gap = std::abs(std::hypot(p.x(), p.y()) * (std::abs(a) - 1.5708)) - 1.8;
  d = SmoothCut(d, std::max(gap, p.z() - 57), 1.0);
  const double belt = SmoothIntersection(Torso(p) - 2.3, std::abs(p.z() - 65) - 1.6, 0.7);
  return SmoothUnion(d, belt, 0.5);
}

double Cape(const V3& p) {
  // A sheet behind, hung from the shoulders, in folds that deepen downwards.
  const double below = std::max(0.0, 94 - p.z());
  const double wide = 13.5 + 0.10 * below;
  const double depth = 0.4 + 0.022 * below, phase = 0.72 * p.x() + 0.5 * std::sin(0.07 * p.z());
  const double back = 10.5 + 0.085 * below - 0.016 * p.x() * p.x() + depth * std::cos(phase);
  const double slope = 0.032 * p.x() + 0.72 * depth * std::sin(phase);
  const double sheet = std::abs(p.y() - back) / std::sqrt(1 + slope * slope) - 1.1;
  double d = SmoothIntersection(sheet, std::abs(p.x()) - wide, 0.8);
  d = SmoothIntersection(d, std::abs(p.z() - 53.5) - 42.5, 0.8);
  // Its collar lies round the neck.
  const V3 q(p.x(), (p.y() - 1.5) * 0.95, p.z() - 96.2 - 0.1 * p.y());
  return SmoothUnion(d, std::hypot(std::hypot(q.x(), q.y()) - 10.2, q.z()) - 1.5, 1.5);
}

double Skin(const V3& p) { return kHeadScale * BustFaceDistance(HeadFrame(p)); }

// In the shield's own frame: x across, z up, bent round a vertical axis.
double Shield(const V3& p) {
  const V3 q = Eigen::AngleAxisd(-0.45, V3::UnitZ()) * (p - V3(18.5, -17, 66));
  const double bent = q.y() - 0.013 * q.x() * q.x();
  // A heater: straight above, two arcs that meet in the point below.
  const double low = q.z() - 4;
  const double outline =
      low > 0 ? std::abs(q.x()) - 14 : std::hypot(std::abs(q.x()) + 17, low) - 31;
  const double edge = std::max(outline, q.z() - 19 + 0.012 * q.x() * q.x());
  const double plate = SmoothIntersection(std::abs(bent) - 1.1, edge, 0.7);
  const double rim = std::hypot(edge + 0.8, bent) - 1.5;
  const double boss = Ellipsoid(V3(q.x(), bent, q.z()), {0, -0.5, 3}, {4.2, 2.6, 4.2});
  return 0.85 * SmoothUnion(SmoothUnion(plate, rim, 0.4), boss, 0.6);
}

double Sword(const V3& p) {
  const V3 q = p - V3(kRightHand.x(), kRightHand.y(), 0);
  const double taper = std::clamp((q.z() - 4) / 56, 0.0, 1.0);
  const double blade_width = 1.3 + 1.3 * taper;
  // A lozenge: edges left and right, ridges front and back.
  const double lozenge = 0.8 * (std::abs(q.x()) * 0.45 + std::abs(q.y()) - 0.45 * blade_width);
  double d = SmoothIntersection(lozenge, std::abs(q.z() - 32) - 28.5, 0.4);
  d = std::min(d, Limb(Mirrored(q), {0, 0, 61}, {9.5, 0, 60.2}, 1.4, 1.1));
  d = SmoothUnion(d, Ball(Mirrored(q), {9.8, 0, 60.2}, 1.6), 0.5);
  d = std::min(d, Limb(q, {0, 0, 61}, {0, 0, 74}, 1.3, 1.1) - 0.12 * std::cos(4 * q.z()));
  return std::min(d, RoundDisc(V3(q.x(), q.z() - 76, q.y()), V3::Zero(), 2.9, 1.5, 0.7));
}

double Base(const V3& p) {
  double d = RoundDisc(p, {0, -2, 1.5}, 31, 2.5, 0.8);
  return SmoothUnion(d, RoundDisc(p, {0, -2, 3.6}, 28, 1.8, 0.7), 0.8);
}

}  // namespace

Shape MakeKnight(KnightPart part, double edge_mm) {
  const V3 low(-32, -34, 0), high(36, 30, 124);
  switch (part) {
    case KnightPart::kArmour:
      return PolygoniseShape(Armour, low, high, edge_mm, 2.5);
    case KnightPart::kMail:
      return PolygoniseShape(Mail, low, high, edge_mm, 2.5);
    case KnightPart::kCloth:
      return PolygoniseShape(Cloth, low, high, edge_mm, 3);
    case KnightPart::kCape:
      return PolygoniseShape(Cape, {-26, -14, 4}, {26, 30, 102}, edge_mm, 2.5);
    case KnightPart::kSkin:
      return PolygoniseShape(Skin, {-10, -12, 96}, {10, 12, 120}, edge_mm, 2.5);
    case KnightPart::kShield:
      return PolygoniseShape(Shield, {0, -36, 36}, {38, 0, 92}, edge_mm, 2.5);
    case KnightPart::kSword:
      return PolygoniseShape(Sword, {-20, -24, 2}, {7, -13, 82}, edge_mm, 2);
    case KnightPart::kBase:
      return PolygoniseShape([](const V3& p) { return SmoothIntersection(Base(p), -p.z(), 0.8); },
                             {-32, -34, 0}, {32, 30, 7}, edge_mm, 1.5);
  }
  throw Error("unknown part of a knight", ErrorKind::kSystem);
}

}  // namespace lfm
