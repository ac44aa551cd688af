// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numbers>

#include "calib/board.h"
#include "core/error.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr int kMaxCheckerSquares = 1000;

BoardCircle ReadCircle(JsonReader& item) {
  BoardCircle circle;
  const std::vector<double> center = item.Numbers("center_mm", 2);
  circle.center_mm = {center[0], center[1]};
  circle.diameter_mm = item.Number("diameter_mm");
  const std::string color = item.Text("color");
  const std::vector<std::string>& names = CircleColorNames();
  const auto found = std::find(names.begin(), names.end(), color);
  if (found == names.end()) {
    item.Fail("color", "unknown colour; use red, yellow, green, cyan, blue or magenta");
  }
  circle.color = static_cast<CircleColor>(found - names.begin());
  item.Finish();
  return circle;
}

// What every plate has, the platform's own and attached ones.
void ReadPlate(JsonReader& reader, Board& board) {
  board.name = reader.Text("name");
  board.width_mm = reader.Number("width_mm");
  board.height_mm = reader.Number("height_mm");
  for (JsonReader& item : reader.Objects("tags")) {
    BoardTag tag;
    tag.id = item.Integer("id", 0, 1000000);
    const std::vector<double> center = item.Numbers("center_mm", 2);
    tag.center_mm = {center[0], center[1]};
    tag.rotation = item.NumberOr("rotation_deg", 0) / 180 * std::numbers::pi;
    item.Finish();
    board.tags.push_back(tag);
  }
  if (!board.tags.empty() || reader.Has("tag_size_mm")) {
    board.tag_size_mm = reader.Number("tag_size_mm");
  }
  if (reader.Has("checker")) {
    JsonReader checker = reader.Object("checker");
    board.checker_columns = checker.Integer("columns", 2, kMaxCheckerSquares);
    board.checker_rows = checker.Integer("rows", 2, kMaxCheckerSquares);
    board.checker_square_mm = checker.Number("square_mm");
    checker.Finish();
  }
  if (reader.Has("circles")) {
    for (JsonReader& item : reader.Objects("circles")) board.circles.push_back(ReadCircle(item));
  }
  if (reader.Has("squares")) {
    for (JsonReader& item : reader.Objects("squares")) {
      const std::vector<double> center = item.Numbers("center_mm", 2);
      board.squares.push_back({{center[0], center[1]}, item.Number("size_mm")});
      item.Finish();
    }
  }
}

nlohmann::json PlateToJson(const Board& board) {
  nlohmann::json json = {{"name", board.name},
                         {"width_mm", board.width_mm},
                         {"height_mm", board.height_mm},
                         {"tags", nlohmann::json::array()}};
  const auto point = [](const Eigen::Vector2d& p) { return nlohmann::json{p.x(), p.y()}; };
  if (!board.tags.empty()) json["tag_size_mm"] = board.tag_size_mm;
  for (const BoardTag& tag : board.tags) {
    json["tags"].push_back({{"id", tag.id},
                            {"center_mm", point(tag.center_mm)},
                            {"rotation_deg", tag.rotation / std::numbers::pi * 180}});
  }
  if (board.checker_columns > 0) {
    json["checker"] = {{"columns", board.checker_columns},
                       {"rows", board.checker_rows},
                       {"square_mm", board.checker_square_mm}};
  }
  for (const BoardCircle& circle : board.circles) {
    json["circles"].push_back(
        {{"center_mm", point(circle.center_mm)},
         {"diameter_mm", circle.diameter_mm},
         {"color", CircleColorNames().at(static_cast<size_t>(circle.color))}});
  }
  for (const BoardSquare& square : board.squares) {
    json["squares"].push_back(
        {{"center_mm", point(square.center_mm)}, {"size_mm", square.size_mm}});
  }
  return json;
}

}  // namespace

Board ReadBoard(const std::filesystem::path& file) {
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  Board board;
  ReadPlate(reader, board);
  if (!board.tags.empty() || reader.Has("family")) board.family = reader.Text("family");
  if (reader.Has("border_cells")) board.border_cells = reader.Integer("border_cells", 1, 2);
  if (reader.Has("attached")) {
    for (JsonReader& item : reader.Objects("attached")) {
      AttachedBoard attached;
      ReadPlate(item, attached.board);
      attached.board.family = board.family;
      attached.board.border_cells = board.border_cells;
      attached.world_from_board = PoseFromJson(item);
      item.Finish();
      board.attached.push_back(std::move(attached));
    }
  }
  reader.Finish();
  ValidateBoard(board, file.string());
  return board;
}

void WriteBoard(const Board& board, const std::filesystem::path& file) {
  ValidateBoard(board, board.name.empty() ? "board" : board.name);
  nlohmann::json json = PlateToJson(board);
  json["family"] = board.family;
  if (board.border_cells != 1) json["border_cells"] = board.border_cells;
  for (const AttachedBoard& attached : board.attached) {
    nlohmann::json plate = PlateToJson(attached.board);
    plate.update(PoseToJson(attached.world_from_board));
    json["attached"].push_back(std::move(plate));
  }
  WriteJson(json, file);
}

}  // namespace lfm
