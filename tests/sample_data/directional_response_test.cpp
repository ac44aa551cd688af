// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/directional_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sample_data/sample_sequence.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kAlbedo = 0.6f;

// A square of 200 mm at height z, facing up.
SceneObject Square(double z, const V3f& albedo) {
  SceneObject object;
  object.name = "square";
  object.mesh.vertices = {{-100, -100, z}, {100, -100, z}, {100, 100, z}, {-100, 100, z}};
  object.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  object.mesh.normals.assign(4, Eigen::Vector3d::UnitZ());
  object.material.diffuse = albedo;
  return object;
}

// A wall of 200 mm in the plane x = 0, facing +x, from the floor up.
SceneObject Wall(const V3f& albedo) {
  SceneObject object = Square(0, albedo);
  object.name = "wall";
  object.mesh.vertices = {{0, -100, 0}, {0, 100, 0}, {0, 100, 200}, {0, -100, 200}};
  object.mesh.normals.assign(4, Eigen::Vector3d::UnitX());
  return object;
}

std::vector<PathRay> Rays(const V3f& target, int count) {
  const V3f eye(30, -50, 300);
  std::vector<PathRay> rays;
  for (int s = 0; s < count; ++s) {
    rays.push_back({eye,
                    (target - eye).normalized(),
                    {MakeSetKey(1, 2, static_cast<uint64_t>(s / kSetSize)),
                     static_cast<uint32_t>(s % kSetSize)}});
  }
  return rays;
}

TEST(DirectionalResponse, LambertIsAlbedoTimesCosineOverPi) {
  const std::vector<SceneObject> objects = {Square(0, {kAlbedo, 0.3f, 0})};
  const TracedScene scene(objects, {}, nullptr);
  std::vector<V3f> lights;
  for (int i = 0; i < 20; ++i) {  // more than a packet, some from below
    const float angle = 0.17f * static_cast<float>(i);
    lights.emplace_back(std::sin(angle), 0.0f, std::cos(angle));
  }
  const DirectionalResponse response(scene, lights, 2.0f, 0);
  std::vector<float> row(3 * lights.size(), 0.5f);
  const RayCounts rays = response.Add(Rays({10, 20, 0}, 1), 1, row.data());
  EXPECT_EQ(rays.camera, 1);
  EXPECT_EQ(rays.bounce, 0);
  for (size_t l = 0; l < lights.size(); ++l) {
    const float cosine = std::max(0.0f, lights[l].z());
    EXPECT_NEAR(row[3 * l], 0.5f + 2 * kAlbedo / kPi * cosine, 1e-6f) << l;
    EXPECT_NEAR(row[3 * l + 1], 0.5f + 2 * 0.3f / kPi * cosine, 1e-6f) << l;
    EXPECT_EQ(row[3 * l + 2], 0.5f) << l;
  }
}

TEST(DirectionalResponse, WhatStandsInTheWayCastsAShadow) {
  const std::vector<SceneObject> objects = {Square(0, {kAlbedo, kAlbedo, kAlbedo}),
                                            Wall({0, 0, 0})};
  const TracedScene scene(objects, {}, nullptr);
  const float slope = std::sqrt(0.5f);
  const DirectionalResponse response(scene, {{slope, 0, slope}, {-slope, 0, slope}}, kPi, 0);
  std::vector<float> row(6, 0.0f);
  response.Add(Rays({50, 0, 0}, 1), 1, row.data());
  EXPECT_NEAR(row[0], kAlbedo * slope, 1e-6f);
  EXPECT_EQ(row[3], 0);
}

TEST(DirectionalResponse, BouncesAgreeWithThePathTracer) {
  const std::vector<SceneObject> objects = {Square(0, {kAlbedo, 0.2f, 0.7f}),
                                            Wall({0.9f, 0.8f, 0.1f})};
  const TracedScene scene(objects, {}, nullptr);
  const std::vector<V3f> lights = {V3f(0.6f, 0, 0.8f), V3f(0.9f, 0.3f, 0.2f).normalized()};
  constexpr int kPaths = 16384;
  const DirectionalResponse response(scene, lights, 1, 2);
  std::vector<float> row(6, 0.0f);
  const std::vector<PathRay> rays = Rays({15, 0, 0}, kPaths);
  response.Add(rays, 1.0f / kPaths, row.data());
  for (size_t l = 0; l < lights.size(); ++l) {
    SceneLights light;
    light.directional = {{lights[l], {1, 1, 1}}};
    const PathTracer tracer(scene, light, 2);
    const V3f expected = tracer.TraceRadiance(rays[0].origin, rays[0].direction, kPaths, 7, 9);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(row[3 * l + static_cast<size_t>(c)], expected[c], 0.02f * expected[c]) << l;
    }
    const PathTracer direct(scene, light, 0);
    const V3f without = direct.TraceRadiance(rays[0].origin, rays[0].direction, 16, 7, 9);
    EXPECT_GT(expected[0], 1.05f * without[0]) << "the wall must matter";
  }
}

TEST(DirectionalResponse, RefusesWhatIsNoLight) {
  const std::vector<SceneObject> objects = {Square(0, {1, 1, 1})};
  const TracedScene scene(objects, {}, nullptr);
  EXPECT_THROW(DirectionalResponse(scene, {}, 1, 0), Error);
  EXPECT_THROW(DirectionalResponse(scene, {{0, 0, 2}}, 1, 0), Error);
  EXPECT_THROW(DirectionalResponse(scene, {{0, 0, NAN}}, 1, 0), Error);
  EXPECT_THROW(DirectionalResponse(scene, {{0, 0, 1}}, 1, 65), Error);
}

// Of bounced light a path brings the limit at most; direct light is spared.
TEST(DirectionalResponse, TheLimitCutsBouncedLightOnly) {
  const std::vector<SceneObject> objects = {Square(0, {kAlbedo, kAlbedo, kAlbedo}),
                                            Wall({0.9f, 0.45f, 0.9f})};
  const TracedScene scene(objects, {}, nullptr);
  const std::vector<V3f> lights = {V3f(1, 0, 0.3f).normalized()};
  const auto row = [&](int bounces, float limit) {
    std::vector<float> values(3, 0.0f);
    const std::vector<PathRay> rays = Rays({10, 0, 0}, 4096);
    DirectionalResponse(scene, lights, kPi, bounces, limit)
        .Add(rays, 1.0f / static_cast<float>(rays.size()), values.data());
    return values;
  };
  constexpr float kLimit = 0.05f;
  const std::vector<float> direct = row(0, kLimit), all = row(1, 1e9f), limited = row(1, kLimit);
  EXPECT_EQ(direct, row(0, 1e9f));
  EXPECT_GT(all[0] - direct[0], 2 * kLimit);
  EXPECT_GT(limited[0] - direct[0], 0.2f * kLimit);
  EXPECT_LT(limited[0] - direct[0], kLimit);
  // All colours are scaled alike.
  EXPECT_NEAR((limited[1] - direct[1]) / (limited[0] - direct[0]), 0.5, 1e-3);
  EXPECT_THROW(DirectionalResponse(scene, lights, 1, 1, 0), Error);
}

}  // namespace
}  // namespace lfm
