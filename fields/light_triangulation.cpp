// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_triangulation.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kFlat = 1e-7;  // lights this near to one plane lie in it
constexpr double kGapRadius = std::numbers::pi / 6;
constexpr double kGapRatio = 3;

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The first of each set of equal directions.
std::vector<int> DistinctLights(const std::vector<Vector3d>& directions) {
  std::map<std::tuple<double, double, double>, int> first;
  std::vector<int> distinct;
  for (size_t i = 0; i < directions.size(); ++i) {
    const Vector3d& d = directions[i];
    if (first.try_emplace({d.x(), d.y(), d.z()}, static_cast<int>(i)).second) {
      distinct.push_back(static_cast<int>(i));
    }
  }
  return distinct;
}

// The normal of a plane that holds all these lights; none when there is no such plane.
std::optional<Vector3d> CommonPlane(const std::vector<Vector3d>& directions,
                                    const std::vector<int>& lights) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3d mean = Vector3d::Zero();
  for (const int i : lights) mean += directions[i] / static_cast<double>(lights.size());
  for (const int i : lights) {
    spread += (directions[i] - mean) * (directions[i] - mean).transpose();
  }
  const Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  for (const int i : lights) {
    if (std::abs((directions[i] - mean).dot(normal)) > kFlat) return std::nullopt;
  }
  return normal;
}

// Lights on one circle: a ring, and a fan of triangles unless it is a great circle.
void AddRing(const Vector3d& normal, std::vector<int> lights, LightTriangulation& result) {
  const std::vector<Vector3d>& d = result.directions;
  const bool up = d[lights[0]].dot(normal) >= 0;
  const Vector3d axis = up ? normal : Vector3d(-normal), x = axis.unitOrthogonal();
  const Vector3d y = axis.cross(x);
  std::sort(lights.begin(), lights.end(), [&](int a, int b) {
    return std::atan2(d[a].dot(y), d[a].dot(x)) < std::atan2(d[b].dot(y), d[b].dot(x));
  });
  const size_t count = lights.size();
  for (size_t i = 0; i < (count == 2 ? 1 : count); ++i) {
    result.rim.emplace_back(lights[i], lights[(i + 1) % count]);
  }
  if (count < 3 || d[lights[0]].dot(axis) < kFlat) return;
  for (size_t i = 1; i + 1 < count; ++i) {
    result.triangles.emplace_back(lights[0], lights[i], lights[i + 1]);
  }
}

void AddHull(const std::vector<int>& lights, LightTriangulation& result) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  std::map<Kernel::Point_3, int> light_of;
  for (const int i : lights) {
    const Vector3d& d = result.directions[i];
    points.emplace_back(d.x(), d.y(), d.z());
    light_of[points.back()] = i;
  }
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  for (const auto face : hull.faces()) {
    std::vector<int> corners;
    for (const auto vertex : hull.vertices_around_face(hull.halfedge(face))) {
      corners.push_back(light_of.at(hull.point(vertex)));
    }
    for (size_t i = 1; i + 1 < corners.size(); ++i) {
      result.triangles.emplace_back(corners[0], corners[i], corners[i + 1]);
    }
  }
}

// The radius of the cap that a triangle's corners, counter-clockwise from outside, lie on; more
// than a right angle where the triangle faces the middle.
double CapRadius(const std::vector<Vector3d>& d, const Vector3i& t) {
  const Vector3d normal = (d[t[1]] - d[t[0]]).cross(d[t[2]] - d[t[0]]).normalized();
  return std::acos(std::clamp(normal.dot(d[t[0]]), -1.0, 1.0));
}

// Leaves the triangles out that close a gap, and lists the edges that are bare without them.
void OpenGaps(LightTriangulation& result) {
  std::vector<double> radii;
  for (const Vector3i& t : result.triangles) radii.push_back(CapRadius(result.directions, t));
  const double largest = std::max(kGapRadius, kGapRatio * Median(radii));
  std::vector<Vector3i> kept;
  std::map<std::pair<int, int>, int> sides;
  for (size_t i = 0; i < radii.size(); ++i) {
    const Vector3i& t = result.triangles[i];
    const bool keep = radii[i] <= largest && radii[i] < std::numbers::pi / 2 - kFlat;
    for (int k = 0; k < 3; ++k) {
      sides[std::minmax(t[k], t[(k + 1) % 3])] += keep ? 1 : 0;
    }
    if (!keep) continue;
    kept.push_back(t);
    result.cap_radius.push_back(radii[i]);
  }
  result.triangles = std::move(kept);
  if (!result.rim.empty()) return;
  for (const auto& [edge, triangles] : sides) {
    if (triangles == 1) result.rim.emplace_back(edge.first, edge.second);
  }
}

struct RimPoint {
  double angle = 10;
  LightShares shares;
};

// The nearest point of the great arc from a to b.
RimPoint NearestOnEdge(const std::vector<Vector3d>& d, const Eigen::Vector2i& edge,
                       const Vector3d& direction) {
  const Vector3d &a = d[edge[0]], &b = d[edge[1]];
  const Vector3d normal = a.cross(b);
  const double length = normal.squaredNorm();
  RimPoint result;
  if (length > kFlat * kFlat) {
    const Vector3d foot = direction - direction.dot(normal) / length * normal;
    // foot = share_a a + share_b b
    const double share_a = foot.cross(b).dot(normal) / length;
    const double share_b = a.cross(foot).dot(normal) / length;
    if (share_a > 0 && share_b > 0) {
      const double sum = share_a + share_b;
      result.angle = AngleBetween(foot, direction);
      result.shares = {{edge[0], edge[1], 0}, {share_a / sum, share_b / sum, 0}};
      return result;
    }
  }
  const double to_a = AngleBetween(a, direction), to_b = AngleBetween(b, direction);
  result.angle = std::min(to_a, to_b);
  result.shares = {{to_a <= to_b ? edge[0] : edge[1], 0, 0}, {1, 0, 0}};
  return result;
}

}  // namespace

LightTriangulation TriangulateLights(const std::vector<Vector3d>& directions) {
  if (directions.empty()) throw Error("there are no light directions");
  for (size_t i = 0; i < directions.size(); ++i) {
    if (!(std::abs(directions[i].norm() - 1) <= 1e-6)) {
      throw Error("light direction " + std::to_string(i) + " is not of unit length");
    }
  }
  LightTriangulation result;
  result.directions = directions;
  const std::vector<int> lights = DistinctLights(directions);
  if (lights.size() == 1) {
    result.rim.emplace_back(lights[0], lights[0]);
    result.median_radius = std::numbers::pi / 2;
    return result;
  }
  if (const std::optional<Vector3d> normal = CommonPlane(directions, lights)) {
    AddRing(*normal, lights, result);
  } else {
    AddHull(lights, result);
  }
  if (!result.triangles.empty()) OpenGaps(result);
  std::vector<double> lengths = result.cap_radius;
  if (lengths.empty()) {
    for (const Eigen::Vector2i& edge : result.rim) {
      lengths.push_back(AngleBetween(directions[edge[0]], directions[edge[1]]));
    }
  }
  result.median_radius = Median(lengths);
  return result;
}

LightShares InterpolateLights(const LightTriangulation& lights, const Vector3d& direction) {
  const std::vector<Vector3d>& d = lights.directions;
  const Vector3d unit = direction.normalized();
  for (const Vector3i& t : lights.triangles) {
    const Vector3d &a = d[t[0]], &b = d[t[1]], &c = d[t[2]];
    // unit = sum of share * corner, by Cramer's rule; the determinant is positive.
    const Vector3d share(unit.dot(b.cross(c)), unit.dot(c.cross(a)), unit.dot(a.cross(b)));
    const double sum = share.sum();
    if (!(sum > 0) || share.minCoeff() < -1e-12 * sum) continue;
    const Vector3d shown = share.cwiseMax(0) / share.cwiseMax(0).sum();
    return {{t[0], t[1], t[2]}, {shown[0], shown[1], shown[2]}};
  }
  RimPoint nearest;
  for (const Eigen::Vector2i& edge : lights.rim) {
    const RimPoint point = NearestOnEdge(d, edge, unit);
    if (point.angle < nearest.angle) nearest = point;
  }
  return nearest.shares;
}

}  // namespace lfm
