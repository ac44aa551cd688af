// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct apriltag_family;

namespace lfm {

/// A family of AprilTags from libapriltag. Owns the library's object.
///
/// The square that the library detects is black with its data inside (tag16h5, tag25h9, tag36h10,
/// tag36h11), or a white one, within black, with data inside and outside (tagCircle21h7,
/// tagCircle49h12, tagCustom48h12, tagStandard41h12, tagStandard52h13).
class TagFamily {
 public:
  /// `border_cells`: width of the black border of families of the first kind: 1, or 2 as Kalibr
  /// prints them. Throws Error, naming `where`, when the name is none of the above or has no such
  /// border.
  TagFamily(const std::string& name, int border_cells, const std::string& where);

  int count() const;           ///< ids are 0 .. count - 1
  int cells_per_side() const;  ///< cells along the side of the detected square
  int cells_across() const;    ///< cells along the side of what is printed
  /// Cells of white paper that a tag needs round what is printed: 1, or 0 for the second kind.
  int quiet_cells() const;
  /// Errors in bits that a detector can correct with a table of at most 100 MB: 2, 1 or 0.
  int correctable_bits() const;
  /// The printed cells of one tag, row by row from the top as printed upright; 1 = white.
  std::vector<uint8_t> Cells(int id) const;
  apriltag_family* get() const { return family_.get(); }

  static const std::vector<std::string>& Names();

 private:
  std::unique_ptr<apriltag_family, void (*)(apriltag_family*)> family_;
};

}  // namespace lfm
