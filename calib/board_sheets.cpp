// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_sheets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "calib/board_ink.h"
#include "core/error.h"

namespace lfm {
namespace {

using V2 = Eigen::Vector2d;

// Room for a ruler and its figures: below with the caption, and at the left.
constexpr double kFooterMm = 18, kSideMm = 12;
constexpr double kLeastTileMm = 20;
constexpr int kMaxSheets = 400;
constexpr double kMaxRulerMm = 200;
constexpr double kMarkGapMm = 1, kMarkMm = 3;
constexpr double kTextMm = 2;
constexpr VectorColor kBlack = {0, 0, 0}, kGray = {150, 150, 150};
constexpr Paper kAutomatic[] = {Paper::kA4, Paper::kA3, Paper::kA2, Paper::kA1, Paper::kA0};

V2 PaperSize(Paper paper, const SheetOptions& options) {
  switch (paper) {
    case Paper::kAuto:
    case Paper::kA4:
      return {210, 297};
    case Paper::kA3:
      return {297, 420};
    case Paper::kA2:
      return {420, 594};
    case Paper::kA1:
      return {594, 841};
    case Paper::kA0:
      return {841, 1189};
    case Paper::kLetter:
      return {215.9, 279.4};
    case Paper::kTabloid:
      return {279.4, 431.8};
    case Paper::kCustom:
      break;
  }
  return {options.paper_width_mm, options.paper_height_mm};
}

// How a plate is spread over sheets of one size.
struct Tiling {
  V2 paper = {0, 0};
  V2 area = {0, 0};  // for the plate on each sheet
  int columns = 0, rows = 0;
  int Sheets() const { return columns * rows; }
};

// Sheets along one side; 0 when nothing fits.
int CountAlong(double length, double area, double overlap) {
  if (length <= area) return 1;
  if (area <= overlap + kLeastTileMm) return 0;
  const double count = std::ceil((length - overlap) / (area - overlap));
  return count > kMaxSheets ? 0 : static_cast<int>(count);
}

Tiling TileOn(const V2& paper, const Board& board, const SheetOptions& options) {
  Tiling tiling;
  tiling.paper = paper;
  tiling.area = {paper.x() - 2 * options.margin_mm - kSideMm,
                 paper.y() - 2 * options.margin_mm - kFooterMm};
  if (tiling.area.minCoeff() < kLeastTileMm) return tiling;
  tiling.columns = CountAlong(board.width_mm, tiling.area.x(), options.overlap_mm);
  tiling.rows = CountAlong(board.height_mm, tiling.area.y(), options.overlap_mm);
  return tiling;
}

// Upright or turned: what takes fewer sheets.
Tiling TileOnEitherWay(Paper paper, const Board& board, const SheetOptions& options) {
  const V2 size = PaperSize(paper, options);
  const Tiling upright = TileOn(size, board, options);
  const Tiling turned = TileOn(size.reverse(), board, options);
  if (upright.Sheets() == 0) return turned;
  return turned.Sheets() > 0 && turned.Sheets() < upright.Sheets() ? turned : upright;
}

Tiling ChooseTiling(const Board& board, const SheetOptions& options) {
  Tiling tiling;
  if (options.paper == Paper::kAuto) {
    for (const Paper paper : kAutomatic) {
      tiling = TileOnEitherWay(paper, board, options);
      if (tiling.Sheets() == 1) break;
    }
  } else {
    tiling = TileOnEitherWay(options.paper, board, options);
  }
  if (tiling.Sheets() < 1 || tiling.Sheets() > kMaxSheets) {
    throw Error(
        "paper: the margins leave too little of the sheet, or the board needs more than "
        "400 sheets; use larger paper or smaller margins");
  }
  return tiling;
}

std::string Millimetres(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", mm);
  return text;
}

// A ruler from `origin` along the unit vector `along`, ticks towards `ticks`.
void DrawRuler(VectorGroup& group, const V2& origin, const V2& along, const V2& ticks,
               double length) {
  const auto line = [&](const V2& a, const V2& b) {
    group.shapes.emplace_back(StrokedLine{{a, b}, 0.1, kBlack});
  };
  line(origin, origin + length * along);
  for (int mm = 0; mm <= static_cast<int>(length); ++mm) {
    const double tick = mm % 10 == 0 ? 3 : mm % 5 == 0 ? 2 : 1.2;
    const V2 at = origin + mm * along;
    line(at, at + tick * ticks);
    if (mm % (length > 100 ? 20 : 10) != 0) continue;
    const std::string text = std::to_string(mm);
    const double width = TextWidth(text, kTextMm * 0.8);
    const V2 middle = at + 4.2 * ticks;
    const V2 corner = std::abs(along.x()) > 0.5
                          ? V2(middle.x() - width / 2, middle.y() - kTextMm * 0.8)
                          : V2(middle.x() - width, middle.y() - kTextMm * 0.4);
    for (VectorShape& shape : TextLines(text, corner, kTextMm * 0.8, kBlack)) {
      group.shapes.push_back(std::move(shape));
    }
  }
}

double RulerLength(double room) { return std::min(kMaxRulerMm, std::floor((room - 4) / 10) * 10); }

// Two short lines outside each corner of a rectangle, in line with its sides.
void DrawCornerMarks(VectorGroup& group, const Eigen::AlignedBox2d& box) {
  for (const int sx : {-1, 1}) {
    for (const int sy : {-1, 1}) {
      const V2 corner(sx < 0 ? box.min().x() : box.max().x(),
                      sy < 0 ? box.min().y() : box.max().y());
      for (const V2& way : {V2(sx, 0), V2(0, sy)}) {
        group.shapes.emplace_back(StrokedLine{
            {corner + kMarkGapMm * way, corner + (kMarkGapMm + kMarkMm) * way}, 0.1, kGray});
      }
    }
  }
}

std::string Caption(const Board& board, double ruler_x, double ruler_y, int sheet,
                    const Tiling& tiling) {
  std::string text = board.name + "  " + Millimetres(board.width_mm) + " x " +
                     Millimetres(board.height_mm) + " mm. Print at 100 %: rulers " +
                     Millimetres(ruler_x) + " and " + Millimetres(ruler_y) + " mm.";
  if (tiling.Sheets() > 1) {
    text += " Sheet " + std::to_string(sheet / tiling.columns + 1) + "-" +
            std::to_string(sheet % tiling.columns + 1) + " of " + std::to_string(tiling.rows) +
            " x " + std::to_string(tiling.columns) + ".";
  }
  return text;
}

VectorPage MakeSheet(const Board& board, const std::vector<VectorShape>& ink, const Tiling& tiling,
                     int sheet, const SheetOptions& options) {
  const int column = sheet % tiling.columns, row = sheet / tiling.columns;
  const V2 corner(options.margin_mm + kSideMm, options.margin_mm + kFooterMm);
  const V2 plate(board.width_mm, board.height_mm);
  const Eigen::AlignedBox2d area(corner, corner + tiling.area);
  // The plate's lower left corner on this sheet: centred along sides that need one sheet only.
  V2 origin = corner + (tiling.area - plate) / 2;
  const V2 step = tiling.area - V2::Constant(options.overlap_mm);
  if (tiling.columns > 1) origin.x() = corner.x() - column * step.x();
  if (tiling.rows > 1) origin.y() = area.max().y() - plate.y() + row * step.y();

  VectorPage page;
  page.width_mm = tiling.paper.x();
  page.height_mm = tiling.paper.y();
  VectorGroup print;
  if (tiling.Sheets() > 1) print.clip = area;
  for (const VectorShape& shape : ink) {
    VectorShape moved = Moved(shape, origin + plate / 2);
    if (!BoundsOf(moved).intersects(area)) continue;
    print.shapes.push_back(std::move(moved));
  }

  VectorGroup marks;
  const Eigen::AlignedBox2d whole(origin, origin + plate);
  Eigen::AlignedBox2d cut = whole;
  const double half = options.overlap_mm / 2;
  if (column > 0) cut.min().x() = area.min().x() + half;
  if (column + 1 < tiling.columns) cut.max().x() = area.max().x() - half;
  if (row > 0) cut.max().y() = area.max().y() - half;
  if (row + 1 < tiling.rows) cut.min().y() = area.min().y() + half;
  // In line with the cuts, on what is cut away.
  DrawCornerMarks(marks, cut);
  const double ruler_x = RulerLength(tiling.area.x()), ruler_y = RulerLength(tiling.area.y());
  DrawRuler(marks, {corner.x(), options.margin_mm + 12}, {1, 0}, {0, -1}, ruler_x);
  DrawRuler(marks, {options.margin_mm + 7, corner.y()}, {0, 1}, {-1, 0}, ruler_y);
  const std::string caption = Caption(board, ruler_x, ruler_y, sheet, tiling);
  const double room = tiling.paper.x() - 2 * options.margin_mm;
  const double text = std::min(kTextMm, kTextMm * room / TextWidth(caption, kTextMm));
  for (VectorShape& shape :
       TextLines(caption, {options.margin_mm, options.margin_mm + 1}, text, kBlack)) {
    marks.shapes.push_back(std::move(shape));
  }
  page.groups = {std::move(print), std::move(marks)};
  return page;
}

}  // namespace

std::vector<VectorPage> LayOutSheets(const Board& board, const SheetOptions& options) {
  SheetOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  const std::vector<VectorShape> ink = BoardInk(board);
  const Tiling tiling = ChooseTiling(board, options);
  std::vector<VectorPage> pages;
  for (int sheet = 0; sheet < tiling.Sheets(); ++sheet) {
    pages.push_back(MakeSheet(board, ink, tiling, sheet, options));
  }
  return pages;
}

}  // namespace lfm
