// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/light_transport.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "tests/sample_data/test_shapes.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr double kPi = std::numbers::pi;

Material MakePhong(float diffuse, float specular, float exponent) {
  Material m;
  m.kind = MaterialKind::kPhong;
  m.diffuse = V3f::Constant(diffuse);
  m.specular = V3f::Constant(specular);
  m.exponent = exponent;
  return m;
}

std::vector<float> Row(const std::vector<SceneObject>& objects, const TransportOptions& options,
                       const V3f& from, const V3f& to) {
  const TracedScene scene(objects, {}, nullptr);
  const TransportRow transport(scene, options);
  std::vector<float> row(static_cast<size_t>(options.cube.Texels()) * 3, 0);
  transport.AddRay(from, (to - from).normalized(), 7, 1, row.data());
  return row;
}

double Sum(const std::vector<float>& row) {
  double sum = 0;
  for (size_t i = 0; i < row.size(); i += 3) sum += row[i];
  return sum;
}

TEST(CubeMap, TexelsTileTheSphere) {
  for (int n : {1, 4, 32}) {
    const CubeMap cube{n};
    double sum = 0;
    for (int t = 0; t < cube.Texels(); ++t) {
      EXPECT_EQ(cube.TexelOf(cube.Direction(t)), t);
      EXPECT_EQ(cube.TexelOf(cube.Point(t, 0.02f, 0.98f)), t);
      EXPECT_GT(cube.SolidAngle(t), 0);
      sum += cube.SolidAngle(t);
    }
    EXPECT_NEAR(sum, 4 * kPi, 1e-9);
  }
  const CubeMap cube{4};
  EXPECT_GT(cube.Direction(0).x(), 0.5f);
  EXPECT_LT(cube.Direction(16).x(), -0.5f);
  EXPECT_GT(cube.Direction(4 * 16).z(), 0.5f);
}

// Rows of an open plane sum to the directional albedo, whatever the lobe's width: by midpoints for
// wide lobes, by weighed samples for narrow ones.
TEST(TransportRow, SumIsTheAlbedoForEveryExponent) {
  TransportOptions options;
  options.paths = 256;
  const V3f above(0, 0, 80);
  const auto sum = [&](const Material& m) {
    return Sum(Row({TestObject(TestSquare(100, 0), m)}, options, above, {0, 0, 0}));
  };
  EXPECT_NEAR(sum(MakePhong(0.8f, 0, 1)), 0.8, 0.002);
  for (float exponent : {1.0f, 10.0f, 100.0f, 1000.0f}) {
    EXPECT_NEAR(sum(MakePhong(0.2f, 0.5f, exponent)), 0.7, 0.01) << exponent;
  }
  for (float exponent : {1e4f, 1e5f}) {
    EXPECT_NEAR(sum(MakePhong(0.2f, 0.5f, exponent)), 0.7, 0.03) << exponent;
  }
}

TEST(TransportRow, LambertRowIsCosineTimesSolidAngle) {
  TransportOptions options;
  options.cube.resolution = 16;
  Material m;
  m.diffuse = {0.5f, 0.25f, 1};
  const std::vector<float> row =
      Row({TestObject(TestSquare(100, 0), m)}, options, {10, 20, 60}, {0, 0, 0});
  for (int t = 0; t < options.cube.Texels(); ++t) {
    const double expected =
        std::max(0.0f, options.cube.Direction(t).z()) / kPi * options.cube.SolidAngle(t);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(row[3 * static_cast<size_t>(t) + c], m.diffuse[c] * expected, 2e-5) << t;
    }
  }
}

TEST(TransportRow, BlockersDarkenTheTexelsBehindThem) {
  TransportOptions options;
  Material m;
  // A wall on the side of +x.
  const std::vector<float> row = Row(
      {TestObject(TestSquare(100, 0), m), TestObject(TestBox({10, -1e4, 1}, {12, 1e4, 1e5}), m)},
      options, {-50, 0, 60}, {0, 0, 0});
  for (int t = 0; t < options.cube.Texels(); ++t) {
    const V3f d = options.cube.Direction(t);
    const float value = row[3 * static_cast<size_t>(t)];
    if (d.z() > 0.2f && d.x() > 0.1f) {
      EXPECT_EQ(value, 0) << d.transpose();
    }
    if (d.z() > 0.1f && d.x() < -0.1f) {
      EXPECT_GT(value, 0) << d.transpose();
    }
  }
}

TEST(TransportRow, MirrorSeesOneTexelAndSoDoesEmptySpace) {
  TransportOptions options;
  Material mirror;
  mirror.kind = MaterialKind::kConductor;
  mirror.specular = {1, 1, 1};
  mirror.alpha_u = mirror.alpha_v = 0;
  const V3f from(-40, 3, 70);
  const std::vector<float> row =
      Row({TestObject(TestSquare(100, 0), mirror)}, options, from, {0, 0, 0});
  EXPECT_NEAR(row[3 * static_cast<size_t>(options.cube.TexelOf({40, -3, 70}))], 1, 1e-5);
  EXPECT_NEAR(Sum(row), 1, 1e-5);
  const std::vector<float> sky =
      Row({TestObject(TestSquare(100, 0), mirror)}, options, from, {-40, 3, 900});
  EXPECT_EQ(sky[3 * static_cast<size_t>(options.cube.TexelOf({0, 0, 1}))], 1);
}

// The row's sum is the radiance under uniform light, which the path tracer finds another way.
TEST(TransportRow, AgreesWithThePathTracerInAGrooveWithBounces) {
  Material wall;
  wall.diffuse = {0.8f, 0.8f, 0.8f};
  const std::vector<SceneObject> objects = {
      TestObject(TestSquare(100, 0), wall),
      TestObject(TestBox({10, -200, 0}, {20, 200, 40}), MakePhong(0.4f, 0.5f, 30)),
      TestObject(TestBox({-20, -200, 0}, {-10, 200, 40}), wall)};
  const V3f from(3, -100, 90), to(2, 0, 0);
  SceneLights lights;
  lights.environment = UniformEnvironment({1, 1, 1});
  const TracedScene scene(objects, {}, nullptr);
  double last = 0;
  for (int bounces : {0, 1, 3}) {
    TransportOptions options;
    options.bounces = bounces;
    options.paths = 16384;
    options.samples_per_texel = 4;
    const double sum = Sum(Row(objects, options, from, to));
    const PathTracer tracer(scene, lights, bounces);
    const double traced = tracer.TraceRadiance(from, (to - from).normalized(), 16384, 3, 0).x();
    EXPECT_NEAR(sum, traced, 0.015) << bounces;
    EXPECT_GT(sum, last + 0.01);
    last = sum;
  }
}

TEST(TransportRow, BadOptionsAreRefused) {
  const std::vector<SceneObject> objects = {TestObject(TestSquare(1, 0), Material())};
  const TracedScene scene(objects, {}, nullptr);
  TransportOptions options;
  options.cube.resolution = 0;
  EXPECT_THROW(TransportRow(scene, options), Error);
  options.cube.resolution = 8;
  options.samples_per_texel = 0;
  EXPECT_THROW(TransportRow(scene, options), Error);
}

}  // namespace
}  // namespace lfm
