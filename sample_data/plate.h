// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "calib/board.h"
#include "sample_data/studio_scene.h"
#include "sample_data/trouble.h"

namespace lfm {

/// The board as it was printed: everything printed scaled about the middle by 1 +
/// print_scale_percent / 100, and each tag moved by tag_error_mm N(0, 1) in x and in y (at most 2.5
/// sigma). The plate keeps its size. `nominal` itself when there is no trouble. Throws Error when
/// the result is no board any more (tags that touch, or leave the plate).
Board PrintedBoard(const Board& nominal, const PlatformTrouble& trouble, uint64_t seed);

/// Height of the plate's upper face: -sag (2 x / width)^2, a sheet bent about the y axis. Along the
/// sheet lengths are those along x to within sag^2 / width (0.005 mm for 1 mm).
double PlateHeight(const Board& board, double sag_mm, double x_mm);

/// MakePlateAndTable for a bent plate: flat strips of 5 mm, each within sag / 1900 of the bent face
/// (exactly there at their ends). The table, 5 mm below the middle, goes down by a positive sag.
/// Without sag it is MakePlateAndTable.
std::vector<Patch> MakeBentPlateAndTable(const Board& board, double sag_mm,
                                         const Pose& world_from_table);

/// Writes where everything printed truly is (docs/formats.md): tag corners and checker corners,
/// world frame, mm, on the bent plate.
void WritePlatformTruth(const Board& printed, double sag_mm, const std::filesystem::path& file);

}  // namespace lfm
