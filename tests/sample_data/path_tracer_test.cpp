// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/path_tracer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sample_data/bsdf.h"
#include "tests/sample_data/test_shapes.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

constexpr double kPi = std::numbers::pi;

Material Diffuse(float albedo) {
  Material m;
  m.diffuse = V3f::Constant(albedo);
  return m;
}

Material Glass(float alpha) {
  Material m;
  m.kind = MaterialKind::kGlass;
  m.alpha_u = m.alpha_v = alpha;
  return m;
}

struct Stage {
  std::vector<SceneObject> objects;
  SceneLights lights;
  int bounces = 0;

  V3f Look(const V3f& from, const V3f& to, int samples, uint64_t seed = 1) const {
    const TracedScene scene(objects, {}, nullptr);
    const PathTracer tracer(scene, lights, bounces);
    return tracer.TraceRadiance(from, (to - from).normalized(), samples, seed, 0);
  }
};

TEST(SampleSequence, SetsAreStratifiedAndNumbersUniform) {
  double sum = 0, squares = 0;
  for (uint64_t set = 0; set < 2000; ++set) {
    int columns[4] = {}, rows[4] = {}, quarters[4] = {};
    for (uint32_t i = 0; i < 4; ++i) {
      const auto u = RandomPair({set, i}, 3);
      ASSERT_TRUE(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1);
      ++columns[static_cast<int>(u[0] * 4)];
      ++rows[static_cast<int>(u[1] * 4)];
      ++quarters[static_cast<int>(u[0] * 2) * 2 + static_cast<int>(u[1] * 2)];
      sum += u[0];
      squares += u[1] * u[1];
    }
    for (int q = 0; q < 4; ++q) {
      ASSERT_EQ(columns[q], 1);
      ASSERT_EQ(rows[q], 1);
      ASSERT_EQ(quarters[q], 1);
    }
  }
  EXPECT_NEAR(sum / 8000, 0.5, 0.003);
  EXPECT_NEAR(squares / 8000, 1 / 3.0, 0.004);
}

TEST(PathTracer, ConvexLambertBodyInAWhiteRoomHasItsAlbedo) {
  Stage stage;
  stage.objects = {TestObject(TestSphere(64, {0, 0, 0}, 50), Diffuse(0.6f))};
  stage.lights.environment = UniformEnvironment({1, 2, 0.5f});
  const V3f seen = stage.Look({300, 40, 20}, {5, 3, 8}, 4096);
  EXPECT_NEAR(seen.x(), 0.6, 0.006);
  EXPECT_NEAR(seen.y(), 1.2, 0.012);
  EXPECT_NEAR(seen.z(), 0.3, 0.003);
}

// With enough bounces a closed white room loses nothing; with few, a geometric series is cut off.
TEST(PathTracer, BouncesAreAGeometricSeriesInsideASphere) {
  Stage stage;
  stage.objects = {TestObject(TestSphere(64, {0, 0, 0}, 100), Diffuse(0.5f))};
  // Light from a small lamp in the middle that shines down; inside a sphere of albedo a the light
  // after the first bounce is the same everywhere: E1 = power a / (area), and so on.
  AreaLight lamp;
  lamp.center = {0, 0, 0};
  lamp.half_u = {0, 5, 0};
  lamp.half_v = {5, 0, 0};  // u x v = -z
  lamp.radiance = {100, 100, 100};
  stage.lights.studio.lights = {lamp};
  const double power = kPi * 100 * lamp.Area(), area = 4 * kPi * 100 * 100;
  for (int bounces : {1, 2, 3}) {
    stage.bounces = bounces;
    double expected = 0;  // at the top, which the lamp does not reach straight
    for (int b = 1; b <= bounces; ++b) expected += power / area * std::pow(0.5, b) * 0.5 / kPi;
    const V3f seen = stage.Look({0, 10, 50}, {0, 15, 99}, 16384);
    EXPECT_NEAR(seen.x(), expected, 0.02 * expected) << bounces;
  }
}

// Irradiance under a rectangle parallel to the plane, corner above the point (Siegel and Howell):
// form factor = [x/sqrt(1+x2) atan(y/sqrt(1+x2)) + y/sqrt(1+y2) atan(x/sqrt(1+y2))] / (2 pi).
double CornerFactor(double x, double y) {
  const double a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
  return (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * kPi);
}

TEST(PathTracer, PlaneUnderARectangleHasTheAnalyticFormFactor) {
  Stage stage;
  stage.objects = {TestObject(TestSquare(200, 0), Diffuse(0.7f))};
  AreaLight lamp;
  lamp.center = {30, 20, 100};
  lamp.half_u = {0, 60, 0};
  lamp.half_v = {40, 0, 0};
  lamp.radiance = {3, 3, 3};
  stage.lights.studio.lights = {lamp};
  // Seen from the origin the lamp covers x in [-10, 70], y in [-40, 80].
  double factor = 0;
  for (double x : {0.1, 0.7}) {
    for (double y : {0.4, 0.8}) factor += CornerFactor(x, y);
  }
  const V3f seen = stage.Look({-30, -50, 80}, {0, 0, 0}, 8192);
  EXPECT_NEAR(seen.x(), 0.7 * 3 * factor, 0.004 * 0.7 * 3 * factor);
}

TEST(PathTracer, DirectionalLightIsExactAndCastsShadows) {
  Stage stage;
  stage.objects = {TestObject(TestSquare(200, 0), Diffuse(0.5f)),
                   TestObject(TestBox({40, -10, 40}, {60, 10, 60}), Diffuse(0.5f))};
  stage.lights.directional = {{{0.6f, 0, 0.8f}, {2, 2, 2}}};
  EXPECT_NEAR(stage.Look({-90, 0, 90}, {-50, 0, 0}, 1).x(), 0.5 / kPi * 2 * 0.8, 1e-5);
  EXPECT_EQ(stage.Look({-90, 0, 90}, {12, 0, 0}, 4).x(), 0);  // (12 + 0.75 z, z) meets the box
}

TEST(PathTracer, MirrorShowsTheEnvironmentExactly) {
  Stage stage;
  Material mirror;
  mirror.kind = MaterialKind::kConductor;
  mirror.specular = {1, 0.5f, 0.25f};
  mirror.alpha_u = mirror.alpha_v = 0;
  stage.objects = {TestObject(TestSquare(200, 0), mirror)};
  stage.lights.environment = MakeStudioEnvironment(64);
  const EnvironmentLight sky({}, stage.lights.environment);
  for (const V3f& from : {V3f(100, 20, 60), V3f(-30, 80, 90)}) {
    const V3f d = -from.normalized(), reflected(d.x(), d.y(), -d.z());
    const V3f expected = sky.Radiance(reflected);
    const float m = std::pow(1 - from.normalized().z(), 5.0f);
    const V3f seen = stage.Look(from, {0, 0, 0}, 1);
    for (int c = 0; c < 3; ++c) {
      const float f = mirror.specular[c] + (1 - mirror.specular[c]) * m;
      EXPECT_NEAR(seen[c], f * expected[c], 1e-3 * expected[c]);
    }
  }
}

// R and T of both faces with all reflections between them: T = (1-F)^2 a / (1 - F^2 a^2).
TEST(PathTracer, GlassSlabTransmitsTheFresnelSeriesAndAbsorbs) {
  for (float absorption : {0.0f, 0.05f}) {
    Stage stage;
    Material glass = Glass(0);
    glass.absorption_per_mm = V3f::Constant(absorption);
    stage.objects = {TestObject(TestBox({-3000, -3000, -5}, {3000, 3000, 5}), glass)};
    Image image(16, 8, 3, PixelType::kFloat32, ColorEncoding::kLinear);
    for (int y = 4; y < 8; ++y) {
      for (int x = 0; x < 16; ++x) image.At<float>(x, y, 0) = 1;  // light from below: red
    }
    stage.lights.environment = {std::make_shared<const Image>(image), 1};
    for (double theta : {0.0, 0.8}) {
      const double inside = std::asin(std::sin(theta) / 1.5);
      const double s =
          std::pow(std::sin(theta - inside) / std::max(1e-12, std::sin(theta + inside)), 2);
      const double p =
          std::pow(std::tan(theta - inside) / std::max(1e-12, std::tan(theta + inside)), 2);
      const double f = theta == 0 ? 0.04 : 0.5 * (s + p);
      const double a = std::exp(-absorption * 10 / std::cos(inside));
      const double expected = (1 - f) * (1 - f) * a / (1 - f * f * a * a);
      const V3f from(static_cast<float>(100 * std::tan(theta)), 0, 105);
      const V3f seen = stage.Look(from, {0, 0, 5}, 20000);
      EXPECT_NEAR(seen.x(), expected, 0.008) << absorption << " " << theta;
    }
  }
}

TEST(PathTracer, GlassInAWhiteRoomCannotBeSeen) {
  for (float alpha : {0.0f, 0.02f}) {
    Stage stage;
    stage.objects = {TestObject(TestSphere(96, {0, 0, 0}, 40), Glass(alpha))};
    stage.lights.environment = UniformEnvironment({1, 1, 1});
    for (const V3f& at : {V3f(0, 0, 0), V3f(0, 20, 10), V3f(0, 33, 5)}) {
      EXPECT_NEAR(stage.Look({200, 0, 0}, at, 4096).x(), 1, 0.012) << alpha << " " << at.y();
    }
  }
}

// A lamp reached by shadow rays and by the BSDF's own: neither strategy alone may bias the sum.
TEST(PathTracer, HighlightsOfALampAgreeWithNumericalIntegration) {
  AreaLight lamp = AimLight({0, 0, 0}, 0, 45, 200, 80, 60, {2, 2, 2});
  for (float alpha : {0.02f, 0.1f, 0.5f}) {
    Stage stage;
    Material metal;
    metal.kind = MaterialKind::kConductor;
    metal.specular = {0.9f, 0.9f, 0.9f};
    metal.alpha_u = alpha;
    metal.alpha_v = 2 * alpha;
    stage.objects = {TestObject(TestSquare(100, 0), metal)};
    stage.lights.studio.lights = {lamp};
    const V3f from(-100, 5, 90);
    const TracedScene scene(stage.objects, {}, nullptr);
    const SurfacePoint point = scene.SurfaceAt(0, 0, 0, 0.5f, from.normalized());
    ASSERT_LT(point.position.norm(), 1e-4);
    double expected = 0;
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps * kSteps; ++i) {
      const V3 to = lamp.Point((i % kSteps + 0.5) / kSteps, (i / kSteps + 0.5) / kSteps);
      const double r2 = to.squaredNorm(), facing = -lamp.Normal().dot(to) / std::sqrt(r2);
      const V3f w = to.normalized().cast<float>();
      expected +=
          2 * facing / r2 * lamp.Area() / (kSteps * kSteps) *
          EvaluateBsdf(point.material, point.frame.Local(from.normalized()), point.frame.Local(w))
              .value.x();
    }
    const V3f seen = stage.Look(from, {0, 0, 0}, 16384);
    EXPECT_NEAR(seen.x(), expected, 0.01 * expected) << alpha;
  }
}

// Smooth normals on a coarse closed body: no light from outside may come in, and bodies stay dark
// on the side that no light reaches.
TEST(PathTracer, NoLightLeaksIntoAClosedBody) {
  Material shiny;
  shiny.kind = MaterialKind::kPlastic;
  shiny.alpha_u = shiny.alpha_v = 0.2f;
  for (const Material& m : {Diffuse(0.8f), shiny}) {
    Stage stage;
    stage.bounces = 3;
    stage.objects = {TestObject(TestSphere(6, {0, 0, 0}, 50), m)};
    stage.lights.environment = UniformEnvironment({100, 100, 100});
    stage.lights.directional = {{V3f(1, 0, 0), {100, 100, 100}}};
    stage.lights.studio.lights = {AimLight({0, 0, 0}, 30, 40, 300, 50, 50, {500, 500, 500})};
    for (int k = 0; k < 40; ++k) {
      const V3f to(std::cos(2.4f * k), std::sin(2.4f * k), std::cos(0.7f * k));
      EXPECT_EQ(stage.Look({1, 2, 3}, 50 * to, 16, k).norm(), 0);
    }
  }
}

// Light of one surface is left alone; light of two is held below the limit a path.
TEST(PathTracer, IndirectLimitActsOnBouncedLightOnly) {
  Stage stage;
  stage.objects = {TestObject(TestSquare(100, 0), Diffuse(0.5f)),
                   TestObject(TestBox({20, -80, 0}, {30, 80, 80}), Diffuse(0.9f))};
  stage.lights.directional = {{V3f(-0.6f, 0, 0.8f), {9, 9, 9}}};
  const TracedScene scene(stage.objects, {}, nullptr);
  const auto seen = [&](int bounces, float limit) {
    const PathTracer tracer(scene, stage.lights, bounces, limit);
    return tracer.TraceRadiance({-60, 0, 60}, V3f(75, 0, -60).normalized(), 1024, 1, 0).x();
  };
  const float direct = 0.5f / static_cast<float>(kPi) * 9 * 0.8f;
  EXPECT_NEAR(seen(0, 1e-3f), direct, 1e-4);
  EXPECT_GT(seen(1, 1e9f), direct + 0.05f);
  EXPECT_LE(seen(1, 0.01f), direct + 0.0101f);
  EXPECT_GT(seen(1, 0.01f), direct + 0.001f);
}

TEST(PathTracer, BadLightsAreRefused) {
  Stage stage;
  stage.objects = {TestObject(TestSquare(10, 0), Diffuse(0.5f))};
  stage.bounces = -1;
  EXPECT_THROW(stage.Look({0, 0, 9}, {0, 0, 0}, 1), Error);
  stage.bounces = 0;
  stage.lights.directional = {{V3f(0, 0, 2), {1, 1, 1}}};
  EXPECT_THROW(stage.Look({0, 0, 9}, {0, 0, 0}, 1), Error);
  stage.lights.directional.clear();
  stage.objects[0].mesh.vertices[0].x() = std::nan("");
  EXPECT_THROW(stage.Look({0, 0, 9}, {0, 0, 0}, 1), Error);
}

}  // namespace
}  // namespace lfm
