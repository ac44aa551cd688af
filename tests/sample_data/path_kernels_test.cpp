// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/lanes/path_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "sample_data/path_tracer.h"
#include "tests/sample_data/test_shapes.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

// Every kind of material, light and texture at once.
struct Everything {
  std::vector<SceneObject> objects;
  SceneLights lights;

  Everything() {
    for (int kind = 0; kind < 7; ++kind) {
      Material m;
      m.kind = static_cast<MaterialKind>(kind);
      m.diffuse = {0.5f, 0.4f, 0.3f};
      m.specular = {0.3f, 0.4f, 0.5f};
      m.alpha_u = 0.2f;
      m.alpha_v = m.kind == MaterialKind::kConductor ? 0.4f : 0.2f;
      m.absorption_per_mm = {0.01f, 0.02f, 0.0f};
      objects.push_back(TestObject(TestSphere(12, {40.0 * (kind - 3), 0, 30}, 22), m));
    }
    Material mirror;
    mirror.kind = MaterialKind::kConductor;
    mirror.alpha_u = mirror.alpha_v = 0;
    mirror.specular = {0.9f, 0.8f, 0.7f};
    objects.push_back(TestObject(TestBox({-150, 60, 0}, {150, 70, 90}), mirror));
    Material clear;
    clear.kind = MaterialKind::kGlass;
    clear.alpha_u = clear.alpha_v = 0;
    objects.push_back(TestObject(TestSphere(12, {20, -50, 25}, 18), clear));
    SceneObject floor = TestObject(TestSquare(200, 0), Material());
    floor.texture.kind = TextureKind::kChecker;
    floor.texture.scale_mm = 13;
    objects.push_back(std::move(floor));
    lights.studio = MakeStudioLighting();
    lights.environment = MakeStudioEnvironment(64);
    lights.directional = {{V3f(0.6f, 0, 0.8f), {1, 1, 1}}, {V3f(0, 0.6f, 0.8f), {1, 0.5f, 0.5f}}};
  }
};

std::vector<PathRay> Rays(int count) {
  std::vector<PathRay> rays;
  const V3f eye(10, -320, 140);
  for (int k = 0; k < count; ++k) {
    const V3f to(static_cast<float>(k % 41) * 8 - 160, 0, static_cast<float>(k / 41 % 29) * 4 - 20);
    rays.push_back({eye,
                    (to - eye).normalized(),
                    {MakeSetKey(5, 0, static_cast<uint64_t>(k)), static_cast<uint32_t>(k % 4)}});
  }
  return rays;
}

TEST(PathKernels, EveryInstructionSetGivesTheSameBits) {
  const Everything all;
  const TracedScene scene(all.objects, {}, nullptr);
  const PathTracer tracer(scene, all.lights, 3, 50);
  const std::vector<PathRay> rays = Rays(41 * 29);
  std::vector<V3f> first(rays.size());
  const RayCounts counts = tracer.Trace(rays, first, nullptr, &UsablePathKernels().back());
  double sum = 0;
  for (const V3f& v : first) {
    ASSERT_TRUE(v.allFinite());
    sum += v.sum();
  }
  EXPECT_GT(sum, 0);
  EXPECT_GT(counts.bounce, counts.camera);
  for (const PathKernels& kernels : UsablePathKernels()) {
    std::vector<V3f> other(rays.size());
    const RayCounts again = tracer.Trace(rays, other, nullptr, &kernels);
    EXPECT_EQ(again.Total(), counts.Total()) << kernels.name;
    EXPECT_EQ(std::memcmp(first.data(), other.data(), first.size() * sizeof(V3f)), 0)
        << kernels.name;
  }
}

// A ray's estimate is its own, however it is packed with others.
TEST(PathKernels, LanesDoNotSeeEachOther) {
  const Everything all;
  const TracedScene scene(all.objects, {}, nullptr);
  const PathTracer tracer(scene, all.lights, 2);
  const std::vector<PathRay> rays = Rays(301);
  std::vector<V3f> together(rays.size());
  tracer.Trace(rays, together);
  for (size_t k = 0; k < rays.size(); ++k) {
    V3f alone;
    tracer.Trace({&rays[k], 1}, {&alone, 1});
    ASSERT_EQ(std::memcmp(&alone, &together[k], sizeof alone), 0) << k;
  }
  EXPECT_EQ(tracer.Trace({}, {}).Total(), 0);
}

TEST(PathKernels, BaselineRunsEverywhere) {
  ASSERT_FALSE(UsablePathKernels().empty());
  EXPECT_EQ(UsablePathKernels().back().name, std::string("lanes_baseline"));
}

}  // namespace
}  // namespace lfm
