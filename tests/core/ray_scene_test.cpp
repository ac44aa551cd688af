// SPDX-License-Identifier: BSD-3-Clause
#include "core/ray_scene.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "core/parallel.h"
#include "mesh_zoo.h"
#include "test_files.h"

namespace lfm {
namespace {

/// A torus of 2400 triangles, 80 mm wide.
TriangleMesh BigTorus() {
  TriangleMesh mesh = Torus(60, 20);
  for (Eigen::Vector3d& v : mesh.vertices) v *= 10;
  return mesh;
}

class RandomPoints {
 public:
  explicit RandomPoints(int seed) : random_(seed) {}
  Eigen::Vector3d Point(double spread) {
    std::normal_distribution<double> normal;
    return spread * Eigen::Vector3d(normal(random_), normal(random_), normal(random_));
  }

 private:
  std::mt19937 random_;
};

struct BruteHit {
  double distance = std::numeric_limits<double>::infinity();
  double inside = 0;  // smallest barycentric weight: small at edges
};

/// The first hit in double precision, by Cramer's rule over all triangles.
BruteHit BruteForce(const TriangleMesh& mesh, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction) {
  BruteHit best;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]];
    Eigen::Matrix3d m;
    m << mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a, -direction;
    const Eigen::Vector3d s = m.inverse() * (origin - a);
    const double inside = std::min({s[0], s[1], 1 - s[0] - s[1]});
    if (inside >= 0 && s[2] > 0 && s[2] < best.distance) best = {s[2], inside};
  }
  return best;
}

TEST(RayScene, AgreesWithBruteForce) {
  constexpr double kDistance_abs = 1e-9, kAtEdge = 1e-4;
  const TriangleMesh mesh = BigTorus();
  const RayScene scene(mesh);
  RandomPoints random(1);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d origin = random.Point(60), direction = random.Point(20) - origin;
    const BruteHit expected = BruteForce(mesh, origin, direction);
    const auto hit = scene.Intersect(origin, direction);
    if (std::isfinite(expected.distance) && expected.inside < kAtEdge) continue;
    ASSERT_EQ(hit.has_value(), std::isfinite(expected.distance)) << i;
    EXPECT_EQ(scene.Occluded(origin, direction, 0, 1e30), hit.has_value());
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(hit->distance, expected.distance, kDistance_abs);
    const Eigen::Vector3i& t = mesh.triangles[hit->triangle];
    const Eigen::Vector3d point = (1 - hit->u - hit->v) * mesh.vertices[t[0]] +
                                  hit->u * mesh.vertices[t[1]] + hit->v * mesh.vertices[t[2]];
    EXPECT_LT((point - (origin + hit->distance * direction)).norm(), 1e-9);
    // Nothing before the hit, something just after it.
    EXPECT_FALSE(scene.Occluded(origin, direction, 0, hit->distance * (1 - 1e-4)));
    EXPECT_TRUE(scene.Occluded(origin, direction, 0, hit->distance * (1 + 1e-4)));
    const auto second = scene.Intersect(origin, direction, hit->distance * (1 + 1e-4));
    if (second) {
      EXPECT_GT(second->distance, hit->distance);
    }
  }
  EXPECT_GT(hits, 500);
}

// Rays aimed exactly at vertices and edges of a closed surface from inside must all hit.
TEST(RayScene, PacketsAgreeWithSingleRays) {
  constexpr double kDistance_rel = 1e-12;
  const RayScene scene(BigTorus());
  RandomPoints random(5);
  const Eigen::Vector3d origin(40, 70, 200);
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < 1003; ++i) directions.push_back(random.Point(30) - origin);
  directions[7].setZero();
  directions[8].x() = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> distances(directions.size(), -1);
  scene.FirstDistances(origin, directions, distances);
  int hits = 0;
  for (size_t i = 0; i < directions.size(); ++i) {
    const auto hit = scene.Intersect(origin, directions[i]);
    ASSERT_EQ(hit.has_value(), std::isfinite(distances[i])) << i;
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(distances[i], hit->distance, kDistance_rel * hit->distance) << i;
  }
  EXPECT_GT(hits, 100);
  EXPECT_LT(hits, 900);
}

TEST(RayScene, IsWatertight) {
  const TriangleMesh mesh = Moved(BigTorus(), {1234.5, -987, 0});
  const RayScene scene(mesh);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d a = mesh.vertices[t[c]], b = mesh.vertices[t[(c + 1) % 3]];
      const Eigen::Vector3d from_center = a - Eigen::Vector3d(1234.5, -987, 0);
      const Eigen::Vector3d ring(from_center.x(), from_center.y(), 0);
      const Eigen::Vector3d inside =
          Eigen::Vector3d(1234.5, -987, 0) + 30 * ring.normalized();  // the tube's middle
      for (const double s : {0.0, 0.25, 0.5, 1.0 / 3}) {
        EXPECT_TRUE(scene.Intersect(inside, a + s * (b - a) - inside).has_value());
      }
    }
  }
}

TEST(RayScene, WeightsAreInsideTheTriangleEvenAtCorners) {
  const TriangleMesh mesh = Octahedron();
  const RayScene scene(mesh);
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const auto hit = scene.Intersect(3 * vertex, -vertex);
    ASSERT_TRUE(hit);
    EXPECT_GE(hit->u, 0);
    EXPECT_GE(hit->v, 0);
    EXPECT_LE(hit->u + hit->v, 1);
    EXPECT_NEAR(hit->distance, 2, 1e-9);
  }
}

// Embree computes in float32: a scene far from the origin and an eye far from the scene must cost
// nothing.
TEST(RayScene, IsAccurateFarFromTheOriginAndFromFarAway) {
  const Eigen::Vector3d shift(1e6, -2e6, 3e6);
  const TriangleMesh mesh = Moved(Octahedron(), shift);
  const RayScene scene(mesh);
  const Eigen::Vector3d direction = Eigen::Vector3d(-1, -1.1, -0.9).normalized();
  const Eigen::Vector3d target = shift + Eigen::Vector3d(0.3, 0.3, 0.4);
  for (const double distance : {5.0, 1e3, 1e6}) {
    const auto hit = scene.Intersect(target - distance * direction, direction);
    ASSERT_TRUE(hit) << distance;
    EXPECT_NEAR(hit->distance, distance, 1e-8 * (1 + distance) / 10 + 1e-8);
  }
}

TEST(RayScene, LimitsAreInUnitsOfTheDirection) {
  const RayScene scene(SingleTriangle());
  const Eigen::Vector3d origin(0.2, 0.2, 10), down(0, 0, -2);
  EXPECT_NEAR(scene.Intersect(origin, down)->distance, 5, 1e-12);
  EXPECT_TRUE(scene.Intersect(origin, down, 4.99, 5.01));
  EXPECT_FALSE(scene.Intersect(origin, down, 0, 4.99));
  EXPECT_FALSE(scene.Intersect(origin, down, 5.01));
  EXPECT_TRUE(scene.Occluded(origin, down, 0, 6));
  EXPECT_FALSE(scene.Occluded(origin, down, 0, 4.99));
  EXPECT_TRUE(scene.Intersect({0.2, 0.2, -10}, {0, 0, 1})) << "both sides count";
  EXPECT_NEAR(scene.Intersect(origin, down)->u, 0.2, 1e-12);
  EXPECT_NEAR(scene.Intersect(origin, down)->v, 0.2, 1e-12);
}

TEST(RayScene, ImpossibleRaysMeetNothing) {
  const RayScene scene(SingleTriangle());
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(scene.Intersect({0.2, 0.2, 1}, {0, 0, 0}));
  EXPECT_FALSE(scene.Intersect({0.2, nan, 1}, {0, 0, -1}));
  EXPECT_FALSE(scene.Intersect({0.2, 0.2, 1}, {0, 0, -infinity}));
  EXPECT_FALSE(scene.Intersect({0.2, 0.2, 1}, {0, 0, -1}, 2, 1));
  EXPECT_FALSE(scene.Intersect({0.2, 0.2, 1}, {0, 0, -1}, nan, 1));
  EXPECT_FALSE(scene.Occluded({0.2, 0.2, 1}, {0, nan, -1}, 0, 10));
  EXPECT_FALSE(scene.Closest({nan, 0, 0}));
  EXPECT_FALSE(scene.Closest({0, 0, 0}, -1));
  EXPECT_FALSE(scene.Closest({0, 0, 0}, nan));
}

double DistanceToTriangle(const Eigen::Vector3d& p, const TriangleMesh& mesh, int triangle) {
  // Minimised by alternating over a fine start grid and shrinking steps: slow, but independent.
  const Eigen::Vector3i& t = mesh.triangles[triangle];
  const Eigen::Vector3d a = mesh.vertices[t[0]], ab = mesh.vertices[t[1]] - a,
                        ac = mesh.vertices[t[2]] - a;
  const auto distance = [&](double u, double v) { return (a + u * ab + v * ac - p).norm(); };
  double best_u = 0, best_v = 0;
  for (double step = 0.25; step > 1e-9; step /= 2) {
    for (bool moved = true; moved;) {
      moved = false;
      for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}}) {
        const double u = best_u + du * step, v = best_v + dv * step;
        if (u < 0 || v < 0 || u + v > 1 || distance(u, v) >= distance(best_u, best_v)) continue;
        best_u = u;
        best_v = v;
        moved = true;
      }
    }
  }
  return distance(best_u, best_v);
}

TEST(Closest, AgreesWithBruteForce) {
  constexpr double kDistance_abs = 1e-5;  // of the independent search
  const TriangleMesh mesh = Torus(9, 6);
  const RayScene scene(mesh);
  RandomPoints random(2);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d query = random.Point(i % 3 == 0 ? 50 : 3);
    double expected = std::numeric_limits<double>::infinity();
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      expected = std::min(expected, DistanceToTriangle(query, mesh, static_cast<int>(t)));
    }
    const auto closest = scene.Closest(query);
    ASSERT_TRUE(closest);
    EXPECT_NEAR(closest->distance, expected, kDistance_abs);
    EXPECT_NEAR((closest->point - query).norm(), closest->distance, 1e-12);
    EXPECT_TRUE(scene.Closest(query, closest->distance * (1 + 1e-12)));
    EXPECT_FALSE(scene.Closest(query, closest->distance * (1 - 1e-9)));
  }
}

TEST(Closest, IsExactAtVerticesAndOnTheSurface) {
  const TriangleMesh mesh = Moved(BigTorus(), {5000, 0, 0});
  const RayScene scene(mesh);
  for (size_t t = 0; t < mesh.triangles.size(); t += 7) {
    const Eigen::Vector3i& c = mesh.triangles[t];
    const Eigen::Vector3d middle =
        (mesh.vertices[c[0]] + mesh.vertices[c[1]] + mesh.vertices[c[2]]) / 3;
    const Eigen::Vector3d off = middle + 0.01 * TriangleNormal(mesh, static_cast<int>(t));
    EXPECT_NEAR(scene.Closest(off)->distance, 0.01, 1e-11);
    EXPECT_EQ(scene.Closest(off)->triangle, static_cast<int>(t));
    EXPECT_EQ(scene.Closest(mesh.vertices[c[0]])->distance, 0);
  }
}

TEST(Closest, WorksFromVeryFarAndOnDegenerateTriangles) {
  const RayScene scene(Octahedron());
  EXPECT_NEAR(scene.Closest({1e9, 0, 0})->distance, 1e9 - 1, 1e-6);
  EXPECT_EQ(scene.Closest({0, 0, 7})->point, Eigen::Vector3d(0, 0, 1));
  const RayScene needle(Make({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}));
  EXPECT_NEAR(needle.Closest({1.5, 3, 0})->distance, 3, 1e-12);
  const RayScene point(Make({{4, 4, 4}}, {{0, 0, 0}}));
  EXPECT_NEAR(point.Closest({4, 4, 5})->distance, 1, 1e-12);
  EXPECT_FALSE(point.Intersect({4, 4, 5}, {0, 0, -1}));
}

// Rays through shared edges have two right answers: which one it is may not depend on how many
// threads built the scene.
TEST(RayScene, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh mesh = Torus(150, 60);
  const auto trace = [&] {
    const RayScene scene(mesh);
    std::vector<int> triangles(mesh.vertices.size());
    ParallelFor(0, static_cast<int64_t>(mesh.vertices.size()), [&](int64_t v) {
      const auto hit = scene.Intersect(2 * mesh.vertices[v], -mesh.vertices[v]);
      triangles[v] = hit ? hit->triangle : -1;
    });
    return triangles;
  };
  SetThreadCount(1);
  const std::vector<int> one = trace();
  for (const int threads : {2, 8}) {
    SetThreadCount(threads);
    EXPECT_EQ(trace(), one);
  }
  SetThreadCount(0);
}

TEST(RayScene, RefusesMeshesThatAreBroken) {
  ExpectError([] { RayScene{TriangleMesh{}}; }, "no triangle");
  TriangleMesh mesh = Tetrahedron();
  mesh.triangles[0][0] = 7;
  ExpectError([&] { RayScene{mesh}; }, "not there");
}

}  // namespace
}  // namespace lfm
