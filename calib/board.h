// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/pose.h"

namespace lfm {

/// One AprilTag printed on the platform.
struct BoardTag {
  int id = 0;
  Eigen::Vector2d center_mm = {0, 0};
  double rotation = 0;  ///< radians, counter-clockwise seen from above (+z)
};

/// Inks that a camera tells apart by hue; CircleReflectance says what they look like.
enum class CircleColor { kRed, kYellow, kGreen, kCyan, kBlue, kMagenta };
inline constexpr int kCircleColors = 6;
/// "red", "yellow", ... as in board.json; the index is the enumerator.
const std::vector<std::string>& CircleColorNames();
/// Linear RGB, 0 to 1, where paper is (1, 1, 1); each component is an 8-bit sRGB level.
Eigen::Vector3f CircleReflectance(CircleColor color);

/// A disc of colour (Chen 2002, section 5.1): a picture's colours say where the corners are.
struct BoardCircle {
  Eigen::Vector2d center_mm = {0, 0};
  double diameter_mm = 0;
  CircleColor color = CircleColor::kRed;
};

/// A black square, upright: Kalibr prints one between the corners of its tags.
struct BoardSquare {
  Eigen::Vector2d center_mm = {0, 0};
  double size_mm = 0;
};

struct AttachedBoard;

/// The printed platform: tags of one family, a grid of checker corners, coloured circles, squares;
/// each kind may be missing. Further plates may stand on or beside it.
///
/// World frame: origin at the platform's centre, x right and y up as printed, z towards the viewer,
/// along the rotation axis. Millimetres. A tag's size is the side of the square that detectors
/// report: its black square, or, in families whose data reaches beyond it (tagStandard41h12,
/// tagStandard52h13, tagCircle21h7, tagCircle49h12, tagCustom48h12), its white one.
struct Board {
  std::string name;
  std::string family = "tag36h11";
  double width_mm = 0, height_mm = 0;  ///< the printed plate
  double tag_size_mm = 0;
  int border_cells = 1;  ///< of a tag's black border; Kalibr prints 2
  std::vector<BoardTag> tags;
  /// Inner checker pattern: `checker_columns` x `checker_rows` squares of `checker_square_mm`,
  /// centred on the origin; 0 squares when there is none. Its corners are where four squares meet.
  int checker_columns = 0, checker_rows = 0;
  double checker_square_mm = 0;
  std::vector<BoardCircle> circles;
  std::vector<BoardSquare> squares;
  /// Plates with a pose of their own; they share `family` and `border_cells`, and have none
  /// attached themselves.
  std::vector<AttachedBoard> attached;

  /// The four corners of a tag's black square in the world (z = 0), in the order top-left,
  /// top-right, bottom-right, bottom-left of the tag as printed upright (rotation 0: its top
  /// points along +y).
  std::array<Eigen::Vector3d, 4> TagCorners(const BoardTag& tag) const;
  /// The points where four checker squares meet, row by row from the lowest y, x ascending. The
  /// square at the lowest x and y is black.
  std::vector<Eigen::Vector3d> CheckerCorners() const;
};

/// A plate of its own on the platform, in a frame of its own (like Board's world).
struct AttachedBoard {
  Board board;
  Pose world_from_board;
};

/// One printed plane of a platform.
struct BoardPlate {
  const Board* board = nullptr;
  Pose world_from_plate;
};
/// The platform's own plate, then those attached; valid as long as `board` is.
std::vector<BoardPlate> PlatesOf(const Board& board);

/// The platform of the synthetic studio and of `docs/`: a 220 mm square plate, 24 tag36h11 tags of
/// 24 mm round the border (31 mm apart, white for two cells between them), and inside them 10 x 10
/// checker squares of 15 mm.
Board DefaultBoard();

/// Reads and writes the board's JSON (docs/formats.md). ReadBoard validates; both throw Error on
/// unknown keys, wrong types and whatever ValidateBoard refuses.
Board ReadBoard(const std::filesystem::path& file);
void WriteBoard(const Board& board, const std::filesystem::path& file);

/// Throws Error, naming `where`, when the family or border is unknown; an id is repeated on any
/// plate or outside the family; a size is not positive and finite; a tag comes so near to another,
/// to the checker, a circle, a square or the plate's edge that it would not be detected (one cell,
/// or touching for families that need no quiet zone); a circle has less than a quarter of its
/// diameter of white paper round it; anything leaves the plate; the checker has fewer than two
/// squares along one side only; there is nothing to recognise the platform by: neither a tag, nor
/// four circles that look different when the plate is turned; an attached plate has neither tag nor
/// checker, or plates attached to it.
void ValidateBoard(const Board& board, const std::string& where);
/// The same for a plate that need not be recognised by itself.
void ValidatePrint(const Board& board, const std::string& where);
/// Throws Error, naming `where`, when a tag or circle is smaller than any camera could read:
/// lengths in metres, most likely.
void RequireReadableMarks(const Board& board, const std::string& where);

/// What a print is near a point: two lines that cross at right angles, and the value in each of the
/// four fields between them. Fields may be alike, so that one line or none is seen.
struct PrintCross {
  Eigen::Vector2d x_axis = {1, 0};     ///< unit; the other axis is a quarter turn to the left
  Eigen::Vector2d offset_mm = {0, 0};  ///< from the point to the crossing, along the axes
  double value[2][2];                  ///< [beyond along x][beyond along y]: 0 ink, 1 paper
};

/// Reflectance of one printed plate at a point of its plane (z = 0): 0 ink, 1 paper; exact
/// geometry, without blur. Points outside the plate, and on circles (whose ink no two printers mix
/// alike), give no answer (-1). Tags are upright as libapriltag draws them (OpenCV's drawings of
/// tag36h11 are turned by 180 degrees). The prints of attached plates come with it.
///
/// Made for many millions of look-ups: a raster over the plate answers away from edges, exact
/// geometry on them. Immutable; safe to use from many threads.
class BoardPrint {
 public:
  /// Throws Error when the board is not valid.
  explicit BoardPrint(const Board& board);
  /// Of a valid board whose tags moved a little: they may come nearer to each other, to squares and
  /// to the edge than print may.
  static BoardPrint WithMovedTags(const Board& board);
  ~BoardPrint();
  BoardPrint(const BoardPrint&);
  BoardPrint(BoardPrint&&) noexcept;
  BoardPrint& operator=(const BoardPrint&);
  BoardPrint& operator=(BoardPrint&&) noexcept;
  /// A point that is not finite lies outside the plate.
  double Value(const Eigen::Vector2d& point_mm) const;
  /// Mean of Value over the points center + slope (x, y), no answer counting as ink. `x` and `y`:
  /// of one size, above 0. Many times faster than point by point.
  double MeanValue(const Eigen::Vector2d& center_mm, const Eigen::Matrix2d& slope,
                   std::span<const float> x, std::span<const float> y) const;
  /// What the print is within `reach_mm` of a point. No answer where it is more than a cross: near
  /// several cells' corners, a circle, the plate's edge, or two tags.
  std::optional<PrintCross> CrossNear(const Eigen::Vector2d& point_mm, double reach_mm) const;
  /// Linear RGB, 0 ink to 1 paper; circles in their colour; no answer outside the plate.
  std::optional<Eigen::Vector3f> Color(const Eigen::Vector2d& point_mm) const;
  /// A radius (mm, often 0, never too large) within which Value is the same all round; 0 outside.
  double UniformRadius(const Eigen::Vector2d& point_mm) const;

  /// The print and the frame of the plate that holds corner `corner` of BoardCorners.
  struct Plate {
    const BoardPrint* print = nullptr;
    Pose world_from_plate, plate_from_world;
  };
  /// Throws Error (kSystem) when there is no such corner.
  Plate PlateOfCorner(int corner) const;
  int Plates() const;  ///< the platform's own and those attached
  /// Plate `i` of PlatesOf; throws Error (kSystem) when there is none.
  Plate PlateAt(int i) const;

 private:
  struct PlacedTag {
    Eigen::Vector2d center_mm, x_axis;  ///< x_axis: the tag's right on the plate, unit
    std::vector<uint8_t> cells;         ///< 1 = white; row 0 at the tag's top
  };
  struct Attached;
  BoardPrint();
  void Prepare();
  void PrepareAll();
  std::vector<PlacedTag> PlaceTags() const;
  void FillGrid();
  void FillRaster();
  struct InkGrid;
  std::optional<InkGrid> OnlyGridNear(const Eigen::Vector2d& point_mm, double reach_mm) const;
  bool EdgeWithin(const Eigen::Vector2d& point_mm, double radius_mm) const;
  double ExactValue(const Eigen::Vector2d& point_mm) const;
  bool InkOfTag(const PlacedTag& tag, const Eigen::Vector2d& point_mm) const;
  bool InkOfChecker(const Eigen::Vector2d& point_mm) const;
  const BoardCircle* CircleAt(const Eigen::Vector2d& point_mm, double margin_mm) const;
  int CornersOfPlate() const;
  size_t GridCell(const Eigen::Vector2d& point_mm) const;

  Board board_;
  std::vector<PlacedTag> tags_;
  std::vector<Attached> attached_;
  int cells_across_ = 0;    ///< of a tag as printed
  double cell_mm_ = 0;      ///< side of a tag's cell
  double tag_half_mm_ = 0;  ///< half the side of a tag as printed
  /// Grid over the plate, row by row from the lowest y: the tags that reach into each grid cell, or
  /// come as near as `listed_mm_` to it, are `grid_tags_[grid_offsets_[cell] .. grid_offsets_[cell
  /// + 1])`.
  int grid_columns_ = 0, grid_rows_ = 0;
  double grid_per_mm_ = 0, listed_mm_ = 0;
  std::vector<int> grid_offsets_, grid_tags_;
  /// Raster over the plate: 0 where an edge may pass; else the number of raster cells (Chebyshev)
  /// to the nearest such cell or the plate's border, positive on paper, negative on ink.
  int raster_columns_ = 0, raster_rows_ = 0;
  double raster_per_mm_ = 0;
  std::vector<int8_t> raster_;
};

/// A picture of the print, `pixels_per_mm` fine, 8-bit sRGB (gray, RGB when there are circles), y
/// upwards; pixels on an edge get the share of paper under them. Attached plates are not in it.
/// Throws Error unless 0.1 <= pixels_per_mm <= 100 and it has at most 500 million pixels.
Image DrawBoard(const Board& board, double pixels_per_mm);

}  // namespace lfm
