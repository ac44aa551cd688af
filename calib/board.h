// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image.h"

namespace lfm {

/// One AprilTag printed on the platform.
struct BoardTag {
  int id = 0;
  Eigen::Vector2d center_mm = {0, 0};
  double rotation = 0;  ///< radians, counter-clockwise seen from above (+z)
};

/// The printed platform: tags of one family round its border and a grid of checker corners inside.
///
/// World frame: origin at the platform's centre, x right and y up as printed, z towards the viewer,
/// along the rotation axis. Millimetres. A tag's size is the side of its black square.
struct Board {
  std::string name;
  std::string family = "tag36h11";
  double width_mm = 0, height_mm = 0;  ///< the printed plate
  double tag_size_mm = 0;
  std::vector<BoardTag> tags;
  /// Inner checker pattern: `checker_columns` x `checker_rows` squares of `checker_square_mm`,
  /// centred on the origin; 0 squares when there is none. Its corners are where four squares meet.
  int checker_columns = 0, checker_rows = 0;
  double checker_square_mm = 0;

  /// The four corners of a tag's black square in the world (z = 0), in the order top-left,
  /// top-right, bottom-right, bottom-left of the tag as printed upright (rotation 0: its top
  /// points along +y).
  std::array<Eigen::Vector3d, 4> TagCorners(const BoardTag& tag) const;
  /// Inner checker corners, row by row from the lowest y, x ascending.
  std::vector<Eigen::Vector3d> CheckerCorners() const;
};

/// The platform of the synthetic studio and of `docs/`: a 220 mm square plate, tag36h11 tags of
/// 24 mm round the border, a checker grid inside.
Board DefaultBoard();

/// Reads and writes the board's JSON (docs/formats.md). Throws Error on unknown keys, tags that
/// overlap each other, the checker or the plate's edge, repeated ids, ids outside the family,
/// sizes that are not positive.
Board ReadBoard(const std::filesystem::path& file);
void WriteBoard(const Board& board, const std::filesystem::path& file);
void ValidateBoard(const Board& board, const std::string& where);

/// Reflectance of the printed plate at a world point (z = 0): 0 ink, 1 paper; exact geometry,
/// without blur. Points outside the plate give no answer (-1).
class BoardPrint {
 public:
  explicit BoardPrint(const Board& board);
  double Value(const Eigen::Vector2d& point_mm) const;

 private:
  Board board_;
  std::vector<std::vector<uint8_t>> tag_cells_;  ///< 1 = white; row 0 at the tag's top
  int cells_per_side_ = 0;
  int cells_per_black_square_ = 0;
};

/// A picture of the print, `pixels_per_mm` fine, 8-bit gray.
Image DrawBoard(const Board& board, double pixels_per_mm);

}  // namespace lfm
