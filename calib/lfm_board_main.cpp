// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include "calib/board.h"
#include "calib/board_advice.h"
#include "calib/board_design.h"
#include "calib/board_prints.h"
#include "calib/board_sheets.h"
#include "calib/kalibr_grid.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/output_folder.h"

namespace {

struct CommandOptions {
  std::string from, from_kalibr, kalibr;
  std::string attach, attach_at;
  double pixels_per_mm = 4, mm_per_pixel = 0.25;
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"from",
            "Print this board.json instead of designing one: options of the design are ignored."},
           from);
    v.Text(
        {"from-kalibr", "Print the grid of this Kalibr aprilgrid.yaml (metres there), likewise."},
        from_kalibr);
    v.Text({"kalibr", "Also describe the board to Kalibr, in this file; it must be an aprilgrid."},
           kalibr);
    v.Text({"attach", "A board.json that becomes a further plate of the platform."}, attach);
    v.Text({"attach-at",
            "Where --attach stands: \"x y z\" of its centre in mm, or \"x y z rx ry rz\" with "
            "degrees turned about the platform's x, then y, then z axis."},
           attach_at);
    v.Number({"pixels-per-mm", "Fineness of board.png.", "px/mm", 0.1, 100}, pixels_per_mm);
    v.Number({"mm-per-pixel", "How coarse cameras will see the platform; for advice only.", "mm",
              1e-4, 1000},
             mm_per_pixel);
  }
};

lfm::Pose ParsePose(const std::string& text) {
  std::istringstream stream(text);
  std::array<double, 6> v = {0, 0, 0, 0, 0, 0};
  size_t count = 0;
  bool numbers = true;
  for (std::string word; stream >> word; ++count) {
    double unused = 0;
    double& value = count < v.size() ? v[count] : unused;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    numbers =
        numbers && error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
  }
  if (!numbers || (count != 3 && count != 6)) {
    throw lfm::Error("--attach-at: \"" + text + "\" is not \"x y z\" or \"x y z rx ry rz\"");
  }
  const auto turn = [&](double deg, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(deg / 180 * EIGEN_PI, axis).toRotationMatrix();
  };
  return {turn(v[5], Eigen::Vector3d::UnitZ()) * turn(v[4], Eigen::Vector3d::UnitY()) *
              turn(v[3], Eigen::Vector3d::UnitX()),
          {v[0], v[1], v[2]}};
}

lfm::Board MakeBoard(const CommandOptions& command, const lfm::BoardDesign& design) {
  if (!command.from.empty() && !command.from_kalibr.empty()) {
    throw lfm::Error("--from and --from-kalibr: give one of them");
  }
  lfm::Board board = !command.from.empty()          ? lfm::ReadBoard(command.from)
                     : !command.from_kalibr.empty() ? lfm::ReadKalibrGrid(command.from_kalibr)
                                                    : lfm::DesignBoard(design);
  if (command.attach.empty() && !command.attach_at.empty()) {
    throw lfm::Error("--attach-at: give the board that stands there, too (--attach)");
  }
  if (!command.attach.empty()) {
    lfm::Board other = lfm::ReadBoard(command.attach);
    board.attached.push_back({std::move(other), ParsePose(command.attach_at)});
    lfm::ValidateBoard(board, board.name + " with " + command.attach);
  }
  return board;
}

}  // namespace

int main(int argc, char** argv) {
  std::string folder;
  lfm::BoardDesign design;
  lfm::SheetOptions sheets;
  CommandOptions options;
  lfm::CommandLine command(
      "lfm-board",
      "Designs the platform's print: board.json for captures, and PDF, SVG and pictures of it.",
      "lfm-board board --family tag25h9 --tag-size 22 --paper a3");
  command.Positional("OUT", "Folder for board.json, board.pdf, board.svg and board.png.", folder);
  command.Options(lfm::AnyOptions(design), "Design");
  command.Options(lfm::AnyOptions(sheets), "Sheets");
  command.Options(lfm::AnyOptions(options));
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    lfm::RequireWritableFolder(folder);
    const lfm::Board board = MakeBoard(options, design);
    for (const std::string& line : lfm::AdviseOnBoard(board, options.mm_per_pixel)) {
      progress.Note("advice: " + line);
    }
    if (!options.kalibr.empty()) lfm::WriteKalibrGrid(board, options.kalibr);
    for (const std::filesystem::path& file :
         lfm::WriteBoardPrints(board, sheets, options.pixels_per_mm, folder)) {
      progress.Note("wrote " + file.string());
    }
  });
}
