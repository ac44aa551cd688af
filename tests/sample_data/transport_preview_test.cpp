// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/transport_preview.h"

#include <gtest/gtest.h>

#include "sample_data/sensor.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

SceneObject Sheet(double z) {
  SceneObject object;
  object.mesh.vertices = {{-50, -50, z}, {50, -50, z}, {50, 50, z}, {-50, 50, z}};
  object.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  object.mesh.normals.assign(4, Eigen::Vector3d::UnitZ());
  return object;
}

// Radiance that is linear over the world stays linear in the picture, each object with its own.
TEST(TransportPreview, InterpolatesEachObjectsVertices) {
  const std::vector<SceneObject> objects = {Sheet(0), Sheet(-30)};
  const TracedScene scene(objects, {}, nullptr);
  FixedView view;
  view.width = 40;
  view.height = 30;
  view.fov_deg = 20;
  view.eye = {0, -300, 300};
  view.target = {0, 0, 0};
  std::vector<V3f> radiance;
  for (const SceneObject& object : objects) {
    for (const Eigen::Vector3d& p : object.mesh.vertices) {
      const float x = static_cast<float>(p.x());
      radiance.emplace_back(0.4f + 0.006f * x, &object == &objects[0] ? 0.5f : 0.0f, 0.1f);
    }
  }
  const Image picture = PreviewMesh(scene, view, radiance);
  const Camera camera = FixedCamera(view);
  const Pose pose = FixedPose(view);
  for (const double x : {-30.0, -10.0, 0.0, 25.0}) {
    const auto pixel = Project(camera, pose * Eigen::Vector3d(x, 5, 0));
    ASSERT_TRUE(pixel);
    const int px = static_cast<int>(std::lround(pixel->x()));
    const int py = static_cast<int>(std::lround(pixel->y()));
    const double level = LinearFromSrgb(picture.At<uint8_t>(px, py, 0) / 255.0f);
    EXPECT_NEAR(level, 0.4 + 0.006 * x, 0.015);  // half a pixel is 1.5 mm
    EXPECT_EQ(picture.At<uint8_t>(px, py, 1), EncodeSrgb8(0.5f));
    EXPECT_EQ(picture.At<uint8_t>(px, py, 2), EncodeSrgb8(0.1f));
  }
  EXPECT_EQ(picture.At<uint8_t>(0, 0, 0), picture.At<uint8_t>(0, 0, 1));  // nothing there
}

}  // namespace
}  // namespace lfm
