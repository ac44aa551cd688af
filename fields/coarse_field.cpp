// SPDX-License-Identifier: BSD-3-Clause
#include "fields/coarse_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

void PictureCells(const Field& field, int factor, CoarseField& coarse) {
  const int across = (field.width + factor - 1) / factor;
  const int down = (field.height + factor - 1) / factor;
  coarse.cells = int64_t{across} * down;
  for (int64_t p = 0; p < field.points; ++p) {
    const int64_t y = p / field.width / factor, x = p % field.width / factor;
    coarse.cell[p] = static_cast<int32_t>(y * across + x);
  }
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      coarse.neighbours.push_back(y * across + x);
      for (int v = std::max(0, y - 1); v <= std::min(down - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(across - 1, x + 1); ++u) {
          if (u != x || v != y) coarse.neighbours.push_back(v * across + u);
        }
      }
      coarse.first.push_back(static_cast<int64_t>(coarse.neighbours.size()));
    }
  }
}

void SingleCells(const Field& field, CoarseField& coarse) {
  coarse.cells = field.points;
  for (int64_t p = 0; p < field.points; ++p) {
    coarse.cell[p] = static_cast<int32_t>(p);
    coarse.neighbours.push_back(static_cast<int32_t>(p));
    coarse.first.push_back(p + 1);
  }
}

using Cube = std::array<int, 3>;
constexpr int kMostCubes = 1024;  // along a side

std::map<Cube, int32_t> Occupied(const std::vector<Cube>& cube_of_point) {
  std::map<Cube, int32_t> cells;
  for (const Cube& cube : cube_of_point) {
    cells.try_emplace(cube, static_cast<int32_t>(cells.size()));
  }
  return cells;
}

std::vector<Cube> CubesOf(const std::vector<Eigen::Vector3f>& positions,
                          const Eigen::Vector3d& corner, double side) {
  std::vector<Cube> cubes;
  cubes.reserve(positions.size());
  for (const Eigen::Vector3f& position : positions) {
    const Eigen::Vector3d at = (position.cast<double>() - corner) / side;
    cubes.push_back({static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z())});
  }
  return cubes;
}

// The largest side of extent, extent / 1.4, extent / 2, ... that leaves enough cells.
std::vector<Cube> CubesForFactor(const Field& field, int factor) {
  Eigen::Vector3d low = field.positions[0].cast<double>(), high = low;
  for (const Eigen::Vector3f& position : field.positions) {
    if (!position.allFinite()) throw Error(field.name + ": a position is not finite");
    low = low.cwiseMin(position.cast<double>());
    high = high.cwiseMax(position.cast<double>());
  }
  const double extent = std::max((high - low).maxCoeff(), 1e-30);
  const auto wanted = static_cast<size_t>(field.points / (int64_t{factor} * factor));
  double cubes_across = 1;
  std::vector<Cube> cubes = CubesOf(field.positions, low, extent);
  while (Occupied(cubes).size() < wanted && cubes_across < kMostCubes) {
    cubes_across *= std::sqrt(2.0);
    cubes = CubesOf(field.positions, low, extent / cubes_across);
  }
  return cubes;
}

void SpaceCells(const Field& field, int factor, CoarseField& coarse) {
  const std::vector<Cube> cubes = CubesForFactor(field, factor);
  const std::map<Cube, int32_t> cells = Occupied(cubes);
  coarse.cells = static_cast<int64_t>(cells.size());
  for (int64_t p = 0; p < field.points; ++p) coarse.cell[p] = cells.at(cubes[p]);
  std::vector<Cube> cube_of_cell(cells.size());
  for (const auto& [cube, cell] : cells) cube_of_cell[cell] = cube;
  for (int32_t c = 0; c < static_cast<int32_t>(cells.size()); ++c) {
    coarse.neighbours.push_back(c);
    for (int i = 0; i < 27; ++i) {
      const Cube& at = cube_of_cell[c];
      const auto found = cells.find({at[0] + i % 3 - 1, at[1] + i / 3 % 3 - 1, at[2] + i / 9 - 1});
      if (found != cells.end() && found->second != c) coarse.neighbours.push_back(found->second);
    }
    coarse.first.push_back(static_cast<int64_t>(coarse.neighbours.size()));
  }
}

void AverageRows(const Field& field, CoarseField& coarse) {
  std::vector<std::vector<int64_t>> points(static_cast<size_t>(coarse.cells));
  for (int64_t p = 0; p < field.points; ++p) points[coarse.cell[p]].push_back(p);
  coarse.rows = MakeFunctionRows(field.channels * coarse.cells, field.functions.columns);
  ParallelFor(
      0, coarse.rows.rows,
      [&](int64_t row) {
        const int channel = static_cast<int>(row / coarse.cells);
        const std::vector<int64_t>& members = points[row % coarse.cells];
        float* out = coarse.rows.Row(row);
        const float share = 1 / static_cast<float>(members.size());
        for (int64_t p : members) {
          const float* in = field.functions.Row(field.RowOf(p, channel));
          for (int j = 0; j < coarse.rows.columns; ++j) out[j] += share * in[j];
        }
      },
      16);
}

}  // namespace

CoarseField MakeCoarseField(const Field& field, int factor) {
  if (factor < 1) throw Error("coarse field: factor below 1");
  const bool picture = field.width > 0;
  if (field.functions.rows != field.points * field.channels ||
      (picture && int64_t{field.width} * field.height != field.points) ||
      (!field.positions.empty() && static_cast<int64_t>(field.positions.size()) != field.points)) {
    throw Error(field.name + ": its points, picture and rows do not fit together");
  }
  CoarseField coarse;
  coarse.cell.resize(static_cast<size_t>(field.points));
  coarse.first = {0};
  if (picture) {
    PictureCells(field, factor, coarse);
  } else if (field.positions.empty() || factor == 1) {
    SingleCells(field, coarse);
  } else {
    SpaceCells(field, factor, coarse);
  }
  AverageRows(field, coarse);
  return coarse;
}

}  // namespace lfm
