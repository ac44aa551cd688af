// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board.h"

#include <algorithm>
#include <cmath>

#include "calib/tag_family.h"
#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

// A grid over the plate finer than a tag keeps each lookup to one or two candidates.
constexpr int kGridCellsPerTag = 3;
constexpr int kMaxGridCells = 1024;

}  // namespace

std::array<Eigen::Vector3d, 4> Board::TagCorners(const BoardTag& tag) const {
  const double h = tag_size_mm / 2;
  const double c = std::cos(tag.rotation), s = std::sin(tag.rotation);
  const std::array<Eigen::Vector2d, 4> upright = {Eigen::Vector2d(-h, h), Eigen::Vector2d(h, h),
                                                  Eigen::Vector2d(h, -h), Eigen::Vector2d(-h, -h)};
  std::array<Eigen::Vector3d, 4> corners;
  for (int i = 0; i < 4; ++i) {
    corners[i] = {tag.center_mm.x() + c * upright[i].x() - s * upright[i].y(),
                  tag.center_mm.y() + s * upright[i].x() + c * upright[i].y(), 0.0};
  }
  return corners;
}

std::vector<Eigen::Vector3d> Board::CheckerCorners() const {
  std::vector<Eigen::Vector3d> corners;
  for (int row = 1; row < checker_rows; ++row) {
    for (int column = 1; column < checker_columns; ++column) {
      corners.emplace_back((column - checker_columns / 2.0) * checker_square_mm,
                           (row - checker_rows / 2.0) * checker_square_mm, 0.0);
    }
  }
  return corners;
}

Board DefaultBoard() {
  constexpr int kTagsPerSide = 7;
  constexpr double kPitchMm = 31;
  Board board;
  board.name = "platform-220";
  board.width_mm = board.height_mm = 220;
  board.tag_size_mm = 24;
  board.checker_columns = board.checker_rows = 10;
  board.checker_square_mm = 15;
  for (int row = kTagsPerSide - 1; row >= 0; --row) {
    for (int column = 0; column < kTagsPerSide; ++column) {
      const bool on_border =
          row == 0 || row == kTagsPerSide - 1 || column == 0 || column == kTagsPerSide - 1;
      if (!on_border) continue;
      BoardTag tag;
      tag.id = static_cast<int>(board.tags.size());
      tag.center_mm = {(column - kTagsPerSide / 2) * kPitchMm, (row - kTagsPerSide / 2) * kPitchMm};
      board.tags.push_back(tag);
    }
  }
  return board;
}

BoardPrint::BoardPrint(const Board& board) : board_(board) {
  ValidateBoard(board, board.name.empty() ? "board" : board.name);
  const TagFamily family(board.family, board.name);
  cells_per_black_square_ = family.cells_per_black_square();
  cells_per_mm_ = cells_per_black_square_ / board.tag_size_mm;
  const double longest = std::max(board.width_mm, board.height_mm);
  grid_per_mm_ = std::min(kGridCellsPerTag / board.tag_size_mm, kMaxGridCells / longest);
  grid_columns_ = static_cast<int>(board.width_mm * grid_per_mm_) + 1;
  grid_rows_ = static_cast<int>(board.height_mm * grid_per_mm_) + 1;

  std::vector<std::vector<int>> tags_of_cell(static_cast<size_t>(grid_columns_) * grid_rows_);
  for (const BoardTag& tag : board.tags) {
    PlacedTag placed;
    placed.center_mm = tag.center_mm;
    placed.x_axis = {std::cos(tag.rotation), std::sin(tag.rotation)};
    placed.cells = family.Cells(tag.id);
    const double reach =
        board.tag_size_mm / 2 * (std::abs(placed.x_axis.x()) + std::abs(placed.x_axis.y()));
    const auto grid_index = [&](double mm, double extent_mm, int count) {
      return std::clamp(static_cast<int>((mm + extent_mm / 2) * grid_per_mm_), 0, count - 1);
    };
    const int x0 = grid_index(tag.center_mm.x() - reach, board.width_mm, grid_columns_);
    const int x1 = grid_index(tag.center_mm.x() + reach, board.width_mm, grid_columns_);
    const int y0 = grid_index(tag.center_mm.y() - reach, board.height_mm, grid_rows_);
    const int y1 = grid_index(tag.center_mm.y() + reach, board.height_mm, grid_rows_);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        tags_of_cell[static_cast<size_t>(y) * grid_columns_ + x].push_back(
            static_cast<int>(tags_.size()));
      }
    }
    tags_.push_back(std::move(placed));
  }
  grid_offsets_.push_back(0);
  for (const std::vector<int>& tags : tags_of_cell) {
    grid_tags_.insert(grid_tags_.end(), tags.begin(), tags.end());
    grid_offsets_.push_back(static_cast<int>(grid_tags_.size()));
  }
}

bool BoardPrint::InkOfTag(const PlacedTag& tag, const Eigen::Vector2d& point_mm) const {
  const Eigen::Vector2d d = point_mm - tag.center_mm;
  const double half = board_.tag_size_mm / 2;
  const double right = d.x() * tag.x_axis.x() + d.y() * tag.x_axis.y();
  const double up = d.y() * tag.x_axis.x() - d.x() * tag.x_axis.y();
  if (std::abs(right) > half || std::abs(up) > half) return false;
  const int last = cells_per_black_square_ - 1;
  const int column = std::min(static_cast<int>((right + half) * cells_per_mm_), last);
  const int row = std::min(static_cast<int>((half - up) * cells_per_mm_), last);
  return tag.cells[static_cast<size_t>(row) * cells_per_black_square_ + column] == 0;
}

bool BoardPrint::InkOfChecker(const Eigen::Vector2d& point_mm) const {
  if (board_.checker_columns == 0) return false;
  const double x = point_mm.x() / board_.checker_square_mm + board_.checker_columns / 2.0;
  const double y = point_mm.y() / board_.checker_square_mm + board_.checker_rows / 2.0;
  if (x < 0 || y < 0 || x >= board_.checker_columns || y >= board_.checker_rows) return false;
  return (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
}

double BoardPrint::Value(const Eigen::Vector2d& point_mm) const {
  const double x = point_mm.x() + board_.width_mm / 2, y = point_mm.y() + board_.height_mm / 2;
  // Written so that NaN falls outside.
  if (!(x >= 0 && y >= 0 && x <= board_.width_mm && y <= board_.height_mm)) return -1;
  const int column = static_cast<int>(x * grid_per_mm_), row = static_cast<int>(y * grid_per_mm_);
  const size_t cell = static_cast<size_t>(std::min(row, grid_rows_ - 1)) * grid_columns_ +
                      std::min(column, grid_columns_ - 1);
  for (int i = grid_offsets_[cell]; i < grid_offsets_[cell + 1]; ++i) {
    if (InkOfTag(tags_[grid_tags_[i]], point_mm)) return 0;
  }
  return InkOfChecker(point_mm) ? 0 : 1;
}

Image DrawBoard(const Board& board, double pixels_per_mm) {
  if (!(pixels_per_mm >= 0.1 && pixels_per_mm <= 100)) {
    throw Error("drawing a board: " + std::to_string(pixels_per_mm) +
                " pixels per mm; use 0.1 to 100");
  }
  constexpr int kSubsamples = 8;
  const BoardPrint print(board);
  const int width = std::max(1, static_cast<int>(std::lround(board.width_mm * pixels_per_mm)));
  const int height = std::max(1, static_cast<int>(std::lround(board.height_mm * pixels_per_mm)));
  Image picture(width, height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  uint8_t* pixels = picture.Data<uint8_t>();
  ParallelFor(0, height, [&](int64_t row) {
    for (int column = 0; column < width; ++column) {
      double paper = 0;
      for (int s = 0; s < kSubsamples * kSubsamples; ++s) {
        const double x = column + (s % kSubsamples + 0.5) / kSubsamples;
        const double y = static_cast<double>(row) + (s / kSubsamples + 0.5) / kSubsamples;
        const Eigen::Vector2d mm((x - width / 2.0) / pixels_per_mm,
                                 (height / 2.0 - y) / pixels_per_mm);
        // The picture may be a fraction of a pixel larger than the plate.
        paper += std::max(0.0, print.Value(mm)) / (kSubsamples * kSubsamples);
      }
      const float coded = SrgbFromLinear(static_cast<float>(paper));
      pixels[row * width + column] =
          static_cast<uint8_t>(std::lround(std::clamp(coded, 0.0f, 1.0f) * 255));
    }
  });
  return picture;
}

}  // namespace lfm
