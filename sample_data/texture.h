// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>

#include "sample_data/material.h"
#include "sample_data/scene_description.h"

namespace lfm {

/// Where a texture's coordinates come from on one object: its bounds, for the projections, and the
/// size (mm) that the square [0, 1]^2 stands for, so that procedures have features of `scale_mm`.
struct TextureFrame {
  Eigen::AlignedBox3d bounds;
  Eigen::Vector2d size_mm = {100, 100};
};
/// kPlanar: the bounds seen from above (u along x, v along y). kCylinder: azimuth round the bounds'
/// vertical axis and height. kSphere: azimuth and polar angle from the top. kUv: the object's
/// largest extent for either side of the square.
TextureFrame MakeTextureFrame(const SceneObject& object);

/// Coordinates in [0, 1]^2 of a point by the mapping; `uv` is handed through for kUv, and clamped
/// projections never leave the square. (0, 0) for kSolid.
Eigen::Vector2d TextureCoordinates(TextureMapping mapping, const TextureFrame& frame,
                                   const Eigen::Vector3d& point, const Eigen::Vector2d& uv);

/// The texture's value, linear RGB. kChecker and kStripes switch between the two colours every
/// `scale_mm`; kNoise and kMarble blend them by gradient noise (sample_data/paint.h) of that scale,
/// kMarble as thin veins of `color_b` in `color_a`; kImage is the picture, bilinear, repeated
/// outside [0, 1]^2, its first row at v = 1. kNone and a missing image are white.
/// The procedures read solid space (mm) for kSolid, else the square times `frame.size_mm`.
Eigen::Vector3f TextureValue(const Texture& texture, const TextureFrame& frame,
                             const Eigen::Vector3d& point, const Eigen::Vector2d& uv);

/// The material of `object` at barycentric (u, v) of a triangle: its paint, interpolated between
/// the corners, where it has one (kind kPaint); else its material, coloured by its texture as
/// TextureKind says.
Material ResolveMaterial(const SceneObject& object, const TextureFrame& frame, int triangle,
                         float u, float v, const Eigen::Vector3f& point);

/// A picture for `Texture::image`: linear RGB in [0, 1], gray spread over the channels, alpha left
/// out. 8-bit and 16-bit files are taken as sRGB. Throws Error (file) for what is no picture, and
/// for values outside [0, 1] or not finite.
Image ReadTextureImage(const std::filesystem::path& file);

/// Throws Error, naming the object, when material or texture cannot be used: a material out of
/// range, a scale that is not positive, colours outside [0, 1] (10 for pictures), an image that is
/// missing, not float RGB or not finite, `uv` or `paint` of another length than the vertices.
void ValidateSurface(const SceneObject& object);

}  // namespace lfm
