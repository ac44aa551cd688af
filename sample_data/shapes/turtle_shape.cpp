// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/turtle_shape.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "sample_data/shapes/implicit.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

const V3 kDomeCenter(0, 4, 22), kDomeRadii(38, 45, 31);

double Body(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Ellipsoid(p, {0, 4, 15}, {34, 41, 12});
  d = SmoothUnion(d, Limb(p, {0, -28, 20}, {0, -46, 28}, 12, 11.5), 8);  // neck
  d = SmoothUnion(d, Ellipsoid(p, {0, -50, 33}, {14.5, 13.5, 14.5}), 5);
  d = SmoothUnion(d, Ellipsoid(p, {0, -59.5, 29}, {9.5, 7, 7.5}), 6);  // snout
  d = SmoothUnion(d, Ball(m, {7.5, -56, 39.5}, 4.6), 3);               // round the eyes
  const double smile = 25.6 + 0.035 * p.x() * p.x();
  d = SmoothCut(d, Ellipsoid(p, {0, -65.5, smile}, {9, 5, 0.55}), 1.2);
  d = SmoothCut(d, Ball(m, {2.3, -67, 31.5}, 1.1), 0.8);  // nostrils
  // Flippers: flat, swept back.
  const V3 front = Eigen::AngleAxisd(0.55, V3::UnitZ()) * (m - V3(35, -32, 6));
  d = SmoothUnion(d, Ellipsoid(front, V3::Zero(), {18, 10, 7.5}), 8);
  const V3 back = Eigen::AngleAxisd(-0.75, V3::UnitZ()) * (m - V3(26, 40, 5.5));
  d = SmoothUnion(d, Ellipsoid(back, V3::Zero(), {15, 9.5, 7}), 7);
  d = SmoothUnion(d, Limb(p, {0, 42, 11}, {0, 56, 5}, 6, 2.2), 5);  // tail
  return SmoothIntersection(d, -p.z(), 2.5);
}

// The scutes, by their middles as angles from the dome's top (across, along): a row along the back
// and two down each side.
constexpr double kScutes[][2] = {{0, -1.08},   {0, -0.58},    {0, -0.06},    {0, 0.46},
                                 {0, 0.98},    {0.66, -0.84}, {0.70, -0.28}, {0.70, 0.28},
                                 {0.66, 0.82}, {1.22, -0.62}, {1.25, 0.0},   {1.22, 0.60}};

// How far the shell stands out or in: plates, each a little domed, with furrows between.
double ScuteRelief(const V3& p) {
  const V3 q = (p - kDomeCenter).cwiseQuotient(kDomeRadii);
  const double up = std::max(q.z(), 0.05);
  // Longitude and latitude about the x and y axes, mirrored over the back.
  const double across = std::abs(std::atan2(q.x(), up)), along = std::atan2(q.y(), up);
  double nearest = 1e9, second = 1e9;
  for (const auto& scute : kScutes) {
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && scute[0] == 0) continue;
      const double d = std::hypot(across - side * scute[0], along - scute[1]);
      second = std::min(second, std::max(nearest, d));
      nearest = std::min(nearest, d);
    }
  }
  const double gap = (second - nearest) / 0.10;
  const double rings = 0.25 * std::cos(30 * nearest) * std::clamp(2 - 4 * nearest, 0.0, 1.0);
  return 1.6 * (1 - std::min(1.0, 3.0 * nearest * nearest)) + rings - 1.5 * std::exp(-gap * gap);
}

double Shell(const V3& p) {
  double d = Ellipsoid(p, kDomeCenter, kDomeRadii);
  if (d < 8 && p.z() > 10) d -= ScuteRelief(p) * std::clamp((p.z() - 20) / 6, 0.0, 1.0);
  const double saddle = 19.5 + 2.5 * std::cos(p.y() / 16);
  d = SmoothIntersection(d, saddle - 3 - p.z(), 3);
  // The rolled rim follows the dome's oval.
  const V3 q(p.x() * 45 / 38, p.y() - 4, p.z() - saddle + 2.5);
  const double rim = std::hypot((std::hypot(q.x(), q.y()) - 46) * 0.9, q.z()) - 3.6;
  return SmoothUnion(d, rim, 2);
}

double Belly(const V3& p) {
  const double d = Ellipsoid(p, {0, 2, 8}, {26, 32, 9});
  return SmoothIntersection(d, -p.z(), 1.5);
}

double Eyes(const V3& p) { return Ball(Mirrored(p), {8.3, -58.8, 40.3}, 3.0); }

}  // namespace

Shape MakeTurtle(TurtlePart part, double edge_mm) {
  switch (part) {
    case TurtlePart::kBody:
      return PolygoniseShape(Body, {-54, -68, 0}, {54, 60, 50}, edge_mm, 2);
    case TurtlePart::kShell:
      return PolygoniseShape(Shell, {-46, -48, 8}, {46, 56, 58}, edge_mm, 3);
    case TurtlePart::kBelly:
      return PolygoniseShape(Belly, {-27, -31, 0}, {27, 35, 18}, edge_mm, 2);
    case TurtlePart::kEyes:
      return PolygoniseShape(Eyes, {-12, -62.5, 37}, {12, -55.5, 44}, edge_mm, 1.1);
  }
  throw Error("unknown part of a turtle", ErrorKind::kSystem);
}

}  // namespace lfm
