// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/photo_split.h"
#include "core/pose.h"

namespace lfm {

/// One picture of a reflectance field: the scene lit by parallel light from one direction.
struct LitPicture {
  std::string file;                      ///< relative to the capture folder
  Eigen::Vector3d to_light = {0, 0, 1};  ///< unit, world frame, towards the light
  PhotoSplit split = PhotoSplit::kTrain;
  /// Irradiance of this light on a surface that faces it (r, g, b), where the lights differ: the
  /// picture divided by it is what a light of unit irradiance shows. Positive.
  std::optional<Eigen::Vector3d> intensity = std::nullopt;
};

/// A scene seen from one fixed place under many light directions (Yamada 2009, Section 2); every
/// picture under the same irradiance on a surface that faces the light, or under its own
/// `intensity`. Without a pose the world is the picture's frame: x right, y up, z to the viewer.
struct ReflectanceField {
  std::string camera;                     ///< key of Capture::cameras
  std::optional<Pose> camera_from_world;  ///< when known
  /// What 16-bit files hold; 8-bit files are sRGB, EXR and HDR linear, whatever stands here.
  ColorEncoding encoding = ColorEncoding::kLinear;
  std::vector<LitPicture> pictures;  ///< at least one; no file twice
  std::string mask;                  ///< relative file, or empty: every pixel counts
};

/// What the rows of a transport matrix are.
enum class TransportKind {
  kImage,  ///< pixels of one fixed view, row by row from the top
  kMesh,   ///< vertices of a mesh, for each view after the other
};

/// A capture's light transport: what every texel of a cube map of light adds to every pixel or
/// vertex (Mahajan 2007). The matrix is a file of core/transport_matrix.h.
struct TransportField {
  std::string file;  ///< relative to the capture folder
  TransportKind kind = TransportKind::kImage;
  int cube_resolution = 32;  ///< texels a side of a cube face
  std::string camera;        ///< kImage: key of Capture::cameras; empty for kMesh
  std::string mesh;          ///< kMesh: the PLY file, relative; empty for kImage
  /// kMesh: where each view's eye stands, mm, world frame; at least one. Empty for kImage.
  std::vector<Eigen::Vector3d> eyes;
};

}  // namespace lfm
