// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <string>

#include "sample_data/scene_description.h"

namespace lfm {

inline TriangleMesh TestSphere(int rows, const Eigen::Vector3d& center, double radius) {
  TriangleMesh mesh;
  const int columns = 2 * rows;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double theta = std::numbers::pi * i / rows, phi = 2 * std::numbers::pi * j / columns;
      const Eigen::Vector3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                              std::cos(theta));
      mesh.vertices.push_back(center + radius * n);
      mesh.normals.push_back(n);
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int a = i * columns + j, b = i * columns + (j + 1) % columns;
      if (i > 0) mesh.triangles.emplace_back(a, a + columns, b);
      if (i + 1 < rows) mesh.triangles.emplace_back(b, a + columns, b + columns);
    }
  }
  return mesh;
}

/// An axis-parallel box with flat shading.
inline TriangleMesh TestBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const int b = (axis + 1) % 3, c = (axis + 2) % 3,
                first = static_cast<int>(mesh.vertices.size());
      for (int corner = 0; corner < 4; ++corner) {
        Eigen::Vector3d p;
        p[axis] = side == 1 ? high[axis] : low[axis];
        p[b] = corner == 1 || corner == 2 ? high[b] : low[b];
        p[c] = corner >= 2 ? high[c] : low[c];
        mesh.vertices.push_back(p);
        Eigen::Vector3d n = Eigen::Vector3d::Zero();
        n[axis] = side == 1 ? 1 : -1;
        mesh.normals.push_back(n);
      }
      const int second = side == 1 ? first + 1 : first + 3,
                fourth = side == 1 ? first + 3 : first + 1;
      mesh.triangles.emplace_back(first, second, first + 2);
      mesh.triangles.emplace_back(first, first + 2, fourth);
    }
  }
  return mesh;
}

/// The square |x|, |y| <= half at height z, facing up.
inline TriangleMesh TestSquare(double half, double z) {
  TriangleMesh mesh;
  mesh.vertices = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
  mesh.normals.assign(4, Eigen::Vector3d(0, 0, 1));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

inline SceneObject TestObject(TriangleMesh mesh, const Material& material) {
  SceneObject object;
  object.name = "test";
  object.mesh = std::move(mesh);
  object.material = material;
  return object;
}

inline EnvironmentMap UniformEnvironment(const Eigen::Vector3f& radiance, int width = 8) {
  Image image(width, width / 2, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (size_t i = 0; i < image.size(); ++i) image.Data<float>()[i] = radiance[i % 3];
  return {std::make_shared<const Image>(std::move(image)), 1};
}

}  // namespace lfm
