// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/bust_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sample_data/shapes/implicit.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

// The socle is a body of revolution: radius over height as a smooth profile.
double Socle(const V3& p) {
  const auto disc = [&](double z, double radius, double half_height, double rounding) {
    return RoundDisc(p, {0, 0, z}, radius, half_height, rounding);
  };
  const double foot = disc(1.5, 25, 4.0, 1.2);
  const double step = disc(6.6, 21.5, 1.6, 1.2);
  const double stem = disc(12, 12.5, 9, 2);
  const double collar = disc(16.6, 16.5, 1.5, 1.4);
  return SmoothUnion(SmoothUnion(SmoothUnion(foot, step, 1.2), stem, 7), collar, 3);
}

double Torso(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Ellipsoid(p, {0, 1, 36}, {27, 16.5, 17});
  d = SmoothUnion(d, Ellipsoid(m, {26.5, 2.5, 41}, {14.5, 13, 12}), 9);
  d = SmoothUnion(d, Ellipsoid(p, {0, 2, 25}, {17, 12, 10}), 6);
  d = SmoothUnion(d, Limb(m, {5, 5, 60}, {25, 4, 49}, 7, 5), 7);                 // trapezius
  d = SmoothUnion(d, Ellipsoid(m, {11, -9, 36}, {11, 6.5, 9}), 5);               // breast muscle
  d = SmoothUnion(d, Limb(m, {3.5, -11.5, 49}, {24, -5, 51.5}, 1.6, 2.2), 3.5);  // collar bone
  return SmoothCut(d, (p - V3(0, -15.5, 50.5)).norm() - 3.4, 3);  // hollow of the throat
}

double Neck(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Limb(p, {0, 4, 44}, {0, 1, 72}, 11.5, 10.5);
  d = SmoothUnion(d, Limb(m, {9.5, 3, 71}, {3, -12, 49.5}, 2.2, 1.9), 3.5);
  return SmoothUnion(d, (p - V3(0, -9.2, 60)).norm() - 2.2, 3);
}

double Ear(const V3& m) {
  const Eigen::AngleAxisd lean(0.35, V3::UnitZ());
  const V3 q = lean.inverse() * (m - V3(19.6, 3.5, -1));
  double d = Ellipsoid(q, {0, 0, 0}, {2.6, 4.6, 7.2});
  d = SmoothCut(d, Ellipsoid(q, {2.2, -0.6, 1.2}, {1.9, 2.6, 4.4}), 1.0);
  return SmoothUnion(d, Ellipsoid(q, {0.4, -0.6, -6.2}, {1.7, 2.2, 2.2}), 1.2);
}

// The face, in the head frame.
double Face(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Ellipsoid(p, {0, 2, 8}, {18.6, 22.5, 20});                         // skull
  d = SmoothUnion(d, Ellipsoid(p, {0, -5, -4}, {15.4, 15.2, 19}), 8);           // front of the face
  d = SmoothUnion(d, Limb(m, {13, 0, -8}, {5, -13, -19.5}, 3.6, 3.4), 6);       // jaw
  d = SmoothUnion(d, (p - V3(0, -16.2, -20)).norm() - 4.2, 4.5);                // chin
  d = SmoothUnion(d, Ellipsoid(m, {10.5, -13.6, -3.5}, {4.8, 4.2, 4.0}), 4.5);  // cheek bone
  d = SmoothUnion(d, Limb(m, {3, -20.4, 8.4}, {12, -16.4, 8.6}, 1.8, 1.7), 3.2);  // brow
  d = SmoothCut(d, Ellipsoid(m, {7.4, -21.4, 2.9}, {4.9, 4.6, 3.3}), 3.0);        // eye socket
  const double eye = (m - V3(7.3, -14.0, 2.8)).norm();
  d = SmoothUnion(d, eye - 4.5, 0.9);
  const double lid = SmoothIntersection(eye - 5.2, 3.8 - (m.z() - 0.12 * (m.y() + 14.0)), 0.9);
  d = SmoothUnion(d, lid, 0.8);
  d = SmoothUnion(d, SmoothIntersection(eye - 5.0, m.z() - 1.1, 0.9), 0.8);
  d = SmoothUnion(d, Limb(p, {0, -19.3, 7}, {0, -24.6, -5.2}, 1.7, 2.5), 2.6);  // nose
  d = SmoothUnion(d, (m - V3(2.9, -21.4, -6.2)).norm() - 1.9, 1.6);
  d = SmoothCut(d, Ellipsoid(m, {1.5, -23.1, -8.3}, {0.9, 1.3, 1.5}), 0.8);
  d = SmoothUnion(d, Ellipsoid(p, {0, -17.2, -12.4}, {7.6, 3.8, 4.6}), 3);  // mouth
  d = SmoothUnion(d, Ellipsoid(m, {1.7, -19.9, -11.3}, {3.6, 1.9, 1.15}), 1.1);
  d = SmoothUnion(d, Ellipsoid(p, {0, -19.6, -14.1}, {4.1, 2.1, 1.45}), 1.1);
  const double bow = -12.65 + 0.018 * m.x() * m.x();
  d = SmoothCut(d, Ellipsoid(p, {0, -22.3, bow}, {6.2, 3.2, 0.42}), 0.7);
  d = SmoothCut(d, Limb(p, {0, -22.6, -9.2}, {0, -22.3, -10.6}, 0.6, 0.7), 1.2);  // philtrum
  d = SmoothCut(d, Ellipsoid(p, {0, -21.4, -16.9}, {4.5, 2.6, 1.1}), 2.0);
  return SmoothUnion(d, Ear(m), 1.2);
}

// Waved strands: furrows that run back from the parting, deeper where the hair is thick.
double HairRelief(const V3& p) {
  const double around = std::atan2(p.x(), -(p.y() - 3));
  const double up = std::atan2(p.z() - 8, std::hypot(p.x(), p.y() - 3));
  const double sway = 0.9 * std::sin(5.0 * up + 1.3 * std::sin(2 * around));
  const double strands = std::cos(15 * around + 3.2 * sway);
  const double fine = std::cos(33 * around + 5.0 * sway + 2);
  const double fade = std::clamp((1.35 - up) / 0.5, 0.0, 1.0);
  return fade * (0.75 * strands + 0.28 * fine);
}

double Hair(const V3& p) {
  const V3 m = Mirrored(p);
  double d = Ellipsoid(p, {0, 4.5, 9.5}, {21.2, 23.6, 20.6});
  d = SmoothUnion(d, Ellipsoid(p, {0, 16, -6}, {13.5, 9.5, 13}), 6);
  // It grows above a line that falls from the forehead to the nape.
  const double hairline = 0.87 * (14.5 - p.z() - 0.55 * (p.y() + 18) - 0.010 * p.x() * p.x());
  d = SmoothIntersection(d, hairline, 2.4);
  d -= HairRelief(p);
  // A wreath of curls over the forehead, a band, and a knot at the back.
  for (int i = 0; i < 5; ++i) {
    const double angle = 0.36 * i;
    const V3 q =
        m - V3(20.2 * std::sin(angle), -1 - 18.6 * std::cos(angle), 16.5 - 3.2 * angle * angle);
    if (q.squaredNorm() > 100) continue;
    const double whirl = std::cos(2.3 * q.norm() + 2 * std::atan2(q.z(), q.x() + 0.3));
    d = SmoothUnion(d, q.norm() - 4.0 - 0.35 * whirl, 1.7);
  }
  const V3 k = p - V3(0, 27.5, 2);
  const double spiral = std::cos(1.35 * std::hypot(k.x(), k.z()) - std::atan2(k.z(), k.x()));
  return SmoothUnion(d, Ellipsoid(k, V3::Zero(), {9, 7.5, 9}) - 0.7 * spiral, 1.5);
}

// A cloth over the left shoulder and across the breast, in folds.
double Cloth(const V3& p, double torso) {
  const double across = 0.62 * p.x() + p.z() - 0.10 * p.y();
  const double edge = across - 41.5 - 2.2 * std::sin(0.11 * p.x()) - 0.35 * p.x();
  const double back = 60 - p.z() + 3.2 * (p.x() + 12);
  double d = torso - 2.6;
  const double fold_axis = 0.80 * p.z() - 0.60 * p.x() + 1.4 * std::sin(0.13 * p.x() + 0.2 * p.y());
  const double depth = 0.55 + 0.45 * std::sin(0.09 * p.x() + 0.05 * p.z());
  d -= depth * (1.05 * std::cos(0.80 * fold_axis) + 0.3 * std::cos(1.7 * fold_axis + 1));
  const double front = SmoothIntersection(edge, -back * 0.2, 2);
  d = SmoothIntersection(d, 0.8 * std::min(front, p.z() - 38 + 0.9 * p.x() * 0.25), 1.8);
  const double rim = std::abs(0.8 * edge) - 1.1;
  const double hem = SmoothIntersection(SmoothIntersection(torso - 3.4, rim, 1.0), -back * 0.2, 1);
  return SmoothUnion(d, hem, 1.2);
}

}  // namespace

V3 BustHeadFrame(const V3& point_mm) {
  static const Eigen::Matrix3d head_from_bust =
      (Eigen::AngleAxisd(0.30, V3::UnitZ()) * Eigen::AngleAxisd(0.07, V3::UnitY()) *
       Eigen::AngleAxisd(0.05, V3::UnitX()))
          .inverse()
          .toRotationMatrix();
  return head_from_bust * (point_mm - V3(0, 0, 89.0));
}

double BustFaceDistance(const V3& point_in_head) { return Face(point_in_head); }

double BustHairDistance(const V3& point_in_head) { return Hair(point_in_head); }

BustParts BustPartDistances(const V3& point_mm) {
  // Parts farther away than any blend reaches are given by a bound: the value there only has to
  // be positive and no larger than the true one.
  constexpr double kBeyondBlends = 8;
  const V3 head = BustHeadFrame(point_mm);
  const double to_head = (head - V3(0, 4, 2)).norm() - 37;
  const double to_torso = point_mm.z() - 69, to_socle = point_mm.z() - 20;
  BustParts parts;
  parts.pedestal = to_socle > kBeyondBlends ? to_socle : Socle(point_mm);
  double torso = to_torso;
  parts.cloth = to_torso;
  if (to_torso < kBeyondBlends) {
    torso = Torso(point_mm);
    parts.cloth = Cloth(point_mm, torso);
  }
  double face = to_head;
  parts.hair = to_head;
  if (to_head < kBeyondBlends) {
    face = Face(head);
    parts.hair = Hair(head);
  }
  parts.skin = SmoothUnion(SmoothUnion(torso, Neck(point_mm), 5), face, 3.5);
  return parts;
}

double BustDistance(const V3& point_mm) {
  const BustParts parts = BustPartDistances(point_mm);
  double d = SmoothUnion(parts.skin, parts.hair, 1.4);
  d = SmoothUnion(d, parts.cloth, 1.3);
  d = SmoothUnion(d, parts.pedestal, 1.5);
  // The flat base; rounded where it meets the side.
  return SmoothIntersection(d, -point_mm.z(), 1.0);
}

}  // namespace lfm
