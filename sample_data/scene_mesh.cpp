// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scene_mesh.h"

#include <algorithm>

#include "core/image.h"
#include "sample_data/texture.h"

namespace lfm {
namespace {

// The albedo at every vertex, as sRGB. A vertex without a triangle is black.
std::vector<Eigen::Vector3f> VertexColors(const SceneObject& object) {
  const TextureFrame frame = MakeTextureFrame(object);
  std::vector<Eigen::Vector3f> colors(object.mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (size_t t = 0; t < object.mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const auto v = static_cast<size_t>(object.mesh.triangles[t][c]);
      const Material material =
          ResolveMaterial(object, frame, static_cast<int>(t), c == 1 ? 1.0f : 0.0f,
                          c == 2 ? 1.0f : 0.0f, object.mesh.vertices[v].cast<float>());
      for (int k = 0; k < 3; ++k) {
        colors[v][k] =
            static_cast<float>(SrgbFromLinear(std::clamp(material.diffuse[k], 0.0f, 1.0f)));
      }
    }
  }
  return colors;
}

}  // namespace

TriangleMesh JoinObjects(const std::vector<SceneObject>& objects) {
  TriangleMesh joined;
  for (const SceneObject& object : objects) {
    const int first = static_cast<int>(joined.vertices.size());
    const TriangleMesh& mesh = object.mesh;
    joined.vertices.insert(joined.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const Eigen::Vector3i& t : mesh.triangles) {
      joined.triangles.emplace_back(t.array() + first);
    }
    const std::vector<Eigen::Vector3d> normals =
        mesh.normals.empty() ? ComputeVertexNormals(mesh) : mesh.normals;
    joined.normals.insert(joined.normals.end(), normals.begin(), normals.end());
    const std::vector<Eigen::Vector3f> colors = VertexColors(object);
    joined.colors.insert(joined.colors.end(), colors.begin(), colors.end());
  }
  return joined;
}

}  // namespace lfm
