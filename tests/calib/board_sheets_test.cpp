// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_sheets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include "calib/board_design.h"
#include "calib/board_ink.h"
#include "calib/tag_detection.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using V2 = Eigen::Vector2d;

constexpr double kFile_abs = 2e-5;  // mm; files hold five digits

struct MeasuredPath {
  std::vector<V2> points;  // mm from the page's lower left
};

// All numbers of an attribute or operand list.
std::vector<double> Numbers(const std::string& text) {
  static const std::regex number("-?[0-9]+\\.?[0-9]*");
  std::vector<double> values;
  for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it) {
    values.push_back(std::stod(it->str()));
  }
  return values;
}

std::vector<V2> Pairs(const std::vector<double>& numbers) {
  std::vector<V2> points;
  for (size_t i = 0; i + 1 < numbers.size(); i += 2)
    points.emplace_back(numbers[i], numbers[i + 1]);
  return points;
}

// The filled paths of a PDF's first page in mm, through its own matrix and media box.
std::vector<MeasuredPath> FilledPathsOfPdf(const std::string& pdf, V2& page_mm) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(pdf, found, std::regex("/MediaBox \\[([^\\]]*)\\]")));
  const std::vector<double> box = Numbers(found[1]);
  page_mm = V2(box.at(2) - box.at(0), box.at(3) - box.at(1)) * 25.4 / 72;
  const size_t begin = pdf.find("stream\n") + 7;
  std::istringstream lines(pdf.substr(begin, pdf.find("endstream", begin) - begin));
  std::string line;
  std::getline(lines, line);
  const double points_per_unit = Numbers(line).at(0);
  EXPECT_TRUE(line.ends_with(" cm"));
  std::vector<MeasuredPath> paths;
  while (std::getline(lines, line)) {
    if (!line.ends_with("f*")) continue;
    MeasuredPath path;
    for (const V2& p : Pairs(Numbers(line))) path.points.push_back(p * points_per_unit * 25.4 / 72);
    paths.push_back(path);
  }
  return paths;
}

std::vector<MeasuredPath> FilledPathsOfSvg(const std::string& svg, V2& page_mm) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(
      svg, found,
      std::regex(
          "width=\"([0-9.]+)mm\" height=\"([0-9.]+)mm\" viewBox=\"0 0 ([0-9.]+) ([0-9.]+)")));
  page_mm = {std::stod(found[1]), std::stod(found[2])};
  const V2 units(std::stod(found[3]), std::stod(found[4]));
  std::vector<MeasuredPath> paths;
  static const std::regex filled("<path fill-rule=\"evenodd\"[^>]* d=\"([^\"]*)\"");
  for (std::sregex_iterator it(svg.begin(), svg.end(), filled), end; it != end; ++it) {
    MeasuredPath path;
    for (const V2& p : Pairs(Numbers((*it)[1]))) {
      path.points.emplace_back(p.x() * page_mm.x() / units.x(),
                               page_mm.y() - p.y() * page_mm.y() / units.y());
    }
    paths.push_back(path);
  }
  return paths;
}

// Every tag's black square and every checker square has its size, and they stand as far apart as on
// the board.
void ExpectTrueScale(const Board& board, const std::vector<MeasuredPath>& paths) {
  const size_t checker = static_cast<size_t>(board.checker_columns) * board.checker_rows / 2;
  ASSERT_EQ(paths.size(), board.tags.size() + checker);
  V2 shift(0, 0);
  for (size_t i = 0; i < board.tags.size(); ++i) {
    Eigen::AlignedBox2d box;
    for (const V2& p : paths[i].points) box.extend(p);
    EXPECT_NEAR(box.sizes().x(), board.tag_size_mm, kFile_abs);
    EXPECT_NEAR(box.sizes().y(), board.tag_size_mm, kFile_abs);
    if (i == 0) shift = box.center() - board.tags[0].center_mm;
    EXPECT_LT((box.center() - board.tags[i].center_mm - shift).norm(), kFile_abs);
  }
  for (size_t i = board.tags.size(); i < paths.size(); ++i) {
    ASSERT_EQ(paths[i].points.size(), 4u);
    EXPECT_NEAR((paths[i].points[1] - paths[i].points[0]).norm(), board.checker_square_mm,
                kFile_abs);
  }
}

TEST(BoardSheets, PdfAndSvgAreAtTrueScale) {
  const Board board = DefaultBoard();
  SheetOptions options;
  options.paper = Paper::kA3;
  const std::vector<VectorPage> pages = LayOutSheets(board, options);
  ASSERT_EQ(pages.size(), 1u);
  V2 page(0, 0);
  ExpectTrueScale(board, FilledPathsOfPdf(PdfOfPages(pages, board.name), page));
  EXPECT_LT((page - V2(297, 420)).norm(), kFile_abs);
  ExpectTrueScale(board, FilledPathsOfSvg(SvgOfPage(pages[0], board.name), page));
  EXPECT_EQ(page, V2(297, 420));
}

TEST(BoardSheets, PdfObjectsAreWhereTheTableSays) {
  SheetOptions options;
  options.paper = Paper::kA4;
  const std::string pdf = PdfOfPages(LayOutSheets(DefaultBoard(), options), "a (hostile \\ title");
  const size_t start = std::stoul(pdf.substr(pdf.find("startxref\n") + 10));
  ASSERT_EQ(pdf.substr(start, 5), "xref\n");
  std::istringstream table(pdf.substr(start));
  std::string word;
  int first = 0, count = 0;
  table >> word >> first >> count;
  table.ignore(1);
  std::string line;
  std::getline(table, line);
  for (int i = 1; i < count; ++i) {
    std::getline(table, line);
    ASSERT_EQ(line.size(), 19u) << "20 bytes with its end";
    EXPECT_EQ(pdf.find(std::to_string(i) + " 0 obj\n", std::stoul(line)), std::stoul(line));
  }
  EXPECT_EQ(pdf.find("hostile \\"), std::string::npos);
  // A stream's length is what it says.
  const size_t length = std::stoul(pdf.substr(pdf.find("/Length ") + 8));
  const size_t stream = pdf.find("stream\n") + 7;
  EXPECT_EQ(pdf.substr(stream + length, 9), "endstream");
}

TEST(BoardSheets, OneTagIsOnePathWithoutInnerEdges) {
  Board board = DefaultBoard();
  board.tags.resize(1);
  board.checker_columns = board.checker_rows = 0;
  const std::vector<VectorShape> ink = BoardInk(board);
  ASSERT_EQ(ink.size(), 1u);
  const auto& path = std::get<FilledPath>(ink[0]);
  // The area between the loops (by the even-odd rule, holes turn the other way) is that of the ink.
  double area = 0;
  for (const auto& loop : path.loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const V2 &a = loop[i], &b = loop[(i + 1) % loop.size()], &c = loop[(i + 2) % loop.size()];
      area += (a.x() * b.y() - a.y() * b.x()) / 2;
      const V2 u = b - a, v = c - b;
      EXPECT_GT(std::abs(u.x() * v.y() - u.y() * v.x()), 1e-9) << "a point within a straight side";
    }
  }
  const BoardPrint print(board);
  int cells = 0;
  for (int cell = 0; cell < 64; ++cell) {
    const V2 p(cell % 8 * 3 - 10.5, cell / 8 * 3 - 10.5);
    cells += print.Value(board.tags[0].center_mm + p) == 0;
  }
  EXPECT_NEAR(std::abs(area), cells * 9.0, 1e-9);
}

TEST(BoardSheets, LargeBoardsGoOverSeveralSheetsThatOverlap) {
  const Board board = DefaultBoard();
  SheetOptions options;
  options.paper = Paper::kA4;
  const std::vector<VectorPage> pages = LayOutSheets(board, options);
  // 182 x 263 mm of an upright sheet are free: 220 mm need two columns of one row.
  ASSERT_EQ(pages.size(), 2u);
  // Where the middle of the plate lies on a sheet, by the first tag that the sheet holds.
  const auto middle = [&](const VectorPage& page, size_t tag) {
    const V2 corner = std::get<FilledPath>(page.groups[0].shapes[0]).loops[0][0];
    return V2(corner - board.TagCorners(board.tags[tag])[0].head<2>());
  };
  const V2 low = middle(pages[0], 0);
  // What the first sheet shows at its right edge, the second shows at its left.
  const Eigen::AlignedBox2d area = *pages[0].groups[0].clip;
  const V2 shift(options.overlap_mm - area.sizes().x(), 0);
  const Eigen::AlignedBox2d on_second(area.min() - shift - low, area.max() - shift - low);
  const auto held = std::ranges::find_if(board.tags, [&](const BoardTag& tag) {
    Eigen::AlignedBox2d box;
    for (const auto& corner : board.TagCorners(tag)) box.extend(V2(corner.head<2>()));
    return box.intersects(on_second);
  });
  ASSERT_NE(held, board.tags.end());
  EXPECT_LT((middle(pages[1], held - board.tags.begin()) - low - shift).norm(), 1e-9);
  // Every point of the plate is on a sheet.
  for (double x = -110; x <= 110; x += 0.5) {
    for (double y = -110; y <= 110; y += 0.5) {
      const bool first = area.contains(V2(low + V2(x, y)));
      const bool second = area.contains(V2(low + shift + V2(x, y)));
      ASSERT_TRUE(first || second) << x << " " << y;
    }
  }
}

TEST(BoardSheets, AutomaticPaperIsTheSmallestThatFits) {
  Board board = DefaultBoard();
  const auto width = [&](double side) {
    board.width_mm = board.height_mm = side;
    return LayOutSheets(board, {}).at(0).width_mm;
  };
  EXPECT_EQ(width(220), 297);
  EXPECT_EQ(width(280), 420);
  board.tags.resize(1);
  board.tags[0].center_mm = {0, 0};
  board.checker_columns = board.checker_rows = 0;
  EXPECT_EQ(width(180), 210);
  EXPECT_EQ(width(820), 841);
  EXPECT_EQ(LayOutSheets(board, {}).size(), 2u);
  EXPECT_EQ(width(2000), 841);
  board.height_mm = 100;
  board.width_mm = 250;
  EXPECT_EQ(LayOutSheets(board, {.paper = Paper::kA4}).at(0).width_mm, 297) << "turned";
}

TEST(BoardSheets, RefusesWhatCannotBePrinted) {
  Board board = DefaultBoard();
  EXPECT_THROW(
      LayOutSheets(board, {.paper = Paper::kCustom, .paper_width_mm = 41, .paper_height_mm = 41}),
      Error);
  EXPECT_THROW(LayOutSheets(board, {.paper = Paper::kA4, .margin_mm = 95}), Error);
  EXPECT_THROW(LayOutSheets(board, {.margin_mm = std::nan("")}), Error);
  EXPECT_THROW(LayOutSheets(board, {.paper = Paper::kCustom, .paper_width_mm = 1e9}), Error);
  board.width_mm = board.height_mm = 90000;
  EXPECT_THROW(LayOutSheets(board, {}), Error) << "more than 400 sheets";
  board.tags.clear();
  EXPECT_NO_THROW(BoardInk(board));
  EXPECT_THROW(PdfOfPages({}, "none"), Error);
}

TEST(VectorText, EveryTextHasLinesAndAWidth) {
  EXPECT_TRUE(TextLines("", {0, 0}, 2, {0, 0, 0}).empty());
  EXPECT_EQ(TextWidth("", 2), 0);
  for (const std::string text : {"a", "Z", "0", "?", "\xff", "%"}) {
    EXPECT_FALSE(TextLines(text, {0, 0}, 2, {0, 0, 0}).empty()) << text;
  }
  Eigen::AlignedBox2d box;
  for (const VectorShape& shape : TextLines("H8", {10, 20}, 3, {0, 0, 0})) {
    for (const V2& p : std::get<StrokedLine>(shape).points) box.extend(p);
  }
  EXPECT_NEAR((box.min() - V2(10, 20)).norm(), 0, 1e-12);
  EXPECT_NEAR(box.sizes().y(), 3, 1e-12);
  EXPECT_NEAR(box.sizes().x(), TextWidth("H8", 3), 1e-12);
  EXPECT_EQ(VectorNumber(-0.000001), "0");
  EXPECT_EQ(VectorNumber(12.5), "12.5");
  EXPECT_EQ(VectorNumber(100), "100");
}

// A print by another program's reader, measured by another library's detector.
TEST(BoardSheets, RasterisedPdfShowsTheTagsWhereTheBoardSays) {
  const ScratchFolder scratch;
  const Board board = DefaultBoard();
  WriteFileAtomically(scratch.folder / "board.pdf",
                      PdfOfPages(LayOutSheets(board, {.paper = Paper::kCustom,
                                                      .paper_width_mm = 260,
                                                      .paper_height_mm = 260}),
                                 board.name));
  constexpr double kDpi = 250;
  const CommandOutcome outcome =
      RunCommand({"/usr/bin/pdftoppm", "-r", "250", "-png", "-singlefile",
                  (scratch.folder / "board.pdf").string(), (scratch.folder / "page").string()});
  if (outcome.status == 127) GTEST_SKIP() << "pdftoppm (package poppler-utils) is not installed";
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Image page = ReadImage(scratch.folder / "page.png");
  EXPECT_EQ(page.width(), std::ceil(260 / 25.4 * kDpi));
  TagDetector detector(board.family);
  const std::vector<TagDetection> tags = detector.Detect(page);
  ASSERT_EQ(tags.size(), board.tags.size());
  // Distances from the first tag's corners, in mm: the readers are off by parts of a pixel (0.1
  // mm).
  constexpr double kPrint_abs = 0.06, kMean_rel = 2e-4;
  const double mm = 25.4 / kDpi;
  const auto expected_first = board.TagCorners(board.tags[0]);
  double printed = 0, designed = 0;
  for (size_t i = 1; i < tags.size(); ++i) {
    ASSERT_EQ(tags[i].id, board.tags[i].id);
    const auto corners = board.TagCorners(board.tags[i]);
    for (int c = 0; c < 4; ++c) {
      const V2 seen = (tags[i].corners[c] - tags[0].corners[c]) * mm;
      const V2 expected = (corners[c] - expected_first[c]).head<2>();
      EXPECT_NEAR(seen.x(), expected.x(), kPrint_abs) << i;
      EXPECT_NEAR(-seen.y(), expected.y(), kPrint_abs) << i;
      printed += seen.norm();
      designed += expected.norm();
    }
  }
  EXPECT_NEAR(printed / designed, 1, kMean_rel);
}

TEST(BoardCommand, WritesEverythingAndSaysOneLineOnBadInput) {
  const ScratchFolder scratch;
  const std::string command = std::string(LFM_BIN_DIR) + "/lfm-board";
  const std::string out = (scratch.folder / "out").string();
  const CommandOutcome good = RunCommand({command, out, "--layout", "circles", "--quiet"});
  ASSERT_EQ(good.status, 0) << good.err;
  for (const char* file : {"board.json", "board.pdf", "board.svg", "board.png"}) {
    EXPECT_TRUE(std::filesystem::exists(scratch.folder / "out" / file)) << file;
  }
  EXPECT_EQ(ReadBoard(scratch.folder / "out/board.json").circles.size(), 8u);
  const std::string attached = (scratch.folder / "attached").string();
  const CommandOutcome wall =
      RunCommand({command, (scratch.folder / "wall").string(), "--layout", "grid", "--tag-columns",
                  "3", "--tag-rows", "2", "--first-id", "100", "--width", "110", "--height", "80"});
  ASSERT_EQ(wall.status, 0) << wall.err;
  const CommandOutcome joined =
      RunCommand({command, attached, "--attach", (scratch.folder / "wall/board.json").string(),
                  "--attach-at", "0 120 45 90 0 0"});
  ASSERT_EQ(joined.status, 0) << joined.err;
  const Board platform = ReadBoard(scratch.folder / "attached/board.json");
  ASSERT_EQ(platform.attached.size(), 1u);
  EXPECT_LT((platform.attached[0].world_from_board * Eigen::Vector3d(0, 1, 0) -
             Eigen::Vector3d(0, 120, 46))
                .norm(),
            1e-9);
  for (const std::vector<std::string>& bad :
       {std::vector<std::string>{"--attach", out + "/board.json", "--attach-at", "1 2"},
        {"--attach", out + "/board.json", "--attach-at", "0 120 45 -"},
        {"--attach", out + "/board.json", "--attach-at", "0 120 1e999"},
        {"--attach", out + "/board.json", "--attach-at", "0 120 nan"},
        {"--attach", out + "/board.json", "--attach-at", "1 2 3 4 5 6 7"},
        {"--circles", "2"},
        {"--family", "tag0h0"},
        {"--tag-size", "40"},
        {"--from", out + "/none.json"},
        {"--kalibr", out + "/grid.yaml"}}) {
    std::vector<std::string> arguments = {command, (scratch.folder / "bad").string()};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const CommandOutcome outcome = RunCommand(arguments);
    EXPECT_EQ(outcome.status, 2) << bad[0];
    EXPECT_TRUE(IsOneLineWith(outcome.err, {"lfm-board: error: "})) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(scratch.folder / "bad"));
}

}  // namespace
}  // namespace lfm
