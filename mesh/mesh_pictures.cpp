// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh_pictures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"

namespace lfm {
namespace {

constexpr double kWireWidthPx = 0.6;

// The viridis colour map (Smith and van der Walt 2015) at nine places: even steps look even, also
// to colour-blind people and in gray.
Eigen::Vector3d MapColor(double share) {
  static const std::array<Eigen::Vector3d, 9> kColors = {{{0.267, 0.005, 0.329},
                                                          {0.279, 0.175, 0.483},
                                                          {0.230, 0.322, 0.546},
                                                          {0.173, 0.449, 0.558},
                                                          {0.128, 0.567, 0.551},
                                                          {0.158, 0.684, 0.502},
                                                          {0.369, 0.789, 0.383},
                                                          {0.678, 0.864, 0.190},
                                                          {0.993, 0.906, 0.144}}};
  if (!std::isfinite(share)) return {0.85, 0.1, 0.1};
  const double place = std::clamp(share, 0.0, 1.0) * (kColors.size() - 1);
  const size_t below = std::min<size_t>(static_cast<size_t>(place), kColors.size() - 2);
  const double rest = place - static_cast<double>(below);
  return (1 - rest) * kColors[below] + rest * kColors[below + 1];
}

struct Painter {
  const TriangleMesh& mesh;
  const MeshPictureOptions& options;
  double focal_px;

  Eigen::Vector3d Surface(const Eigen::Vector3i& corners, const Eigen::Vector3d& weights) const {
    if (options.values.empty()) return {0.75, 0.75, 0.75};
    double value = 0;
    for (int k = 0; k < 3; ++k) value += weights[k] * options.values[corners[k]];
    return MapColor((value - options.value_low) / (options.value_high - options.value_low));
  }

  // Distance to the nearest edge of the triangle, in pixels where it is seen face on.
  double PixelsToEdge(int triangle, const Eigen::Vector3d& weights, double distance) const {
    const Eigen::Vector3i& c = mesh.triangles[triangle];
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double base = (mesh.vertices[c[(k + 1) % 3]] - mesh.vertices[c[(k + 2) % 3]]).norm();
      if (base > 0)
        nearest = std::min(nearest, weights[k] * 2 * TriangleArea(mesh, triangle) / base);
    }
    return nearest * focal_px / distance;
  }

  Eigen::Vector3d Paint(const RayHit& hit, const Eigen::Vector3d& direction) const {
    const Eigen::Vector3i& corners = mesh.triangles[hit.triangle];
    const Eigen::Vector3d weights(1 - hit.u - hit.v, hit.u, hit.v);
    Eigen::Vector3d normal = TriangleNormal(mesh, hit.triangle);
    if (!mesh.normals.empty()) {
      normal.setZero();
      for (int k = 0; k < 3; ++k) normal += weights[k] * mesh.normals[corners[k]];
      normal.normalize();
    }
    const double facing = std::max(0.0, -normal.dot(direction));
    Eigen::Vector3d color = (0.25 + 0.75 * facing) * Surface(corners, weights);
    if (options.wires == MeshWires::kDrawn &&
        PixelsToEdge(hit.triangle, weights, hit.distance) < kWireWidthPx) {
      color *= 0.35;
    }
    return color;
  }
};

void CheckPicture(const TriangleMesh& mesh, const Camera& camera,
                  const MeshPictureOptions& options) {
  ValidateMesh(mesh, "mesh picture");
  ValidateCamera(camera, "mesh picture");
  if (!options.values.empty() && (options.values.size() != mesh.vertices.size() ||
                                  !(options.value_high > options.value_low))) {
    throw Error("mesh picture: expected a value for each vertex, and low < high");
  }
}

}  // namespace

Image DrawMesh(const TriangleMesh& mesh, const Camera& camera, const Pose& camera_from_world,
               const MeshPictureOptions& options) {
  CheckPicture(mesh, camera, options);
  const RayScene scene(mesh);
  const Painter painter{mesh, options, std::sqrt(camera.fx * camera.fy)};
  const Eigen::Vector3d eye = camera_from_world.Center();
  const Eigen::Matrix3d world_from_camera = camera_from_world.rotation.transpose();
  Image picture(camera.width, camera.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  uint8_t* pixels = picture.Data<uint8_t>();
  // Where the lens folds back: a zero ray meets nothing.
  const Eigen::Vector3d sees_nothing = Eigen::Vector3d::Zero();
  ParallelFor(0, camera.height, [&](int64_t y) {
    for (int x = 0; x < camera.width; ++x) {
      Eigen::Vector3d color = Eigen::Vector3d::Zero();
      for (int sample = 0; sample < 4; ++sample) {
        const Eigen::Vector2d pixel(x - 0.25 + 0.5 * (sample % 2),
                                    static_cast<double>(y) - 0.25 + 0.5 * (sample / 2));
        const Eigen::Vector3d direction =
            world_from_camera * TryUnproject(camera, pixel).value_or(sees_nothing);
        const auto hit = scene.Intersect(eye, direction);
        color += 0.25 * (hit ? painter.Paint(*hit, direction) : Eigen::Vector3d::Ones().eval());
      }
      for (int channel = 0; channel < 3; ++channel) {
        pixels[(y * camera.width + x) * 3 + channel] =
            static_cast<uint8_t>(std::lround(255 * std::clamp(color[channel], 0.0, 1.0)));
      }
    }
  });
  return picture;
}

MeshView ViewMeshFrom(const TriangleMesh& mesh, double azimuth, double elevation, int width,
                      int height) {
  ValidateMesh(mesh, "mesh view");
  Eigen::Vector3d low = mesh.vertices.front(), high = low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const double radius = std::max(0.5 * (high - low).norm(), 1e-6);
  constexpr double kDistanceInRadii = 5;
  MeshView view;
  view.camera.width = width;
  view.camera.height = height;
  view.camera.cx = 0.5 * (width - 1);
  view.camera.cy = 0.5 * (height - 1);
  view.camera.fx = view.camera.fy = 0.48 * std::min(width, height) * (kDistanceInRadii - 0.2);
  const Eigen::Vector3d center = 0.5 * (low + high);
  const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  const bool vertical = std::abs(direction.z()) > 0.999;
  view.camera_from_world =
      LookAt(center + kDistanceInRadii * radius * direction, center,
             vertical ? Eigen::Vector3d(Eigen::Vector3d::UnitY()) : Eigen::Vector3d::UnitZ());
  return view;
}

}  // namespace lfm
