// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "fields/field_reading.h"

namespace lfm {

/// Which pixels of a picture become points, and how.
struct PictureWindow {
  int picture_width = 0, picture_height = 0;
  int left = 0, top = 0;
  int reduce = 1;                     ///< pixels a side of a point's block
  int width = 0, height = 0;          ///< points
  std::vector<uint8_t> pixel_counts;  ///< a pixel of the whole picture; empty: all count
  std::vector<uint8_t> point_counts;  ///< a point; empty: all count

  int64_t points() const { return int64_t{width} * height; }
};

/// Throws Error, `name` in front, when the options leave no point of a picture of this size.
PictureWindow MakeWindow(int picture_width, int picture_height, const FieldReadOptions& options,
                         const std::string& name);
/// The window with a mask picture: half of white and above counts. Throws Error, `name` in front,
/// when it is of another size, or when no point is left.
PictureWindow WithMask(PictureWindow window, const Image& mask, const std::string& name);
/// The camera of the points.
Camera CameraOfWindow(const Camera& camera, const PictureWindow& window);

/// What one picture says of all points.
struct PictureColumn {
  int channels = 1;
  std::vector<float> values;  ///< channel * points + point; linear, >= 0
  int64_t negative = 0;       ///< values that were set to zero
};

/// The colours of `picture` divided by `intensity` (1 or 3 positive numbers; 3 for gray: their Rec.
/// 709 luminance), averaged over the pixels of each block that count, in float64. Throws Error,
/// `name` in front, when the picture is not of the window's size or a number that counts is not
/// finite.
PictureColumn ReadColumn(const Image& picture, const std::optional<Eigen::Vector3d>& intensity,
                         const PictureWindow& window, const std::string& name);

}  // namespace lfm
