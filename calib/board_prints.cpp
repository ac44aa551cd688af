// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_prints.h"

#include <string>

#include "core/atomic_file.h"
#include "core/image.h"

namespace lfm {
namespace {

// The plate as a board of its own, as far as drawing goes: what it lacks to be recognised by, the
// platform has.
Board LonePlate(const Board& board, const BoardPlate& plate) {
  Board lone = *plate.board;
  lone.family = board.family;
  lone.border_cells = board.border_cells;
  lone.attached.clear();
  return lone;
}

std::string Numbered(const std::string& stem, size_t i, const std::string& ending) {
  return stem + "-" + std::to_string(i) + ending;
}

}  // namespace

std::vector<std::filesystem::path> WriteBoardPrints(const Board& board, const SheetOptions& options,
                                                    double pixels_per_mm,
                                                    const std::filesystem::path& folder) {
  const std::vector<BoardPlate> plates = PlatesOf(board);
  std::vector<VectorPage> pages;
  std::vector<Image> pictures;
  for (const BoardPlate& plate : plates) {
    const Board lone = LonePlate(board, plate);
    for (VectorPage& page : LayOutSheets(lone, options)) pages.push_back(std::move(page));
    pictures.push_back(DrawBoard(lone, pixels_per_mm));
  }
  std::vector<std::filesystem::path> files = {folder / "board.json", folder / "board.pdf"};
  WriteBoard(board, files[0]);
  WriteFileAtomically(files[1], PdfOfPages(pages, board.name));
  for (size_t i = 0; i < pages.size(); ++i) {
    files.push_back(folder / (pages.size() == 1 ? "board.svg" : Numbered("board", i + 1, ".svg")));
    WriteFileAtomically(files.back(), SvgOfPage(pages[i], board.name));
  }
  for (size_t i = 0; i < pictures.size(); ++i) {
    files.push_back(folder / (i == 0 ? "board.png" : Numbered("attached", i, ".png")));
    WriteImage(pictures[i], files.back());
  }
  return files;
}

}  // namespace lfm
