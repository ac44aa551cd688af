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
  /// The points where four checker squares meet, row by row from the lowest y, x ascending. The
  /// square at the lowest x and y is black.
  std::vector<Eigen::Vector3d> CheckerCorners() const;
};

/// The platform of the synthetic studio and of `docs/`: a 220 mm square plate, 24 tag36h11 tags of
/// 24 mm round the border (31 mm apart, white for two cells between them), and inside them 10 x 10
/// checker squares of 15 mm.
Board DefaultBoard();

/// Reads and writes the board's JSON (docs/formats.md). ReadBoard validates; both throw Error on
/// unknown keys, wrong types and whatever ValidateBoard refuses.
Board ReadBoard(const std::filesystem::path& file);
void WriteBoard(const Board& board, const std::filesystem::path& file);

/// Throws Error, naming `where`, when the family is unknown, there is no tag, an id is repeated or
/// outside the family, a size is not positive and finite, a tag comes closer than one of its cells
/// to another tag, the checker or the plate's edge (it would not be detected), or the checker does
/// not fit on the plate or has fewer than two squares along one side only.
void ValidateBoard(const Board& board, const std::string& where);

/// Reflectance of the printed plate at a world point (z = 0): 0 ink, 1 paper; exact geometry,
/// without blur. Points outside the plate give no answer (-1). Tags are upright as libapriltag
/// draws them (OpenCV's drawings of tag36h11 are turned by 180 degrees).
///
/// Made for many millions of look-ups: a raster over the plate answers away from edges, exact
/// geometry on them. Immutable; safe to use from many threads.
class BoardPrint {
 public:
  /// Throws Error when the board is not valid.
  explicit BoardPrint(const Board& board);
  /// A point that is not finite lies outside the plate.
  double Value(const Eigen::Vector2d& point_mm) const;
  /// A radius (mm, often 0, never too large) within which Value is the same all round; 0 outside.
  double UniformRadius(const Eigen::Vector2d& point_mm) const;

 private:
  struct PlacedTag {
    Eigen::Vector2d center_mm, x_axis;  ///< x_axis: the tag's right on the plate, unit
    std::vector<uint8_t> cells;         ///< 1 = white; row 0 at the tag's top
  };
  std::vector<PlacedTag> PlaceTags() const;
  void FillGrid();
  void FillRaster();
  bool EdgeWithin(const Eigen::Vector2d& point_mm, double radius_mm) const;
  double ExactValue(const Eigen::Vector2d& point_mm) const;
  bool InkOfTag(const PlacedTag& tag, const Eigen::Vector2d& point_mm) const;
  bool InkOfChecker(const Eigen::Vector2d& point_mm) const;
  size_t GridCell(const Eigen::Vector2d& point_mm) const;

  Board board_;
  std::vector<PlacedTag> tags_;
  int cells_per_black_square_ = 0;
  /// Grid over the plate, row by row from the lowest y: the tags that reach into each grid cell are
  /// `grid_tags_[grid_offsets_[cell] .. grid_offsets_[cell + 1])`.
  int grid_columns_ = 0, grid_rows_ = 0;
  double grid_per_mm_ = 0;
  std::vector<int> grid_offsets_, grid_tags_;
  /// Raster over the plate: 0 where an edge may pass; else the number of raster cells (Chebyshev)
  /// to the nearest such cell or the plate's border, positive on paper, negative on ink.
  int raster_columns_ = 0, raster_rows_ = 0;
  double raster_per_mm_ = 0;
  std::vector<int8_t> raster_;
};

/// A picture of the print, `pixels_per_mm` fine, 8-bit gray sRGB, y upwards; pixels on an edge get
/// the share of paper under them. Throws Error unless 0.1 <= pixels_per_mm <= 100.
Image DrawBoard(const Board& board, double pixels_per_mm);

}  // namespace lfm
