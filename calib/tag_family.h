// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct apriltag_family;

namespace lfm {

/// A family of AprilTags from libapriltag: those whose data lies inside the black border
/// (tag16h5, tag25h9, tag36h10, tag36h11). Owns the library's object.
class TagFamily {
 public:
  /// Throws Error, naming `where`, when the name is none of the above.
  TagFamily(const std::string& name, const std::string& where);

  int count() const;                   ///< ids are 0 .. count - 1
  int cells_per_black_square() const;  ///< cells along the side of the black square
  /// Cells of one tag's black square, row by row from the top as printed upright; 1 = white.
  std::vector<uint8_t> Cells(int id) const;
  apriltag_family* get() const { return family_.get(); }

 private:
  std::unique_ptr<apriltag_family, void (*)(apriltag_family*)> family_;
};

}  // namespace lfm
