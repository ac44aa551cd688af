// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/ray_scene.h"
#include "core/triangle_mesh.h"
#include "resample/imputation.h"
#include "resample/photo_depth.h"
#include "resample/resample.h"

namespace lfm {

/// 8-bit levels (sRGB-coded, 255 = 1) whose linear values are divided by `gain`, a channel: beyond
/// 255 where that brightens them.
std::array<std::array<float, 256>, 3> LevelsWithGain(const Eigen::Vector3d& gain);

/// A photograph as it is sampled: 4 bytes a pixel, rows from the top: red, green, blue (8-bit sRGB)
/// and the pixel's PixelUse.
struct PhotoPixels {
  int width = 0, height = 0;
  std::vector<uint8_t> rgbu;
  const uint8_t* in_file = nullptr;  ///< where they lie instead, mapped: `rgbu` is empty then
  /// The level that a channel's 8-bit value stands for: itself, unless the photograph has a gain.
  std::array<std::array<float, 256>, 3> levels = LevelsWithGain(Eigen::Vector3d::Ones());

  const uint8_t* At(int x, int y) const {
    return (in_file != nullptr ? in_file : rgbu.data()) + 4 * (static_cast<size_t>(y) * width + x);
  }
};

/// Joins a picture and its usable pixels. Gray pictures become RGB, an alpha channel is ignored,
/// other types are brought to 8-bit sRGB. Throws Error naming `file` when the picture's size is not
/// the camera's.
PhotoPixels MakePhotoPixels(const Image& picture, const std::vector<PixelUse>& usable,
                            const Camera& camera, const std::string& file);

/// The four pixels around a position and their bilinear weights.
struct BilinearTap {
  int x = 0, y = 0;      ///< the top-left one; the others are at x + 1, y + 1
  float fx = 0, fy = 0;  ///< [0, 1]: how far towards them
};
/// No answer when a pixel that would be needed lies outside the frame, or the picture is less than
/// two pixels wide or high.
std::optional<BilinearTap> TapAt(int width, int height, const Eigen::Vector2d& pixel);

/// What a photograph says at a position between its pixels.
struct PixelReading {
  PixelUse use = PixelUse::kData;  ///< the least of the pixels that have weight
  std::array<float, 3> level;      ///< RGB: 8-bit levels, bilinear
  std::array<bool, 3> saturated;   ///< a pixel that has weight stands at 255
};
/// No answer outside the frame, as TapAt.
std::optional<PixelReading> ReadBilinear(const PhotoPixels& photo, const Eigen::Vector2d& pixel);

/// The points at which a triangle's patch is sampled, in the order of PatchSampleIndex, world
/// frame. `surface` prepares the dense surface; with SampleOn::kSurface a sample is moved along the
/// interpolated vertex normal of `mesh` (which must have normals) to the nearest crossing with the
/// surface within `max_shift_mm`; without one it stays. Samples on an edge are the same points,
/// bit for bit within rounding, for both triangles.
std::vector<Eigen::Vector3d> PatchPoints(const TriangleMesh& mesh, int triangle, int edge_samples,
                                         SampleOn sample_on, const RayScene& surface,
                                         double max_shift_mm);

/// One view of a patch.
struct SampledView {
  /// 3 a sample (RGB): sRGB-coded radiance times LightField::kOne, bilinear, at most 65535.
  std::vector<uint16_t> values;
  /// As long: a lower bound where a pixel that was used stands at 255 in that channel; missing
  /// where one that was needed is no data.
  std::vector<Knowledge> knowledge;
  int data_samples = 0;    ///< samples that are not missing
  int hidden_samples = 0;  ///< of the missing ones: not in sight, rather than near a depth edge
};
/// Samples a photograph at the projections of `points` (full lens model). A point behind the
/// camera, or of which a needed pixel lies outside the frame or is forbidden, is hidden; what
/// occludes points SampleView does not know.
SampledView SampleView(const PhotoPixels& photo, const Camera& camera,
                       const Pose& camera_from_world, const std::vector<Eigen::Vector3d>& points);
/// A view whose samples are all missing.
SampledView UnknownView(size_t samples);
/// Gives a sample that was missing a reading: missing still when the reading is not data.
void SetSample(SampledView& view, size_t sample, const PixelReading& reading);
/// Makes a sample hidden: missing in all channels, whatever it was.
void HideSample(SampledView& view, size_t sample);

}  // namespace lfm
