// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/helmet_shape.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sample_data/shapes/implicit.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kWall = 2.4;

// The full body whose outermost layer is the steel.
double Skull(const V3& p) {
  double d = Ellipsoid(p, {0, 3, 58}, {30, 36, 37});
  d = SmoothUnion(d, Limb(p, {0, 8, 80}, {0, 11, 97}, 14, 3), 16);   // the point
  d = SmoothUnion(d, Ellipsoid(p, {0, 4, 60}, {2.2, 38.5, 41}), 4);  // ridge
  // Neck: flares downwards.
  const double down = std::max(0.0, 34 - p.z());
  const double neck = std::hypot(p.x(), (p.y() - 4) * 0.86) - (25.5 + 0.012 * down * down);
  const double side = std::max(0.85 * neck, p.z() - 50);
  return SmoothUnion(d, side, 10);
}

double Snout(const V3& p) {
  const V3 m = Mirrored(p);
  // A blunt cone whose keel runs from the brow to the chin.
  double d = Limb(p, {0, -14, 54}, {0, -49, 50}, 25, 3.5);
  d = SmoothUnion(d, Ellipsoid(p, {0, -16, 46}, {25.5, 20, 19}), 8);
  d = SmoothUnion(d, Limb(p, {0, -35, 66}, {0, -51, 50}, 1.2, 1.6), 5);
  return SmoothUnion(d, Limb(m, {8, -34, 63.5}, {26, -18, 64}, 2.2, 2.2), 3);  // brow of the slit
}

double BreathHoles(const V3& p) {
  double d = 1e3;
  const double x = std::abs(p.x());
  if (p.y() > -18 || x < 3) return 8;
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < 4; ++i) {
      const double y = -26 - 5.2 * i - (row & 1 ? 2.6 : 0.0), z = 52 - 5.0 * row;
      d = std::min(d, std::hypot(p.y() - y, p.z() - z) - 1.35);
    }
  }
  return d;
}

double Steel(const V3& p) {
  const double skull = Skull(p), snout = Snout(p);
  // The visor lies over the skull; its rim shows as a step.
  const double in_front = p.y() + 4 - 0.10 * (p.z() - 50);
  const double visor_span = std::max(in_front, std::abs(p.z() - 52) - 22);
  const double visor_body = SmoothUnion(skull - 1.5, snout, 4);
  const double visor = SmoothIntersection(visor_body, 0.9 * visor_span, 0.8);
  const double outer = SmoothUnion(skull, visor, 0.8);
  const double inner = std::min(skull, std::max(visor_body, visor_span + 3)) + kWall;
  double d = SmoothIntersection(outer, -inner, 0.5);
  d = SmoothIntersection(d, 0.8 - p.z(), 0.8);
  const double slit =
      RoundBox(Mirrored(p), {13.5, -30, 60.2 + 0.04 * std::abs(p.x())}, {11, 30, 1.5}, 1.0);
  d = SmoothCut(d, slit, 0.8);
  return SmoothCut(d, BreathHoles(p), 0.5);
}

double Brass(const V3& p) {
  const V3 m = Mirrored(p);
  const double neck = Skull(p);
  // A band on the neck's rim, rivets above it, hinges beside the visor, a finial.
  double d = SmoothIntersection(neck - 1.2, std::abs(p.z() - 4.2) - 2.4, 0.8);
  d = SmoothIntersection(d, -(neck + 0.8), 0.4);
  const double around = std::atan2(p.x(), -(p.y() - 4));
  const double step = 2 * std::numbers::pi / 22;
  const double turn = std::round(around / step) * step - around;
  const double radius = std::hypot(p.x(), p.y() - 4);
  const V3 turned(radius * std::sin(turn), radius * std::cos(turn), p.z() - 10.5);
  const double rivet =
      std::hypot(std::hypot(turned.x(), turned.z()), 1.5 * std::max(neck, -0.9)) - 1.7;
  d = std::min(d, std::max(0.8 * rivet, -neck - 1.2));
  const double hinge = std::hypot(m.y() + 3, m.z() - 62);
  d = std::min(
      d, SmoothIntersection(SmoothIntersection(neck - 3.2, hinge - 5, 1.0), -(neck + 0.8), 0.4));
  return std::min(d, SmoothUnion(Ball(p, {0, 11.2, 101}, 3.2),
                                 Limb(p, {0, 11, 94}, {0, 11.2, 99}, 3.0, 1.6), 1));
}

}  // namespace

Shape MakeHelmet(HelmetPart part, double edge_mm) {
  switch (part) {
    case HelmetPart::kSteel:
      return PolygoniseShape(Steel, {-46, -58, 0}, {46, 54, 106}, edge_mm, 2.5);
    case HelmetPart::kBrass:
      return PolygoniseShape(Brass, {-46, -50, 0}, {46, 54, 106}, edge_mm, 2.5);
  }
  throw Error("unknown part of a helmet", ErrorKind::kSystem);
}

}  // namespace lfm
