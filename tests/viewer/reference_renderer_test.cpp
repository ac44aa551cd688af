// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/reference_renderer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <random>

#include "core/error.h"
#include "core/parallel.h"
#include "synthetic_model.h"

namespace lfm {
namespace {

const Eigen::Vector3d kCenter(5, -10, 70);
constexpr double kRadius = 50;

/// A lens with distortion and an off-centre principal point: half a pixel cannot hide.
Camera TestCamera() {
  Camera camera;
  camera.width = 150;
  camera.height = 110;
  camera.fx = 310;
  camera.fy = 300;
  camera.cx = 71.3;
  camera.cy = 57.8;
  camera.k1 = -0.12;
  camera.k2 = 0.03;
  camera.p1 = 0.002;
  camera.p2 = -0.001;
  return camera;
}

Pose TestPose() { return LookAt({260, 190, 210}, kCenter, {0.1, 0, 1}); }

/// Linear in the point: bilinear interpolation in a patch is exact for it.
Eigen::Vector3d LinearMean(const Eigen::Vector3d& p) {
  const Eigen::Vector3d q = (p - kCenter) / kRadius;
  return Eigen::Vector3d(0.5, 0.45, 0.5) +
         Eigen::Vector3d(0.25 * q.x(), 0.2 * q.y() - 0.1 * q.z(), 0.3 * q.z());
}

/// Linear in the position on the square, for the orthographic map linear in the direction.
Eigen::Vector3d LinearView(const Eigen::Vector2d& square) {
  return {0.5 * square.x() - 0.3, 0.4 * square.y() - 0.1, 0.3 * square.x() - 0.4 * square.y()};
}

ModelRecipe LinearRecipe(int terms) {
  ModelRecipe recipe;
  recipe.terms = terms;
  recipe.direction_map = DirectionMap::kOrthographic;
  recipe.mean = LinearMean;
  recipe.surface = [](int, const Eigen::Vector3d&) { return 1.0; };
  recipe.view = [](int, int, const Eigen::Vector2d& square) { return LinearView(square); };
  return recipe;
}

struct SlowHit {
  int triangle;
  Eigen::Vector3d weights, point;
};

/// Every triangle by solving p = sum of weights times corners in float64: no Embree.
std::optional<SlowHit> SlowIntersect(const TriangleMesh& mesh, const Eigen::Vector3d& eye,
                                     const Eigen::Vector3d& direction) {
  std::optional<SlowHit> nearest;
  double nearest_distance = 1e30;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& corners = mesh.triangles[t];
    const Eigen::Vector3d a = mesh.vertices[corners[0]];
    Eigen::Matrix3d system;
    system << mesh.vertices[corners[1]] - a, mesh.vertices[corners[2]] - a, -direction;
    if (std::abs(system.determinant()) < 1e-9) continue;
    const Eigen::Vector3d solution = system.inverse() * (eye - a);
    const double u = solution[0], v = solution[1], distance = solution[2];
    if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= nearest_distance) continue;
    nearest_distance = distance;
    nearest = SlowHit{static_cast<int>(t), {1 - u - v, u, v}, eye + distance * direction};
  }
  return nearest;
}

/// The closed form of a LinearRecipe model's colour.
Eigen::Vector3d ExpectedColor(const LightFieldModel& model, const SlowHit& hit,
                              const Eigen::Vector3d& to_eye, int terms) {
  Eigen::Vector3d color = LinearMean(hit.point);
  for (int corner = 0; corner < 3; ++corner) {
    const int vertex = model.mesh.triangles[hit.triangle][corner];
    Eigen::Vector3d d = model.vertex_frames[vertex].transpose() * to_eye;
    if (d.z() < 0) d = Eigen::Vector3d(d.x(), d.y(), 0).normalized();
    color += terms * hit.weights[corner] * LinearView({(d.x() + 1) / 2, (d.y() + 1) / 2});
  }
  return color.cwiseMax(0).cwiseMin(1);
}

TEST(ReferenceRenderer, ShowsTheClosedFormOfAModel) {
  const LightFieldModel model = MakeModel(MakeSphere(kRadius, kCenter, 2), LinearRecipe(2));
  const ReferenceRenderer renderer(model);
  Camera camera = TestCamera();
  camera = ScaleCamera(camera, 0.5);
  const Pose pose = TestPose();
  for (const int terms : {0, 1, 2}) {
    RenderOptions options;
    options.evaluation.terms = terms;
    const Rendering rendering = renderer.Render(camera, pose, options, SilentProgress());
    // Codes of maps are off by half a level each: of the mean, and a term's three pairs of maps.
    const double tolerance_abs = 1.05 + 1.6 * terms;
    double worst = 0;
    int hits = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d direction =
            pose.rotation.transpose() * Unproject(camera, Eigen::Vector2d(x, y));
        const std::optional<SlowHit> hit = SlowIntersect(model.mesh, pose.Center(), direction);
        ASSERT_EQ(rendering.coverage.At<uint8_t>(x, y), hit ? 255 : 0) << x << ", " << y;
        if (!hit) continue;
        ++hits;
        const Eigen::Vector3d expected = 255 * ExpectedColor(model, *hit, -direction, terms);
        for (int c = 0; c < 3; ++c) {
          worst = std::max(worst, std::abs(expected[c] - rendering.color.At<uint8_t>(x, y, c)));
        }
      }
    }
    EXPECT_GT(hits, 500);
    EXPECT_LE(worst, tolerance_abs) << terms << " terms";
  }
}

TEST(ReferenceRenderer, PutsPointsWhereTheLensProjectsThem) {
  const LightFieldModel model = MakeModel(MakeSphere(kRadius, kCenter, 3), LinearRecipe(0));
  const ReferenceRenderer renderer(model);
  const Camera camera = TestCamera();
  const Pose pose = TestPose();
  const Rendering rendering = renderer.Render(camera, pose, {}, SilentProgress());
  const Eigen::Vector3d to_eye = (pose.Center() - kCenter).normalized();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  int count = 0;
  for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& corners = model.mesh.triangles[t];
    const Eigen::Vector3d point =
        (model.mesh.vertices[corners[0]] + model.mesh.vertices[corners[1]] +
         model.mesh.vertices[corners[2]]) /
        3;
    if ((point - kCenter).normalized().dot(to_eye) < 0.6) continue;
    const std::optional<Eigen::Vector2d> pixel = Project(camera, pose * point);
    ASSERT_TRUE(pixel);
    const int x = static_cast<int>(std::floor(pixel->x())),
              y = static_cast<int>(std::floor(pixel->y()));
    const double fx = pixel->x() - x, fy = pixel->y() - y;
    for (int c = 0; c < 3; ++c) {
      const auto at = [&](int dx, int dy) {
        return static_cast<double>(rendering.color.At<uint8_t>(x + dx, y + dy, c));
      };
      const double shown = (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) +
                           fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
      EXPECT_NEAR(shown, 255 * LinearMean(point)[c], 1.6);
      bias[c] += shown - 255 * LinearMean(point)[c];
    }
    ++count;
  }
  ASSERT_GT(count, 150);
  // Colours change by one to two levels a pixel here: a picture half a pixel off would show.
  EXPECT_LT((bias / count).cwiseAbs().maxCoeff(), 0.25);
}

TEST(ReferenceRenderer, SilhouetteIsTheProjectedSphere) {
  const TriangleMesh mesh = MakeSphere(kRadius, kCenter, 5);
  Camera camera = TestCamera();
  const Pose pose = TestPose();
  const Image mask = RenderSilhouette(mesh, camera, pose);
  const Eigen::Vector3d center = pose * kCenter;
  // A ray meets the sphere when it passes the centre within the radius; 0.15 px either way of that
  // is left to the facets.
  const double band_mm = 0.15 * center.norm() / camera.fx;
  int inside = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double passes_at = center.cross(Unproject(camera, Eigen::Vector2d(x, y))).norm();
      if (passes_at < kRadius - band_mm) {
        ++inside;
        EXPECT_EQ(mask.At<uint8_t>(x, y), 255) << x << ", " << y;
      } else if (passes_at > kRadius + band_mm) {
        EXPECT_EQ(mask.At<uint8_t>(x, y), 0) << x << ", " << y;
      }
    }
  }
  EXPECT_GT(inside, 1000);
}

// A sphere so near that it fills the picture, but for the corners, which the lens does not reach.
TEST(ReferenceRenderer, RaysWhereTheLensFoldsSeeNothing) {
  const TriangleMesh mesh = MakeSphere(kRadius, kCenter, 2);
  Camera camera = TestCamera();
  camera.k1 = -2.4, camera.k2 = camera.p1 = camera.p2 = 0;
  const Pose pose = LookAt(kCenter + Eigen::Vector3d(90, 0, 0), kCenter, {0, 0, 1});
  const ReferenceRenderer renderer(MakeModel(mesh, LinearRecipe(0)));
  const Rendering rendering = renderer.Render(camera, pose, {}, SilentProgress());
  const Image silhouette = RenderSilhouette(mesh, camera, pose);
  int folded = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const bool sees = TryUnproject(camera, Eigen::Vector2d(x, y)).has_value();
      EXPECT_EQ(rendering.coverage.At<uint8_t>(x, y), sees ? 255 : 0) << x << ", " << y;
      EXPECT_EQ(silhouette.At<uint8_t>(x, y), sees ? 255 : 0) << x << ", " << y;
      folded += sees ? 0 : 1;
    }
  }
  EXPECT_GT(folded, 100);
  EXPECT_LT(folded, camera.width * camera.height / 2);
}

/// A square plate in front of a camera at the origin that looks along +z; its right edge is at
/// pixel x = 40.25.
LightFieldModel MakePlate(const Eigen::Vector3d& color) {
  TriangleMesh mesh;
  mesh.vertices = {{-50, -50, 100}, {40.25, -50, 100}, {40.25, 50, 100}, {-50, 50, 100}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  ModelRecipe recipe;
  recipe.mean = [color](const Eigen::Vector3d&) { return color; };
  return MakeModel(mesh, recipe);
}

Camera PlateCamera() {
  Camera camera;
  camera.width = 60;
  camera.height = 9;
  camera.fx = camera.fy = 100;
  camera.cx = 0;
  camera.cy = 4;
  return camera;
}

TEST(ReferenceRenderer, CoverageIsTheShareOfRaysThatHit) {
  const ReferenceRenderer renderer(MakePlate({0.8, 0.4, 0.2}));
  RenderOptions options;
  options.samples_per_side = 4;
  options.background = {0.1f, 0.6f, 1.0f};
  const Rendering rendering = renderer.Render(PlateCamera(), Pose(), options, SilentProgress());
  // The plate's edge at 40.25 cuts pixel 40 (39.5 to 40.5) after three quarters.
  EXPECT_EQ(rendering.coverage.At<uint8_t>(39, 4), 255);
  EXPECT_EQ(rendering.coverage.At<uint8_t>(40, 4), 191);
  EXPECT_EQ(rendering.coverage.At<uint8_t>(41, 4), 0);
  const double plate[] = {0.8, 0.4, 0.2};
  for (int c = 0; c < 3; ++c) {
    const float mixed = SrgbFromLinear(0.75f * LinearFromSrgb(static_cast<float>(plate[c])) +
                                       0.25f * LinearFromSrgb(options.background[c]));
    EXPECT_NEAR(rendering.color.At<uint8_t>(39, 4, c), 255 * plate[c], 0.6);
    EXPECT_NEAR(rendering.color.At<uint8_t>(40, 4, c), 255 * mixed, 0.6);
    EXPECT_NEAR(rendering.color.At<uint8_t>(41, 4, c), 255 * options.background[c], 0.6);
    // Alone, the model keeps its own colour at the edge.
    EXPECT_NEAR(rendering.layer.At<uint8_t>(40, 4, c), 255 * plate[c], 0.6);
    EXPECT_EQ(rendering.layer.At<uint8_t>(41, 4, c), 0);
  }
  EXPECT_EQ(rendering.layer.At<uint8_t>(40, 4, 3), 191);
  EXPECT_EQ(rendering.layer.At<uint8_t>(41, 4, 3), 0);
}

TEST(ReferenceRenderer, OneSampleGoesThroughThePixelCentre) {
  const ReferenceRenderer renderer(MakePlate({1, 1, 1}));
  const Rendering rendering = renderer.Render(PlateCamera(), Pose(), {}, SilentProgress());
  EXPECT_EQ(rendering.coverage.At<uint8_t>(40, 4), 255);
  EXPECT_EQ(rendering.coverage.At<uint8_t>(41, 4), 0);
}

TEST(ReferenceRenderer, BytesDoNotDependOnTheNumberOfThreads) {
  const ReferenceRenderer renderer(MakeSmoothRandomModel(3, DirectionMap::kHemiOctahedral));
  RenderOptions options;
  options.samples_per_side = 2;
  const Camera camera = TestCamera();
  const Pose pose = LookAt({260, 190, 210}, {10, -20, 80}, {0, 0, 1});
  SetThreadCount(1);
  const Rendering one = renderer.Render(camera, pose, options, SilentProgress());
  SetThreadCount(4);
  const Rendering four = renderer.Render(camera, pose, options, SilentProgress());
  SetThreadCount(0);
  EXPECT_TRUE(one.color.Bytes() == four.color.Bytes());
  EXPECT_TRUE(one.layer.Bytes() == four.layer.Bytes());
}

TEST(ReferenceRenderer, MoreTermsThanThereAreIsAllOfThem) {
  const ReferenceRenderer renderer(MakeSmoothRandomModel(4, DirectionMap::kHemiOctahedral));
  const Pose pose = LookAt({260, 190, 210}, {10, -20, 80}, {0, 0, 1});
  RenderOptions options;
  const Rendering all = renderer.Render(TestCamera(), pose, options, SilentProgress());
  options.evaluation.terms = 3;
  const Rendering three = renderer.Render(TestCamera(), pose, options, SilentProgress());
  options.evaluation.terms = 2;
  const Rendering two = renderer.Render(TestCamera(), pose, options, SilentProgress());
  EXPECT_TRUE(all.color.Bytes() == three.color.Bytes());
  EXPECT_FALSE(all.color.Bytes() == two.color.Bytes());
}

TEST(ReferenceRenderer, LooksAwayAndSeesOnlyBackground) {
  const ReferenceRenderer renderer(MakePlate({1, 1, 1}));
  RenderOptions options;
  options.background = {0, 1, 0};
  Pose behind;
  behind.rotation = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Rendering rendering = renderer.Render(PlateCamera(), behind, options, SilentProgress());
  for (int x = 0; x < 60; ++x) {
    EXPECT_EQ(rendering.coverage.At<uint8_t>(x, 4), 0);
    EXPECT_EQ(rendering.color.At<uint8_t>(x, 4, 0), 0);
    EXPECT_EQ(rendering.color.At<uint8_t>(x, 4, 1), 255);
  }
}

TEST(ReferenceRenderer, RejectsBadCamerasOptionsAndModels) {
  const ReferenceRenderer renderer(MakePlate({1, 1, 1}));
  Camera camera = PlateCamera();
  camera.fx = std::nan("");
  EXPECT_THROW(renderer.Render(camera, Pose(), {}, SilentProgress()), Error);
  RenderOptions options;
  options.samples_per_side = 0;
  EXPECT_THROW(renderer.Render(PlateCamera(), Pose(), options, SilentProgress()), Error);
  options.samples_per_side = 1;
  options.background.x() = std::nanf("");
  EXPECT_THROW(renderer.Render(PlateCamera(), Pose(), options, SilentProgress()), Error);
  Pose pose;
  pose.translation.x() = std::nan("");
  EXPECT_THROW(renderer.Render(PlateCamera(), pose, {}, SilentProgress()), Error);
  EXPECT_THROW(ReferenceRenderer{LightFieldModel{}}, Error);
  LightFieldModel torn = MakePlate({1, 1, 1});
  torn.placements.pop_back();
  EXPECT_THROW(ReferenceRenderer{torn}, Error);
  EXPECT_THROW(RenderSilhouette(TriangleMesh(), PlateCamera(), Pose()), Error);
}

}  // namespace
}  // namespace lfm
