// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"

namespace lfm {

/// One tag seen in a picture.
struct TagDetection {
  int id = 0;
  /// The detected square's corners (`Board`) in the order of `Board::TagCorners`: top-left,
  /// top-right, bottom-right, bottom-left of the tag as printed. Pixels, centre of the top-left
  /// pixel (0, 0).
  std::array<Eigen::Vector2d, 4> corners;
};

/// Finds tags with libapriltag (Wang and Olson, "AprilTag 2", 2016). The library's pixel centres at
/// .5 and its corner order are converted here.
///
/// Corners are good to about half a pixel: the library works on coded values, in which white bleeds
/// into black. Tags with a border of two cells, which Kalibr prints with their corners touching,
/// are searched in a picture of twice the size with those parted. One object serves one thread at a
/// time; making one takes some tens of milliseconds.
class TagDetector {
 public:
  /// Throws Error when the family is unknown or has no such border.
  explicit TagDetector(const std::string& family, int border_cells = 1);
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  /// Tags in `picture` (any type; sRGB-coded luminance is searched), by id and then by position; an
  /// id may appear more than once when the picture shows it more than once. Empty when there is
  /// none, or the picture is smaller than 16 pixels a side.
  std::vector<TagDetection> Detect(const Image& picture);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
