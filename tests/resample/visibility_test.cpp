// SPDX-License-Identifier: BSD-3-Clause
#include "resample/visibility.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/pixel_directions.h"
#include "resample/light_field.h"
#include "test_scenes.h"

namespace lfm {
namespace {

/// Distance to the first triangle that a ray meets, in double precision over all triangles.
double FirstHit(const TriangleMesh& mesh, const Eigen::Vector3d& origin,
                const Eigen::Vector3d& direction) {
  double nearest = HUGE_VAL;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[t[0]];
    const Eigen::Vector3d e1 = mesh.vertices[t[1]] - a, e2 = mesh.vertices[t[2]] - a;
    const Eigen::Vector3d p = direction.cross(e2);
    const double det = e1.dot(p);
    if (std::abs(det) < 1e-12) continue;
    const Eigen::Vector3d s = origin - a;
    const double u = s.dot(p) / det, v = direction.dot(s.cross(e1)) / det;
    const double distance = e2.dot(s.cross(e1)) / det;
    if (u >= -1e-9 && v >= -1e-9 && u + v <= 1 + 1e-9 && distance > 0) {
      nearest = std::min(nearest, distance);
    }
  }
  return nearest;
}

PhotoSight SightOf(const TriangleMesh& surface, const Camera& camera, const Pose& pose,
                   double margin_px) {
  PhotoSight sight{camera, pose, {}, {}};
  sight.depth = RenderDepth(surface, RayScene(surface), camera, PixelDirections(camera), pose);
  sight.usable = FindUsablePixels(sight.depth, camera, margin_px);
  return sight;
}

std::set<int> Visible(const TriangleMesh& mesh, const TriangleMesh& surface, const Camera& camera,
                      const Pose& pose, double margin_px, const VisibilityRule& rule = {}) {
  std::set<int> result;
  const auto deviations = TriangleDeviations(mesh, RayScene(surface));
  for (const auto& visible :
       FindVisibleTriangles(mesh, deviations, SightOf(surface, camera, pose, margin_px), rule)) {
    result.insert(visible.triangle);
  }
  return result;
}

/// Points of a triangle moved `shift_px` in the picture in 8 directions, as rays: does each meet
/// the triangle's own surroundings first (depth within `tolerance_mm`), or something else?
bool BruteForceClear(const TriangleMesh& mesh, const Camera& camera, const Pose& pose, int triangle,
                     double shift_px, double tolerance_mm) {
  const Pose world_from_camera = pose.Inverse();
  const Eigen::Vector3i& t = mesh.triangles[triangle];
  constexpr int kSteps = 4;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i + j <= kSteps; ++i) {
      const double u = double(i) / kSteps, v = double(j) / kSteps;
      const Eigen::Vector3d point =
          pose * Eigen::Vector3d((1 - u - v) * mesh.vertices[t[0]] + u * mesh.vertices[t[1]] +
                                 v * mesh.vertices[t[2]]);
      const auto pixel = Project(camera, point);
      if (!pixel) return false;
      for (int k = 0; k < 9; ++k) {
        const double a = k * M_PI / 4, r = k == 8 ? 0 : shift_px;
        const Eigen::Vector2d shifted = *pixel + r * Eigen::Vector2d(std::cos(a), std::sin(a));
        if (shifted.minCoeff() < 0 || shifted.x() > camera.width - 1 ||
            shifted.y() > camera.height - 1) {
          return false;
        }
        const Eigen::Vector3d ray = Unproject(camera, shifted);
        const double depth = ray.z() * FirstHit(mesh, world_from_camera.translation,
                                                world_from_camera.rotation * ray);
        if (std::abs(depth - point.z()) > tolerance_mm) return false;
      }
    }
  }
  return true;
}

double FacingDegrees(const TriangleMesh& mesh, const Pose& pose, int triangle) {
  const Eigen::Vector3i& t = mesh.triangles[triangle];
  const Eigen::Vector3d centroid =
      (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
  const Eigen::Vector3d to_eye = (pose.Center() - centroid).normalized();
  return std::acos(std::clamp(TriangleNormal(mesh, triangle).dot(to_eye), -1.0, 1.0)) * 180 / M_PI;
}

void CompareWithBruteForce(const TriangleMesh& mesh, const Camera& camera, const Pose& pose) {
  constexpr double kMargin_px = 1.5, kGrazing_deg = 75;
  const std::set<int> visible = Visible(mesh, mesh, camera, pose, kMargin_px, {kGrazing_deg, 1});
  int clear = 0, found = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const double facing = FacingDegrees(mesh, pose, t);
    if (visible.contains(t)) {
      // Whatever counts faces the camera, and within the margin only the surface itself is met
      // (8 mm: what slopes of 75 degrees and curvature reach within the margin, far less than the
      // depth steps of these scenes; between two pixels an edge is known to half a pixel).
      EXPECT_LE(facing, kGrazing_deg);
      EXPECT_TRUE(BruteForceClear(mesh, camera, pose, t, kMargin_px - 0.6, 8)) << t;
      ++found;
    }
    // Whatever is clear by a wide berth must count.
    if (facing < kGrazing_deg - 10 && BruteForceClear(mesh, camera, pose, t, 5, 8)) {
      EXPECT_TRUE(visible.contains(t)) << t << " facing " << facing;
      ++clear;
    }
  }
  EXPECT_GT(clear, 30);
  EXPECT_GE(found, clear);
}

TEST(Visibility, AgreesWithBruteForceOnTwoSpheres) {
  const TriangleMesh mesh =
      test::Join(test::Sphere({0, 0, 0}, 40, 3), test::Sphere({70, -60, 10}, 25, 2));
  const Camera camera = test::TestCamera(320, 240, 420);
  CompareWithBruteForce(mesh, camera, LookAt({180, -260, 60}, {10, -10, 0}, {0, 0, 1}));
}

TEST(Visibility, AgreesWithBruteForceOnATorusThatHidesItself) {
  const TriangleMesh mesh = test::Torus(50, 18, 48, 20);
  const Camera camera = test::TestCamera(320, 240, 420);
  CompareWithBruteForce(mesh, camera, LookAt({240, 30, 90}, {0, 0, 0}, {0, 0, 1}));
}

TEST(Visibility, CountsNothingBehindAnOccluder) {
  const TriangleMesh far_sphere = test::Sphere({0, 0, 0}, 30, 3);
  const TriangleMesh mesh = test::Join(far_sphere, test::Sphere({0, -100, 0}, 30, 3));
  const Camera camera = test::TestCamera(320, 240, 300);
  const Pose pose = LookAt({0, -300, 0}, {0, 0, 0}, {0, 0, 1});
  const std::set<int> visible = Visible(mesh, mesh, camera, pose, 1.5);
  EXPECT_FALSE(visible.empty());
  for (const int t : visible) EXPECT_GE(t, static_cast<int>(far_sphere.triangles.size()));
}

TEST(Visibility, UsesTheDenseSurfaceNotTheMesh) {
  // The mesh alone would be seen; the dense surface has something in front of it.
  const TriangleMesh mesh = test::Sphere({0, 0, 0}, 30, 2);
  const TriangleMesh surface =
      test::Join(test::Sphere({0, 0, 0}, 30, 4), test::Sphere({0, -100, 0}, 50, 4));
  const Camera camera = test::TestCamera(320, 240, 300);
  const Pose pose = LookAt({0, -300, 0}, {0, 0, 0}, {0, 0, 1});
  EXPECT_TRUE(Visible(mesh, surface, camera, pose, 1.5).empty());
  EXPECT_FALSE(Visible(mesh, test::Sphere({0, 0, 0}, 30, 4), camera, pose, 1.5).empty());
}

TEST(Visibility, ToleratesTheDeviationOfACoarseMesh) {
  // Facets of a coarse sphere lie up to 0.8 mm inside the true one.
  const TriangleMesh surface = test::Sphere({0, 0, 0}, 40, 5);
  const TriangleMesh mesh = test::Sphere({0, 0, 0}, 40, 2);
  const auto deviations = TriangleDeviations(mesh, RayScene(surface));
  for (const double d : deviations) {
    EXPECT_GT(d, 0.3);
    EXPECT_LT(d, 1.5);
  }
  const Camera camera = test::TestCamera(640, 480, 900);
  const Pose pose = LookAt({0, -300, 100}, {0, 0, 0}, {0, 0, 1});
  const std::set<int> visible = Visible(mesh, surface, camera, pose, 1.5);
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    if (FacingDegrees(mesh, pose, t) < 60) {
      EXPECT_TRUE(visible.contains(t)) << t;
    }
  }
}

TEST(Visibility, NeedsTheWholeTriangleInsideTheFrame) {
  const TriangleMesh mesh = test::Sphere({0, 0, 0}, 40, 2);
  Camera camera = test::TestCamera(320, 240, 600);
  const Pose pose = LookAt({0, -300, 0}, {60, 0, 10}, {0, 0, 1});
  const std::set<int> visible = Visible(mesh, mesh, camera, pose, 1.5);
  int cut = 0;
  for (const int t : visible) {
    for (int c = 0; c < 3; ++c) {
      const auto pixel = Project(camera, pose * mesh.vertices[mesh.triangles[t][c]]);
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(pixel->x() >= 0 && pixel->x() <= 319 && pixel->y() >= 0 && pixel->y() <= 239);
    }
  }
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    if (!visible.contains(t) && FacingDegrees(mesh, pose, t) < 45) ++cut;
  }
  EXPECT_GT(cut, 0);  // the scene does leave the frame
  EXPECT_GT(visible.size(), 10u);
}

TEST(Visibility, TakesUnoccludedTrianglesNearEdgesWhenEnoughOfThemIsData) {
  const TriangleMesh mesh = test::Torus(50, 18, 48, 20);
  const Camera camera = test::TestCamera(320, 240, 420);
  const Pose pose = LookAt({240, 30, 90}, {0, 0, 0}, {0, 0, 1});
  const std::set<int> complete = Visible(mesh, mesh, camera, pose, 1.5, {75, 1});
  const std::set<int> half = Visible(mesh, mesh, camera, pose, 1.5, {75, 0.5});
  EXPECT_TRUE(std::includes(half.begin(), half.end(), complete.begin(), complete.end()));
  EXPECT_GT(half.size(), complete.size() + 10);
  // What is added lies near an edge, but nothing lies in front of it: each of its points, as a ray
  // in double precision, meets it first (to the slope of a facet over half a pixel).
  for (const int t : half) EXPECT_TRUE(BruteForceClear(mesh, camera, pose, t, 0, 2.5)) << t;
}

/// Share of a triangle's points whose rays meet something else first, by `tolerance_mm` in depth.
double HiddenShare(const TriangleMesh& mesh, const Pose& pose, int triangle, double tolerance_mm) {
  constexpr int kSteps = 16;
  const Eigen::Vector3i& t = mesh.triangles[triangle];
  int hidden = 0, points = 0;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i + j <= kSteps; ++i, ++points) {
      const Eigen::Vector3d ray = PatchSampleWeights(kSteps + 1, i, j)[0] * mesh.vertices[t[0]] +
                                  PatchSampleWeights(kSteps + 1, i, j)[1] * mesh.vertices[t[1]] +
                                  PatchSampleWeights(kSteps + 1, i, j)[2] * mesh.vertices[t[2]] -
                                  pose.Center();
      const double first = FirstHit(mesh, pose.Center(), ray.normalized());
      hidden += ray.norm() - first > tolerance_mm ? 1 : 0;
    }
  }
  return static_cast<double>(hidden) / points;
}

TEST(Visibility, FindsPartlyHiddenTrianglesAsBruteForceDoes) {
  const TriangleMesh mesh = test::Torus(50, 18, 24, 10);
  const Camera camera = test::TestCamera(640, 480, 840);
  const Pose pose = LookAt({240, 30, 90}, {0, 0, 0}, {0, 0, 1});
  constexpr double kMaxHidden = 0.7, kGrazing_deg = 75, kTolerance_mm = 3;
  constexpr double kBand = 0.12;  // one pixel beside an edge, of triangles thirty pixels long
  const auto deviations = TriangleDeviations(mesh, RayScene(mesh));
  const PhotoSight sight = SightOf(mesh, camera, pose, 1.5);
  std::map<int, VisibleTriangle> found;
  for (const auto& visible :
       FindVisibleTriangles(mesh, deviations, sight, {kGrazing_deg, 0.1, kMaxHidden})) {
    found[visible.triangle] = visible;
  }
  std::set<int> whole;
  for (const auto& visible : FindVisibleTriangles(mesh, deviations, sight, {kGrazing_deg, 0.1})) {
    EXPECT_EQ(visible.hidden_beyond_mm, 0);
    whole.insert(visible.triangle);
  }
  int cut = 0, mostly_hidden = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    if (FacingDegrees(mesh, pose, t) > kGrazing_deg) {
      EXPECT_FALSE(found.contains(t));
      continue;
    }
    const double share = HiddenShare(mesh, pose, t, kTolerance_mm);
    if (share > kMaxHidden + kBand) {
      EXPECT_FALSE(found.contains(t)) << t << " hidden " << share;
      ++mostly_hidden;
    }
    if (share > 0.02 && share < kMaxHidden - kBand) {
      ASSERT_TRUE(found.contains(t)) << t << " hidden " << share;
      EXPECT_FALSE(whole.contains(t)) << t << " hidden " << share;
      EXPECT_GT(found[t].hidden_beyond_mm, 0) << share;
      ++cut;
    }
    if (!found.contains(t)) continue;
    EXPECT_EQ(found[t].hidden_beyond_mm == 0, whole.contains(t)) << t;
    std::array<Eigen::Vector2d, 3> at;
    for (size_t c = 0; c < 3; ++c) {
      at[c] = *Project(camera, pose * mesh.vertices[mesh.triangles[t][static_cast<int>(c)]]);
    }
    const Eigen::Vector2d e1 = at[1] - at[0], e2 = at[2] - at[0];
    const double area = std::abs(e1.x() * e2.y() - e1.y() * e2.x()) / 2;
    EXPECT_NEAR(found[t].area_px / area, 1 - share, kBand) << t;
  }
  EXPECT_GT(cut, 5);
  EXPECT_GE(mostly_hidden, 3);
}

TEST(Visibility, ReportsTheAreaInPixels) {
  const TriangleMesh mesh = test::Sphere({0, 0, 0}, 40, 3);
  const Camera camera = test::TestCamera(640, 480, 900);
  const Pose pose = LookAt({0, -300, 0}, {0, 0, 0}, {0, 0, 1});
  const auto deviations = TriangleDeviations(mesh, RayScene(mesh));
  for (const auto& visible :
       FindVisibleTriangles(mesh, deviations, SightOf(mesh, camera, pose, 1.5), {60, 1})) {
    const double cosine = std::cos(FacingDegrees(mesh, pose, visible.triangle) * M_PI / 180);
    const double px_per_mm = 900.0 / 262;
    const double expected = TriangleArea(mesh, visible.triangle) * cosine * px_per_mm * px_per_mm;
    EXPECT_NEAR(visible.area_px / expected, 1, 0.25);
  }
}

TEST(Visibility, SeesNothingFromBehindOrOfDegenerateTriangles) {
  TriangleMesh mesh = test::Sphere({0, 0, 0}, 40, 2);
  mesh.triangles = {{0, 1, 1}, {2, 2, 2}, mesh.triangles[5]};
  const TriangleMesh surface = test::Sphere({0, 0, 0}, 40, 2);
  const Camera camera = test::TestCamera(320, 240, 300);
  const Pose away = LookAt({0, -300, 0}, {0, -600, 0}, {0, 0, 1});
  EXPECT_TRUE(Visible(mesh, surface, camera, away, 1.5).empty());
  for (const Pose& pose : test::PosesAround(6, 300)) {
    EXPECT_FALSE(Visible(mesh, surface, camera, pose, 0).contains(0));
    EXPECT_FALSE(Visible(mesh, surface, camera, pose, 0).contains(1));
  }
}

}  // namespace
}  // namespace lfm
