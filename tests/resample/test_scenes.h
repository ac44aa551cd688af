// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/camera.h"
#include "core/capture.h"
#include "core/pose.h"
#include "core/triangle_mesh.h"

namespace lfm::test {

/// A sphere of 20 * 4^subdivisions triangles around `center`, vertices on it, normals outwards.
TriangleMesh Sphere(const Eigen::Vector3d& center, double radius, int subdivisions);
/// A torus around the z axis of 2 * around * across triangles.
TriangleMesh Torus(double ring_radius, double tube_radius, int around, int across);
/// Two meshes as one.
TriangleMesh Join(const TriangleMesh& a, const TriangleMesh& b);

/// A camera with a little distortion and the principal point off the middle.
Camera TestCamera(int width, int height, double focal_px);
/// Poses of cameras that look at the origin from `distance` mm, spread over the upper hemisphere
/// between 15 and 80 degrees elevation.
std::vector<Pose> PosesAround(int count, double distance);

/// sRGB-coded colour, [0, 1], that a surface point shows to the eye.
using ColorOf = std::function<Eigen::Vector3d(const Eigen::Vector3d& point)>;
/// A photograph: `samples` squared rays a pixel averaged in sRGB-coded values, rounded to 8 bits.
Image RenderPhoto(const TriangleMesh& mesh, const Camera& camera, const Pose& camera_from_world,
                  const ColorOf& color, const Eigen::Vector3d& background, int samples);

/// A capture that lives in memory.
struct MemoryCapture {
  Capture capture;
  CalibResult calib;
  std::map<std::string, Image> pictures;

  ImageLoader Loader() const;
};
/// Photographs of `mesh` from `poses`; every one is train.
MemoryCapture MakeCapture(const TriangleMesh& mesh, const Camera& camera,
                          const std::vector<Pose>& poses, const ColorOf& color,
                          const Eigen::Vector3d& background, int samples);

/// A fresh folder for a test's files.
std::filesystem::path TestFolder(const std::string& name);

}  // namespace lfm::test
