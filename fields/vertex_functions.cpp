// SPDX-License-Identifier: BSD-3-Clause
#include "fields/vertex_functions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/cube_map.h"
#include "core/image.h"
#include "core/parallel.h"
#include "fields/matrix_room.h"

namespace lfm {
namespace {

constexpr int kChannels = 3;

// What triangles say of a vertex, summed: for each direction three channels and a count.
struct Tally {
  std::vector<double> sums;
  std::vector<int> counts;

  explicit Tally(int directions)
      : sums(static_cast<size_t>(directions) * kChannels),
        counts(static_cast<size_t>(directions)) {}
};

// The function of one vertex on the view grid, sRGB-coded.
struct GridFunction {
  std::vector<float> values;  // channel * directions + direction
  std::vector<uint8_t> seen;
  bool any = false;
};

int SampleOfCorner(int edge_samples, int corner) {
  if (corner == 0) return PatchSampleIndex(edge_samples, 0, 0);
  return corner == 1 ? PatchSampleIndex(edge_samples, edge_samples - 1, 0)
                     : PatchSampleIndex(edge_samples, 0, edge_samples - 1);
}

void AddCorner(const LightField& light_field, int triangle, int corner, Tally& seen, Tally& all) {
  const TrianglePatch patch = light_field.Patch(triangle);
  const size_t views = patch.photos.size();
  if (views == 0) return;
  LightField::WeightBuffer buffer;
  const ViewWeights weights = light_field.Weights(triangle, corner, buffer);
  const auto sample = static_cast<size_t>(SampleOfCorner(patch.edge_samples, corner));
  for (size_t q = 0; q < weights.seen.size(); ++q) {
    std::array<double, kChannels> rgb{};
    for (size_t k = 0; k < 3; ++k) {
      for (size_t c = 0; c < kChannels; ++c) {
        rgb[c] += static_cast<double>(weights.weight[3 * q + k]) *
                  patch.values[(sample * kChannels + c) * views + weights.view[3 * q + k]];
      }
    }
    for (Tally* tally : {&all, &seen}) {
      if (tally == &seen && weights.seen[q] == 0) continue;
      for (size_t c = 0; c < kChannels; ++c) tally->sums[q * kChannels + c] += rgb[c];
      ++tally->counts[q];
    }
  }
}

GridFunction FunctionOfVertex(const LightField& light_field, int64_t vertex,
                              std::span<const int> ring) {
  const int directions = light_field.grid() * light_field.grid();
  Tally seen(directions), all(directions);
  for (const int triangle : ring) {
    const Eigen::Vector3i& corners = light_field.mesh().triangles[static_cast<size_t>(triangle)];
    for (int corner = 0; corner < 3; ++corner) {
      if (corners[corner] == vertex) AddCorner(light_field, triangle, corner, seen, all);
    }
  }
  GridFunction function;
  function.values.assign(static_cast<size_t>(directions) * kChannels, 0.0F);
  function.seen.assign(static_cast<size_t>(directions), 0);
  for (size_t q = 0; q < static_cast<size_t>(directions); ++q) {
    const Tally& tally = seen.counts[q] > 0 ? seen : all;
    if (tally.counts[q] == 0) continue;
    function.any = true;
    function.seen[q] = seen.counts[q] > 0;
    const double scale = 1.0 / (static_cast<double>(LightField::kOne) * tally.counts[q]);
    for (size_t c = 0; c < kChannels; ++c) {
      function.values[c * static_cast<size_t>(directions) + q] =
          static_cast<float>(tally.sums[q * kChannels + c] * scale);
    }
  }
  return function;
}

// Where a direction of the world falls on a view grid: four entries and their weights; no weight
// below the horizon.
struct GridPlace {
  std::array<size_t, 4> entry{};
  std::array<double, 4> weight{};
  bool above = false;
};

GridPlace PlaceOf(DirectionMap map, int grid, const Eigen::Vector3d& direction_in_frame) {
  GridPlace place;
  const double lowest = map == DirectionMap::kHemiOctahedralSkirt ? -kSkirt : 0;
  if (direction_in_frame.z() < lowest) return place;
  place.above = true;
  const Eigen::Vector2d at = SquareFromDirection(map, direction_in_frame) * (grid - 1);
  const int x = std::clamp(static_cast<int>(at.x()), 0, grid - 2);
  const int y = std::clamp(static_cast<int>(at.y()), 0, grid - 2);
  const double u = std::clamp(at.x() - x, 0.0, 1.0), v = std::clamp(at.y() - y, 0.0, 1.0);
  for (int k = 0; k < 4; ++k) {
    const int dx = k % 2, dy = k / 2;
    place.entry[static_cast<size_t>(k)] = static_cast<size_t>((y + dy) * grid + x + dx);
    place.weight[static_cast<size_t>(k)] = (dx == 1 ? u : 1 - u) * (dy == 1 ? v : 1 - v);
  }
  return place;
}

GridFunction OnWorldCube(const LightField& light_field, int64_t vertex, const GridFunction& grid,
                         const std::vector<Eigen::Vector3d>& directions) {
  // A weight that only rounding makes larger than nothing asks for no entry to be seen.
  constexpr double kNothing = 1e-9;
  const Eigen::Matrix3d frame_from_world =
      light_field.vertex_frames()[static_cast<size_t>(vertex)].transpose();
  const size_t entries = grid.seen.size(), columns = directions.size();
  GridFunction cube;
  cube.any = grid.any;
  cube.values.assign(columns * kChannels, 0.0F);
  cube.seen.assign(columns, 0);
  if (!grid.any) return cube;
  for (size_t column = 0; column < columns; ++column) {
    const GridPlace place = PlaceOf(light_field.direction_map(), light_field.grid(),
                                    frame_from_world * directions[column]);
    if (!place.above) continue;
    cube.seen[column] = 1;
    for (size_t k = 0; k < 4; ++k) {
      if (place.weight[k] > kNothing && grid.seen[place.entry[k]] == 0) cube.seen[column] = 0;
    }
    for (size_t c = 0; c < kChannels; ++c) {
      double sum = 0;
      for (size_t k = 0; k < 4; ++k) {
        sum += place.weight[k] * grid.values[c * entries + place.entry[k]];
      }
      cube.values[c * columns + column] = static_cast<float>(sum);
    }
  }
  return cube;
}

std::vector<Eigen::Vector3d> DirectionsOf(const LightField& light_field,
                                          const VertexFunctionOptions& options) {
  std::vector<Eigen::Vector3d> directions;
  if (options.directions == VertexDirections::kFrameGrid) {
    const int grid = light_field.grid();
    for (int q = 0; q < grid * grid; ++q) {
      directions.push_back(GridDirection(light_field.direction_map(), grid, q));
    }
    return directions;
  }
  const CubeMap cube{options.cube_resolution};
  for (int t = 0; t < cube.Texels(); ++t) {
    directions.push_back(cube.Point(t, 0.5F, 0.5F).cast<double>().normalized());
  }
  return directions;
}

Field EmptyField(const LightField& light_field, const VertexFunctionOptions& options) {
  Field field;
  field.name = light_field.name();
  field.kind = FieldColumns::kViews;
  field.channels = kChannels;
  for (const Eigen::Vector3d& vertex : light_field.mesh().vertices) {
    field.positions.push_back(vertex.cast<float>());
  }
  field.points = static_cast<int64_t>(field.positions.size());
  field.directions = DirectionsOf(light_field, options);
  RequireRoom(field.points * kChannels, static_cast<int64_t>(field.directions.size()), field.name,
              "or take a smaller view-grid or vertex-cube");
  field.functions =
      MakeFunctionRows(field.points * kChannels, static_cast<int>(field.directions.size()));
  return field;
}

}  // namespace

VertexFunctions ReadVertexFunctions(const LightField& light_field,
                                    const VertexFunctionOptions& options, Progress& progress) {
  constexpr int64_t kChunk = 64;
  VertexFunctionOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  VertexFunctions result;
  result.field = EmptyField(light_field, options);
  Field& field = result.field;
  const auto columns = field.directions.size();
  result.seen.assign(static_cast<size_t>(field.points) * columns, 0);
  field.mask.assign(static_cast<size_t>(field.points), 0);
  const VertexRings rings = ComputeVertexRings(light_field.mesh());
  progress.Start("reading vertex functions", field.points);
  ParallelChunks(field.points, kChunk, [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t v = begin; v < end; ++v) {
      GridFunction function = FunctionOfVertex(light_field, v, rings.Ring(v));
      if (options.directions == VertexDirections::kWorldCube) {
        function = OnWorldCube(light_field, v, function, field.directions);
      }
      field.mask[static_cast<size_t>(v)] = function.any;
      std::copy(
          function.seen.begin(), function.seen.end(),
          result.seen.begin() + static_cast<std::ptrdiff_t>(v * static_cast<int64_t>(columns)));
      for (int c = 0; c < kChannels; ++c) {
        float* row = field.functions.Row(field.RowOf(v, c));
        const float* values = function.values.data() + static_cast<size_t>(c) * columns;
        for (size_t q = 0; q < columns; ++q) {
          row[q] = options.space == RadianceSpace::kLinear ? LinearFromSrgb(values[q]) : values[q];
        }
      }
    }
    progress.Advance(end - begin);
  });
  for (int64_t v = 0; v < field.points; ++v) {
    if (field.mask[static_cast<size_t>(v)] == 0) result.unseen_vertices.push_back(v);
  }
  if (result.unseen_vertices.empty()) field.mask.clear();
  return result;
}

}  // namespace lfm
