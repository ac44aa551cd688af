// SPDX-License-Identifier: BSD-3-Clause
#include "calib/kalibr_grid.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr size_t kMaxFileBytes = 1 << 16;
constexpr double kMmPerMetre = 1000;
constexpr double kMaxTagSizeMetres = 5;
constexpr double kMinSpacing = 1e-3, kMaxSpacing = 10;  // of a tag
constexpr int kMaxTagsAlong = 100, kMaxCodeOffset = 10000;
constexpr int kKalibrBorderCells = 2;
constexpr double kTolerance = 1e-3;  // of a tag
// Kalibr draws tag36h11 the same way up as libapriltag.
constexpr double kKalibrRotation = 0;

struct Grid {
  int columns = 0, rows = 0, code_offset = 0;
  double tag_size_mm = 0, spacing = 0;
};

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// "key: value  # remark" lines: all that Kalibr's target files hold.
std::map<std::string, std::string> ReadYamlPairs(const std::filesystem::path& file) {
  std::istringstream lines(ReadFile(file, kMaxFileBytes));
  std::map<std::string, std::string> pairs;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line = Trimmed(line.substr(0, line.find('#')));
    if (line.empty() || line == "---" || line.starts_with("%YAML")) continue;
    const std::string where = file.string() + ": line " + std::to_string(number);
    const size_t colon = line.find(':');
    if (colon == std::string::npos) throw Error(where + ": expected \"key: value\"");
    std::string value = Trimmed(line.substr(colon + 1));
    if (value.size() >= 2 && (value[0] == '\'' || value[0] == '"') && value.back() == value[0]) {
      value = value.substr(1, value.size() - 2);
    }
    const std::string key = Trimmed(line.substr(0, colon));
    if (!pairs.emplace(key, value).second) throw Error(where + ": \"" + key + "\" a second time");
  }
  return pairs;
}

class GridReader {
 public:
  explicit GridReader(const std::filesystem::path& file)
      : file_(file.string()), pairs_(ReadYamlPairs(file)) {}

  std::string Text(const std::string& key) {
    const auto found = pairs_.find(key);
    if (found == pairs_.end()) throw Error(file_ + ": " + key + ": missing");
    const std::string value = found->second;
    pairs_.erase(found);
    return value;
  }
  template <typename Number>
  Number Between(const std::string& key, Number min, Number max) {
    const std::string text = Text(key);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    // Written so that NaN is out of range.
    if (error != std::errc() || end != text.data() + text.size() ||
        !(value >= min && value <= max)) {
      std::ostringstream range;
      range << min << " to " << max;
      throw Error(file_ + ": " + key + ": \"" + text.substr(0, 40) + "\" is no number from " +
                  range.str());
    }
    return value;
  }
  bool Has(const std::string& key) const { return pairs_.contains(key); }
  void Finish() const {
    if (!pairs_.empty()) throw Error(file_ + ": " + pairs_.begin()->first + ": unknown key");
  }

 private:
  std::string file_;
  std::map<std::string, std::string> pairs_;
};

Grid ReadGrid(const std::filesystem::path& file) {
  GridReader reader(file);
  if (const std::string type = reader.Text("target_type"); type != "aprilgrid") {
    throw Error(file.string() + ": target_type: \"" + type.substr(0, 40) +
                "\"; only aprilgrid is a board with tags");
  }
  Grid grid;
  grid.columns = reader.Between("tagCols", 1, kMaxTagsAlong);
  grid.rows = reader.Between("tagRows", 1, kMaxTagsAlong);
  const double size_m = reader.Between("tagSize", 1e-4, 1e5);
  if (size_m > kMaxTagSizeMetres) {
    throw Error(file.string() + ": tagSize: " + std::to_string(size_m) +
                " m is too large for a tag; Kalibr takes metres: is this millimetres?");
  }
  grid.tag_size_mm = size_m * kMmPerMetre;
  grid.spacing = reader.Between("tagSpacing", kMinSpacing, kMaxSpacing);
  if (reader.Has("codeOffset")) grid.code_offset = reader.Between("codeOffset", 0, kMaxCodeOffset);
  reader.Finish();
  return grid;
}

Board BoardOfGrid(const Grid& grid) {
  const double size = grid.tag_size_mm, square = grid.spacing * size, pitch = size + square;
  const double half_columns = (grid.columns - 1) / 2.0, half_rows = (grid.rows - 1) / 2.0;
  Board board;
  board.name = "aprilgrid";
  board.family = "tag36h11";
  board.border_cells = kKalibrBorderCells;
  board.tag_size_mm = size;
  board.width_mm = grid.columns * pitch + square + size / 5;
  board.height_mm = grid.rows * pitch + square + size / 5;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      BoardTag tag;
      tag.id = grid.code_offset + row * grid.columns + column;
      tag.center_mm = {(column - half_columns) * pitch, (row - half_rows) * pitch};
      tag.rotation = kKalibrRotation;
      board.tags.push_back(tag);
    }
  }
  for (int row = 0; row <= grid.rows; ++row) {
    for (int column = 0; column <= grid.columns; ++column) {
      board.squares.push_back(
          {{(column - 0.5 - half_columns) * pitch, (row - 0.5 - half_rows) * pitch}, square});
    }
  }
  return board;
}

// Columns from the first row, spacing from the first two tags of a row or column.
Grid GridOfBoard(const Board& board, const std::string& where) {
  if (board.family != "tag36h11" || board.border_cells != kKalibrBorderCells) {
    throw Error(where + ": no Kalibr grid: needs tag36h11 with border_cells 2");
  }
  if (board.tags.size() < 2 || board.checker_columns > 0 || !board.circles.empty() ||
      !board.attached.empty()) {
    throw Error(where +
                ": no Kalibr grid: needs two tags at least, no checker, no circles, no "
                "attached boards");
  }
  const double size = board.tag_size_mm;
  std::vector<BoardTag> tags = board.tags;
  std::sort(tags.begin(), tags.end(),
            [](const BoardTag& a, const BoardTag& b) { return a.id < b.id; });
  Grid grid;
  grid.tag_size_mm = size;
  grid.code_offset = tags[0].id;
  while (grid.columns < static_cast<int>(tags.size()) &&
         std::abs(tags[static_cast<size_t>(grid.columns)].center_mm.y() - tags[0].center_mm.y()) <
             kTolerance * size) {
    ++grid.columns;
  }
  grid.rows = static_cast<int>(tags.size()) / grid.columns;
  const double pitch = (tags[1].center_mm - tags[0].center_mm).norm();
  grid.spacing = pitch / size - 1;
  return grid;
}

}  // namespace

Board ReadKalibrGrid(const std::filesystem::path& file) {
  const Board board = BoardOfGrid(ReadGrid(file));
  ValidateBoard(board, file.string());
  return board;
}

void WriteKalibrGrid(const Board& board, const std::filesystem::path& file) {
  const std::string where = board.name.empty() ? "board" : board.name;
  ValidateBoard(board, where);
  const Grid grid = GridOfBoard(board, where);
  const Board regular = BoardOfGrid(grid);
  bool same = regular.tags.size() == board.tags.size();
  for (const BoardTag& expected : regular.tags) {
    const auto tag = std::find_if(board.tags.begin(), board.tags.end(),
                                  [&](const BoardTag& t) { return t.id == expected.id; });
    same = same && tag != board.tags.end() &&
           (tag->center_mm - expected.center_mm).norm() < kTolerance * board.tag_size_mm &&
           std::abs(std::remainder(tag->rotation - expected.rotation, 2 * std::numbers::pi)) <
               kTolerance;
  }
  for (const BoardSquare& square : board.squares) {
    same = same && std::any_of(regular.squares.begin(), regular.squares.end(),
                               [&](const BoardSquare& expected) {
                                 const double allowed = kTolerance * board.tag_size_mm;
                                 return (square.center_mm - expected.center_mm).norm() < allowed &&
                                        std::abs(square.size_mm - expected.size_mm) < allowed;
                               });
  }
  if (!same) {
    throw Error(where +
                ": no Kalibr grid: ids must go row by row from the lower left, tags upright "
                "(rotation_deg 0), evenly spaced and centred, black squares only between them");
  }
  if (!(grid.spacing >= kMinSpacing && grid.spacing <= kMaxSpacing) ||
      grid.columns > kMaxTagsAlong || grid.rows > kMaxTagsAlong ||
      grid.code_offset > kMaxCodeOffset || grid.tag_size_mm > kMaxTagSizeMetres * kMmPerMetre) {
    throw Error(where + ": no Kalibr grid: tags too large, too far apart or too many");
  }
  std::ostringstream text;
  text.precision(12);
  text << "target_type: 'aprilgrid'\n"
       << "tagCols: " << grid.columns << "\n"
       << "tagRows: " << grid.rows << "\n"
       << "tagSize: " << grid.tag_size_mm / kMmPerMetre << "  # metres, edge to edge\n"
       << "tagSpacing: " << grid.spacing << "  # space between tags / tagSize\n"
       << "codeOffset: " << grid.code_offset << "\n";
  WriteFileAtomically(file, text.str());
}

}  // namespace lfm
