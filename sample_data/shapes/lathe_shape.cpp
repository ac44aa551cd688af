// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/lathe_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

using V2 = Eigen::Vector2d;

struct ProfilePoint {
  V2 at, normal;
};

V2 Outward(const V2& direction) { return {direction.y(), -direction.x()}; }

// The corner at b as points of an arc that touches both segments.
void AddCorner(const V2& a, const V2& b, const V2& c, double rounding, double edge,
               std::vector<ProfilePoint>& points) {
  const V2 in = (b - a).normalized(), out = (c - b).normalized();
  const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
  if (std::abs(turn) < 0.02) {
    points.push_back({b, Outward((in + out).normalized())});
    return;
  }
  const double tangent = std::tan(std::abs(turn) / 2);
  const double reach = std::min({rounding * tangent, 0.45 * (b - a).norm(), 0.45 * (c - b).norm()});
  const double radius = reach / tangent;
  const V2 center = b - reach * in + (turn > 0 ? -radius : radius) * Outward(in);
  const int steps = std::clamp(static_cast<int>(std::lround(radius * std::abs(turn) / edge)), 2, 8);
  for (int i = 0; i <= steps; ++i) {
    const double angle = turn * i / steps;
    const V2 direction(std::cos(angle) * in.x() - std::sin(angle) * in.y(),
                       std::sin(angle) * in.x() + std::cos(angle) * in.y());
    const V2 normal = Outward(direction);
    points.push_back({center + (turn > 0 ? radius : -radius) * normal, normal});
  }
}

// Points on the straight parts between, at most `edge` apart.
std::vector<ProfilePoint> Divide(const std::vector<ProfilePoint>& corners, double edge) {
  std::vector<ProfilePoint> points = {corners.front()};
  for (size_t i = 1; i < corners.size(); ++i) {
    const ProfilePoint &a = corners[i - 1], &b = corners[i];
    const double length = (b.at - a.at).norm();
    const int steps = static_cast<int>(std::clamp(std::round(length / edge), 1.0, 1e6));
    for (int k = 1; k <= steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      points.push_back(
          {a.at + t * (b.at - a.at), (a.normal + t * (b.normal - a.normal)).normalized()});
    }
  }
  return points;
}

std::vector<ProfilePoint> RoundProfile(const std::vector<V2>& profile, double rounding,
                                       double edge) {
  std::vector<ProfilePoint> corners;
  corners.push_back({profile.front(), V2(0, -1)});
  for (size_t i = 1; i + 1 < profile.size(); ++i) {
    AddCorner(profile[i - 1], profile[i], profile[i + 1], rounding, edge, corners);
  }
  const bool top = profile[profile.size() - 2].x() > 0;
  corners.push_back({profile.back(), V2(0, top ? 1 : -1)});
  return Divide(corners, edge);
}

double FluteDepth(const Flutes& flutes, double z, double angle) {
  if (flutes.count == 0 || z <= flutes.low_mm || z >= flutes.high_mm) return 0;
  const double end = std::min(z - flutes.low_mm, flutes.high_mm - z);
  const double fade = std::clamp(end / (2 * flutes.depth_mm), 0.0, 1.0);
  // Round grooves with sharp ridges between.
  return flutes.depth_mm * fade * std::abs(std::cos(0.5 * flutes.count * angle));
}

}  // namespace

Shape MakeLathe(const std::vector<V2>& profile, double rounding_mm, double edge_mm,
                const Flutes& flutes) {
  bool good = profile.size() >= 3 && profile.front().x() == 0 && profile.back().x() == 0;
  for (size_t i = 1; i + 1 < profile.size(); ++i) good = good && profile[i].x() > 0;
  for (size_t i = 1; i < profile.size(); ++i) good = good && profile[i] != profile[i - 1];
  if (!good) {
    throw Error(
        "a turned body's profile needs three points or more, no two alike in a row, the first and "
        "the last on the axis (radius 0), all others off it");
  }
  const std::vector<ProfilePoint> points = RoundProfile(profile, rounding_mm, edge_mm);
  double widest = 0;
  for (const ProfilePoint& p : points) widest = std::max(widest, p.at.x());
  const double full = 2 * std::numbers::pi;
  int around = static_cast<int>(std::clamp(std::round(full * widest / edge_mm), 12.0, 1e7));
  if (flutes.count > 0) {
    around =
        flutes.count * std::max(4, 2 * static_cast<int>(std::lround(0.5 * around / flutes.count)));
  }
  RequireTriangleCount(2.0 * around * static_cast<double>(points.size()));
  Shape shape;
  TriangleMesh& mesh = shape.mesh;
  mesh.vertices.emplace_back(0, 0, points.front().at.y());
  mesh.normals.emplace_back(0, 0, points.front().normal.y());
  const int rings = static_cast<int>(points.size()) - 2;
  for (int ring = 1; ring <= rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      const double angle = full * i / around, c = std::cos(angle), s = std::sin(angle);
      const ProfilePoint& p = points[ring];
      const double radius = p.at.x() - FluteDepth(flutes, p.at.y(), angle);
      mesh.vertices.emplace_back(radius * c, radius * s, p.at.y());
      mesh.normals.emplace_back(p.normal.x() * c, p.normal.x() * s, p.normal.y());
    }
  }
  const int last = static_cast<int>(mesh.vertices.size());
  mesh.vertices.emplace_back(0, 0, points.back().at.y());
  mesh.normals.emplace_back(0, 0, points.back().normal.y());
  const auto at = [&](int ring, int i) { return 1 + (ring - 1) * around + i % around; };
  for (int i = 0; i < around; ++i) mesh.triangles.emplace_back(0, at(1, i + 1), at(1, i));
  for (int ring = 1; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      mesh.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1));
      mesh.triangles.emplace_back(at(ring, i), at(ring + 1, i + 1), at(ring + 1, i));
    }
  }
  for (int i = 0; i < around; ++i)
    mesh.triangles.emplace_back(last, at(rings, i), at(rings, i + 1));
  if (flutes.count > 0) mesh.normals = ComputeVertexNormals(mesh);
  return shape;
}

}  // namespace lfm
