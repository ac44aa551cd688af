// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/plate.h"

#include <algorithm>
#include <cmath>

#include "core/json_reader.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr uint64_t kPrintStream = 41;
constexpr double kStripMm = 5;
constexpr double kMostSigmas = 2.5;

}  // namespace

namespace {

// `first_tag` counts the tags of the plates before.
void PrintPlate(Board& plate, const PlatformTrouble& trouble, uint64_t seed, size_t first_tag) {
  const double scale = 1 + trouble.print_scale_percent / 100;
  plate.tag_size_mm *= scale;
  plate.checker_square_mm *= scale;
  for (BoardCircle& circle : plate.circles) {
    circle.center_mm *= scale;
    circle.diameter_mm *= scale;
  }
  for (BoardSquare& square : plate.squares) {
    square.center_mm *= scale;
    square.size_mm *= scale;
  }
  for (size_t i = 0; i < plate.tags.size(); ++i) {
    RandomStream random(seed, kPrintStream, first_tag + i);
    Eigen::Vector2d& center = plate.tags[i].center_mm;
    center *= scale;
    for (int axis = 0; axis < 2; ++axis) {
      center[axis] += trouble.tag_error_mm * std::clamp(random.Normal(), -kMostSigmas, kMostSigmas);
    }
  }
}

}  // namespace

Board PrintedBoard(const Board& nominal, const PlatformTrouble& trouble, uint64_t seed) {
  Board printed = nominal;
  PrintPlate(printed, trouble, seed, 0);
  size_t tags = printed.tags.size();
  for (AttachedBoard& attached : printed.attached) {
    PrintPlate(attached.board, trouble, seed, tags);
    tags += attached.board.tags.size();
  }
  ValidateBoard(printed, "the board as printed (tag-error, print-scale)");
  return printed;
}

double PlateHeight(const Board& board, double sag_mm, double x_mm) {
  const double t = 2 * x_mm / board.width_mm;
  return -sag_mm * t * t;
}

std::vector<Patch> MakeBentPlateAndTable(const Board& board, double sag_mm,
                                         const Pose& world_from_table) {
  Pose lowered = world_from_table;
  lowered.translation.z() -= std::max(0.0, sag_mm);
  std::vector<Patch> flat = MakePlateAndTable(board, lowered);
  if (sag_mm == 0) return flat;
  const double w = board.width_mm, h = board.height_mm, t = kPlateThicknessMm;
  const int strips = std::max(2, static_cast<int>(std::lround(w / kStripMm)));
  std::vector<Patch> patches;
  for (int i = 0; i < strips; ++i) {
    const double x0 = -w / 2 + w * i / strips, x1 = -w / 2 + w * (i + 1) / strips;
    const V3 low(x0, 0, PlateHeight(board, sag_mm, x0));
    const V3 high(x1, 0, PlateHeight(board, sag_mm, x1));
    const V3 u = (high - low).normalized(), half(0, h / 2, 0);
    const V3 up = u.cross(V3::UnitY());
    const double length = (high - low).norm();
    patches.push_back({low - half, u, V3::UnitY(), length, h, PatchMaterial::kPrint});
    patches.push_back({low - half - t * up, u, up, length, t, PatchMaterial::kEdge});
    patches.push_back({high + half - t * up, -u, up, length, t, PatchMaterial::kEdge});
  }
  const double z = PlateHeight(board, sag_mm, w / 2) - t;
  patches.push_back({V3(w / 2, -h / 2, z), V3::UnitY(), V3::UnitZ(), h, t, PatchMaterial::kEdge});
  patches.push_back({V3(-w / 2, h / 2, z), -V3::UnitY(), V3::UnitZ(), h, t, PatchMaterial::kEdge});
  // Attached boards are stiff and stay; the table is last.
  for (const Patch& patch : flat) {
    if (patch.plate > 0 || patch.material == PatchMaterial::kTable) patches.push_back(patch);
  }
  return patches;
}

void WritePlatformTruth(const Board& printed, double sag_mm, const std::filesystem::path& file) {
  const auto point = [&](const V3& p) {
    return nlohmann::json{p.x(), p.y(), PlateHeight(printed, sag_mm, p.x())};
  };
  nlohmann::json json = {{"plate_sag_mm", sag_mm}};
  json["tags"] = json["checker_corners_mm"] = nlohmann::json::array();
  for (const BoardPlate& plate : PlatesOf(printed)) {
    const auto world = [&](const V3& p) {
      const V3 q = plate.world_from_plate * p;
      return plate.board == &printed ? point(q) : nlohmann::json{q.x(), q.y(), q.z()};
    };
    for (const BoardTag& tag : plate.board->tags) {
      nlohmann::json corners = nlohmann::json::array();
      for (const V3& corner : plate.board->TagCorners(tag)) corners.push_back(world(corner));
      json["tags"].push_back({{"id", tag.id}, {"corners_mm", corners}});
    }
    for (const V3& corner : plate.board->CheckerCorners()) {
      json["checker_corners_mm"].push_back(world(corner));
    }
  }
  WriteJson(json, file);
}

}  // namespace lfm
