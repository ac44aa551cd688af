// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "calib/board.h"
#include "calib/tag_family.h"
#include "core/error.h"

namespace lfm {
namespace {

// A grid over the plate finer than a tag keeps each exact look-up to one or two candidates.
constexpr int kGridCellsPerTag = 3;
constexpr int kMaxGridCells = 1024;
// 0.2 mm on the usual platform, and small enough for a second-level cache.
constexpr int kRasterCells = 1024;
constexpr int kMaxRasterDistance = 127;

double DistanceToWhole(double x) { return std::abs(x - std::round(x)); }

}  // namespace

struct BoardPrint::Attached {
  BoardPrint print;
  Pose world_from_plate;
};

BoardPrint::BoardPrint(const Board& board) : board_(board) {
  ValidatePrint(board, board.name.empty() ? "board" : board.name);
  PrepareAll();
}

BoardPrint BoardPrint::WithMovedTags(const Board& board) {
  BoardPrint print;
  print.board_ = board;
  print.PrepareAll();
  return print;
}

void BoardPrint::PrepareAll() {
  Prepare();
  for (const AttachedBoard& attached : board_.attached) {
    BoardPrint print;
    print.board_ = attached.board;
    print.Prepare();
    attached_.push_back({std::move(print), attached.world_from_board});
  }
}

BoardPrint::BoardPrint() = default;
BoardPrint::~BoardPrint() = default;
BoardPrint::BoardPrint(const BoardPrint&) = default;
BoardPrint::BoardPrint(BoardPrint&&) noexcept = default;
BoardPrint& BoardPrint::operator=(const BoardPrint&) = default;
BoardPrint& BoardPrint::operator=(BoardPrint&&) noexcept = default;

void BoardPrint::Prepare() {
  const TagFamily family(board_.family, board_.border_cells, board_.name);
  cells_across_ = family.cells_across();
  cell_mm_ = board_.tag_size_mm / family.cells_per_side();
  tag_half_mm_ = cell_mm_ * cells_across_ / 2;
  tags_ = PlaceTags();
  FillGrid();
  FillRaster();
}

std::vector<BoardPrint::PlacedTag> BoardPrint::PlaceTags() const {
  const TagFamily family(board_.family, board_.border_cells, board_.name);
  std::vector<PlacedTag> tags;
  for (const BoardTag& tag : board_.tags) {
    PlacedTag placed;
    placed.center_mm = tag.center_mm;
    placed.x_axis = {std::cos(tag.rotation), std::sin(tag.rotation)};
    placed.cells = family.Cells(tag.id);
    tags.push_back(std::move(placed));
  }
  return tags;
}

void BoardPrint::FillGrid() {
  const double longest = std::max(board_.width_mm, board_.height_mm);
  raster_per_mm_ = kRasterCells / longest;
  grid_per_mm_ = tags_.empty()
                     ? 1 / longest
                     : std::min(kGridCellsPerTag / (2 * tag_half_mm_), kMaxGridCells / longest);
  grid_columns_ = static_cast<int>(board_.width_mm * grid_per_mm_) + 1;
  grid_rows_ = static_cast<int>(board_.height_mm * grid_per_mm_) + 1;
  // Raster cells that only touch a tag must find it too.
  listed_mm_ = std::max(cell_mm_, 1 / raster_per_mm_);
  std::vector<std::vector<int>> tags_of_cell(static_cast<size_t>(grid_columns_) * grid_rows_);
  for (size_t i = 0; i < tags_.size(); ++i) {
    const Eigen::Vector2d& axis = tags_[i].x_axis;
    const double reach = tag_half_mm_ * (std::abs(axis.x()) + std::abs(axis.y())) + listed_mm_;
    const size_t low = GridCell(tags_[i].center_mm - Eigen::Vector2d::Constant(reach));
    const size_t high = GridCell(tags_[i].center_mm + Eigen::Vector2d::Constant(reach));
    const size_t columns = static_cast<size_t>(grid_columns_);
    for (size_t y = low / columns; y <= high / columns; ++y) {
      for (size_t x = low % columns; x <= high % columns; ++x) {
        tags_of_cell[y * columns + x].push_back(static_cast<int>(i));
      }
    }
  }
  grid_offsets_.push_back(0);
  for (const std::vector<int>& tags : tags_of_cell) {
    grid_tags_.insert(grid_tags_.end(), tags.begin(), tags.end());
    grid_offsets_.push_back(static_cast<int>(grid_tags_.size()));
  }
}

void BoardPrint::FillRaster() {
  raster_columns_ = static_cast<int>(board_.width_mm * raster_per_mm_) + 1;
  raster_rows_ = static_cast<int>(board_.height_mm * raster_per_mm_) + 1;
  const int columns = raster_columns_, rows = raster_rows_;
  const double half_diagonal = 0.7072 / raster_per_mm_;
  std::vector<int> distance(static_cast<size_t>(columns) * rows);
  raster_.resize(distance.size());
  const auto center = [&](int x, int y) {
    return Eigen::Vector2d((x + 0.5) / raster_per_mm_ - board_.width_mm / 2,
                           (y + 0.5) / raster_per_mm_ - board_.height_mm / 2);
  };
  // The last row and column may reach beyond the plate.
  const auto beyond_plate = [&](int x, int y) {
    return x + 1 > board_.width_mm * raster_per_mm_ * (1 + 1e-12) ||
           y + 1 > board_.height_mm * raster_per_mm_ * (1 + 1e-12);
  };
  const auto at = [&](int x, int y) {
    const bool inside = x >= 0 && y >= 0 && x < columns && y < rows;
    return inside ? distance[static_cast<size_t>(y) * columns + x] : 0;
  };
  // Two sweeps give the Chebyshev distance to the nearest zero.
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      int& d = distance[static_cast<size_t>(y) * columns + x];
      d = beyond_plate(x, y) || EdgeWithin(center(x, y), half_diagonal)
              ? 0
              : 1 + std::min({at(x - 1, y), at(x - 1, y - 1), at(x, y - 1), at(x + 1, y - 1)});
    }
  }
  for (int y = rows - 1; y >= 0; --y) {
    for (int x = columns - 1; x >= 0; --x) {
      int& d = distance[static_cast<size_t>(y) * columns + x];
      d = std::min(
          {d, 1 + at(x + 1, y), 1 + at(x + 1, y + 1), 1 + at(x, y + 1), 1 + at(x - 1, y + 1)});
      const int clipped = std::min(d, kMaxRasterDistance);
      const bool ink = d > 0 && ExactValue(center(x, y)) == 0;
      raster_[static_cast<size_t>(y) * columns + x] = static_cast<int8_t>(ink ? -clipped : clipped);
    }
  }
}

bool BoardPrint::EdgeWithin(const Eigen::Vector2d& point_mm, double radius_mm) const {
  const size_t cell = GridCell(point_mm);
  const double half = tag_half_mm_;
  const double tag_cell = cell_mm_;
  for (int i = grid_offsets_[cell]; i < grid_offsets_[cell + 1]; ++i) {
    const PlacedTag& tag = tags_[grid_tags_[i]];
    const Eigen::Vector2d d = point_mm - tag.center_mm;
    const double right = d.dot(tag.x_axis);
    const double up = d.y() * tag.x_axis.x() - d.x() * tag.x_axis.y();
    if (std::max(std::abs(right), std::abs(up)) > half + radius_mm) continue;
    if (DistanceToWhole((right + half) / tag_cell) * tag_cell <= radius_mm) return true;
    if (DistanceToWhole((up + half) / tag_cell) * tag_cell <= radius_mm) return true;
  }
  // All of a circle counts as edge: it has no single value.
  if (CircleAt(point_mm, radius_mm) != nullptr) return true;
  for (const BoardSquare& s : board_.squares) {
    const Eigen::Array2d d = (point_mm - s.center_mm).array().abs() - s.size_mm / 2;
    if (d.maxCoeff() <= radius_mm && d.maxCoeff() >= -radius_mm) return true;
  }
  if (board_.checker_columns == 0) return false;
  const double square = board_.checker_square_mm;
  const double x = point_mm.x() + board_.checker_columns * square / 2;
  const double y = point_mm.y() + board_.checker_rows * square / 2;
  if (x < -radius_mm || x > board_.checker_columns * square + radius_mm) return false;
  if (y < -radius_mm || y > board_.checker_rows * square + radius_mm) return false;
  return DistanceToWhole(x / square) * square <= radius_mm ||
         DistanceToWhole(y / square) * square <= radius_mm;
}

bool BoardPrint::InkOfTag(const PlacedTag& tag, const Eigen::Vector2d& point_mm) const {
  const Eigen::Vector2d d = point_mm - tag.center_mm;
  const double half = tag_half_mm_;
  const double right = d.dot(tag.x_axis);
  const double up = d.y() * tag.x_axis.x() - d.x() * tag.x_axis.y();
  if (std::abs(right) > half || std::abs(up) > half) return false;
  const int last = cells_across_ - 1;
  const int column = std::min(static_cast<int>((right + half) / cell_mm_), last);
  const int row = std::min(static_cast<int>((half - up) / cell_mm_), last);
  return tag.cells[static_cast<size_t>(row) * cells_across_ + column] == 0;
}

bool BoardPrint::InkOfChecker(const Eigen::Vector2d& point_mm) const {
  if (board_.checker_columns == 0) return false;
  const double x = point_mm.x() / board_.checker_square_mm + board_.checker_columns / 2.0;
  const double y = point_mm.y() / board_.checker_square_mm + board_.checker_rows / 2.0;
  if (x < 0 || y < 0 || x >= board_.checker_columns || y >= board_.checker_rows) return false;
  return (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
}

size_t BoardPrint::GridCell(const Eigen::Vector2d& point_mm) const {
  const double x = (point_mm.x() + board_.width_mm / 2) * grid_per_mm_;
  const double y = (point_mm.y() + board_.height_mm / 2) * grid_per_mm_;
  const int column = std::clamp(static_cast<int>(x), 0, grid_columns_ - 1);
  const int row = std::clamp(static_cast<int>(y), 0, grid_rows_ - 1);
  return static_cast<size_t>(row) * grid_columns_ + column;
}

double BoardPrint::ExactValue(const Eigen::Vector2d& point_mm) const {
  const size_t cell = GridCell(point_mm);
  for (int i = grid_offsets_[cell]; i < grid_offsets_[cell + 1]; ++i) {
    if (InkOfTag(tags_[grid_tags_[i]], point_mm)) return 0;
  }
  if (CircleAt(point_mm, 0) != nullptr) return -1;
  for (const BoardSquare& s : board_.squares) {
    if ((point_mm - s.center_mm).cwiseAbs().maxCoeff() <= s.size_mm / 2) return 0;
  }
  return InkOfChecker(point_mm) ? 0 : 1;
}

const BoardCircle* BoardPrint::CircleAt(const Eigen::Vector2d& point_mm, double margin_mm) const {
  for (const BoardCircle& circle : board_.circles) {
    if ((point_mm - circle.center_mm).norm() <= circle.diameter_mm / 2 + margin_mm) return &circle;
  }
  return nullptr;
}

std::optional<Eigen::Vector3f> BoardPrint::Color(const Eigen::Vector2d& point_mm) const {
  const double value = Value(point_mm);
  if (value >= 0) return Eigen::Vector3f::Constant(static_cast<float>(value));
  const BoardCircle* circle = CircleAt(point_mm, 0);
  if (circle == nullptr) return std::nullopt;
  return CircleReflectance(circle->color);
}

int BoardPrint::CornersOfPlate() const {
  const int checker =
      board_.checker_columns > 0 ? (board_.checker_columns - 1) * (board_.checker_rows - 1) : 0;
  return 4 * static_cast<int>(board_.tags.size()) + checker;
}

int BoardPrint::Plates() const { return 1 + static_cast<int>(attached_.size()); }

BoardPrint::Plate BoardPrint::PlateAt(int i) const {
  if (i == 0) return {this, Pose(), Pose()};
  if (i < 0 || static_cast<size_t>(i) > attached_.size()) {
    throw Error("a board has no plate " + std::to_string(i), ErrorKind::kSystem);
  }
  const Attached& attached = attached_[static_cast<size_t>(i) - 1];
  return {&attached.print, attached.world_from_plate, attached.world_from_plate.Inverse()};
}

BoardPrint::Plate BoardPrint::PlateOfCorner(int corner) const {
  int rest = corner - CornersOfPlate();
  if (corner >= 0 && rest < 0) return PlateAt(0);
  for (size_t i = 0; i < attached_.size() && corner >= 0; ++i) {
    rest -= attached_[i].print.CornersOfPlate();
    if (rest < 0) return PlateAt(static_cast<int>(i) + 1);
  }
  throw Error("a board has no corner " + std::to_string(corner), ErrorKind::kSystem);
}

double BoardPrint::Value(const Eigen::Vector2d& point_mm) const {
  const double x = point_mm.x() + board_.width_mm / 2, y = point_mm.y() + board_.height_mm / 2;
  // Written so that NaN falls outside.
  if (!(x >= 0 && y >= 0 && x <= board_.width_mm && y <= board_.height_mm)) return -1;
  const int column = static_cast<int>(x * raster_per_mm_);
  const int row = static_cast<int>(y * raster_per_mm_);
  const int distance = raster_[static_cast<size_t>(row) * raster_columns_ + column];
  if (distance != 0) return distance > 0 ? 1 : 0;
  return ExactValue(point_mm);
}

double BoardPrint::MeanValue(const Eigen::Vector2d& center_mm, const Eigen::Matrix2d& slope,
                             std::span<const float> x, std::span<const float> y) const {
  constexpr size_t kAtOnce = 48;
  // Places on the raster in single precision: exact to a ten-thousandth of one of its cells.
  const float left = static_cast<float>((center_mm.x() + board_.width_mm / 2) * raster_per_mm_);
  const float low = static_cast<float>((center_mm.y() + board_.height_mm / 2) * raster_per_mm_);
  const Eigen::Matrix2f step = (slope * raster_per_mm_).cast<float>();
  const float xx = step(0, 0), xy = step(0, 1), yx = step(1, 0), yy = step(1, 1);
  const auto columns = static_cast<float>(raster_columns_);
  const auto rows = static_cast<float>(raster_rows_);
  int paper = 0;
  double on_edges = 0;
  for (size_t begin = 0; begin < x.size(); begin += kAtOnce) {
    const size_t count = std::min(kAtOnce, x.size() - begin);
    std::array<int, kAtOnce> cell;
    std::array<int8_t, kAtOnce> distance;
    int outside = 0;
    for (size_t i = 0; i < count; ++i) {
      const float column = left + xx * x[begin + i] + xy * y[begin + i];
      const float row = low + yx * x[begin + i] + yy * y[begin + i];
      // Written so that NaN falls outside.
      const int in = static_cast<int>(column >= 0) & static_cast<int>(column < columns) &
                     static_cast<int>(row >= 0) & static_cast<int>(row < rows);
      outside |= 1 - in;
      const float safe_column = in != 0 ? column : 0, safe_row = in != 0 ? row : 0;
      cell[i] = static_cast<int>(safe_row) * raster_columns_ + static_cast<int>(safe_column);
    }
    for (size_t i = 0; i < count; ++i) distance[i] = raster_[static_cast<size_t>(cell[i])];
    int edges = 0;
    for (size_t i = 0; i < count; ++i) {
      paper += static_cast<int>(distance[i] > 0);
      edges += static_cast<int>(distance[i] == 0);
    }
    if (edges == 0 && outside == 0) continue;
    for (size_t i = 0; i < count; ++i) {
      if (outside == 0 && distance[i] != 0) continue;
      if (distance[i] > 0) --paper;
      const Eigen::Vector2d offset(x[begin + i], y[begin + i]);
      on_edges += std::max(0.0, Value(center_mm + slope * offset));
    }
  }
  return (paper + on_edges) / static_cast<double>(x.size());
}

double BoardPrint::UniformRadius(const Eigen::Vector2d& point_mm) const {
  const double x = point_mm.x() + board_.width_mm / 2, y = point_mm.y() + board_.height_mm / 2;
  if (!(x >= 0 && y >= 0 && x <= board_.width_mm && y <= board_.height_mm)) return 0;
  const int column = static_cast<int>(x * raster_per_mm_);
  const int row = static_cast<int>(y * raster_per_mm_);
  const int distance = raster_[static_cast<size_t>(row) * raster_columns_ + column];
  return std::max(0, std::abs(distance) - 1) / raster_per_mm_;
}

}  // namespace lfm
