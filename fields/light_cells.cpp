// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_cells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/cube_map.h"
#include "core/error.h"
#include "core/parallel.h"
#include "fields/light_probe.h"
#include "fields/light_triangulation.h"

namespace lfm {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

/// The lights, and where none reaches.
struct Reach {
  std::vector<Vector3d> directions;
  double cos_max = -1;                   ///< of the largest angle to the nearest light
  std::vector<Eigen::Matrix3d> between;  ///< edge normals of triangles that reach beyond it

  /// The first nearest of `candidates`, or -1.
  int Nearest(const Vector3d& direction, const std::vector<int>& candidates) const {
    int nearest = -1;
    double most = -2;
    for (const int i : candidates) {
      const double cosine = direction.dot(directions[i]);
      if (cosine > most) {
        most = cosine;
        nearest = i;
      }
    }
    if (most >= cos_max) return nearest;
    for (const Eigen::Matrix3d& normals : between) {
      if ((normals * direction).minCoeff() >= 0) return nearest;
    }
    return -1;
  }
};

Reach MakeReach(const std::vector<Vector3d>& directions, const LightCellOptions& options) {
  Reach reach;
  reach.directions = directions;
  const LightTriangulation lights = TriangulateLights(directions);
  if (options.max_angle_deg > 0) {
    reach.cos_max = options.max_angle_deg >= 180 ? -2 : std::cos(options.max_angle_deg * kPi / 180);
    return reach;
  }
  if (lights.Surrounds()) {
    reach.cos_max = -2;
    return reach;
  }
  reach.cos_max = std::cos(lights.median_radius);
  for (size_t i = 0; i < lights.triangles.size(); ++i) {
    if (lights.cap_radius[i] <= lights.median_radius) continue;
    const Eigen::Vector3i& t = lights.triangles[i];
    Eigen::Matrix3d normals;
    for (int k = 0; k < 3; ++k) {
      normals.row(k) = directions[t[k]].cross(directions[t[(k + 1) % 3]]);
    }
    reach.between.push_back(normals);
  }
  return reach;
}

// The lights of width x height directions, block by block: only lights that are nearest somewhere
// in a block come into question there.
std::vector<int> NearestLights(const Reach& reach, int width, int height,
                               const std::function<Vector3d(int, int)>& direction) {
  constexpr int kBlock = 16;
  std::vector<int> lights(static_cast<size_t>(width) * height);
  const int across = (width + kBlock - 1) / kBlock, down = (height + kBlock - 1) / kBlock;
  ParallelFor(0, int64_t{across} * down, [&](int64_t block) {
    const int x0 = static_cast<int>(block % across) * kBlock;
    const int y0 = static_cast<int>(block / across) * kBlock;
    const int x1 = std::min(x0 + kBlock, width), y1 = std::min(y0 + kBlock, height);
    std::vector<Vector3d> places;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) places.push_back(direction(x, y));
    }
    const Vector3d middle = direction((x0 + x1) / 2, (y0 + y1) / 2);
    double least = 1, most = -1;
    for (const Vector3d& place : places) least = std::min(least, middle.dot(place));
    for (const Vector3d& d : reach.directions) most = std::max(most, middle.dot(d));
    const double angle =
        std::acos(std::clamp(most, -1.0, 1.0)) + 2 * std::acos(std::clamp(least, -1.0, 1.0)) + 1e-6;
    const double bound = angle >= kPi ? -2 : std::cos(angle);
    std::vector<int> candidates;
    for (size_t i = 0; i < reach.directions.size(); ++i) {
      if (middle.dot(reach.directions[i]) >= bound) candidates.push_back(static_cast<int>(i));
    }
    auto place = places.begin();
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        lights[static_cast<size_t>(y) * width + x] = reach.Nearest(*place++, candidates);
      }
    }
  });
  return lights;
}

Vector3d RowDirection(int x, int y) {
  return ProbeDirection((x + 0.5) / LightCells::kColumns, (y + 0.5) / kProbeRows);
}

void AddRuns(const std::vector<int>& lights, LightCells& cells) {
  cells.solid_angle.assign(cells.directions.size(), 0.0);
  cells.first_run.push_back(0);
  for (int y = 0; y < kProbeRows; ++y) {
    const double pixel = 2 * kPi / LightCells::kColumns *
                         (std::cos(kPi * y / kProbeRows) - std::cos(kPi * (y + 1) / kProbeRows));
    for (int x = 0; x < LightCells::kColumns; ++x) {
      const int light = lights[static_cast<size_t>(y) * LightCells::kColumns + x];
      if (x == 0 || cells.runs.back().light != light) cells.runs.push_back({x, light});
      if (light >= 0) cells.solid_angle[light] += pixel;
    }
    cells.first_run.push_back(static_cast<int>(cells.runs.size()));
  }
}

int CubeResolution(size_t texels) {
  const int resolution = static_cast<int>(std::lround(std::sqrt(static_cast<double>(texels) / 6)));
  if (resolution < 1 || static_cast<size_t>(resolution) * resolution * 6 != texels) {
    throw Error(std::to_string(texels) + " columns are not the texels of a cube map");
  }
  return resolution;
}

}  // namespace

LightCells MakeLightCells(FieldColumns kind, const std::vector<Vector3d>& directions,
                          const LightCellOptions& options) {
  if (kind == FieldColumns::kViews) throw Error("directions towards the eye have no light");
  if (!(options.max_angle_deg >= 0 && options.max_angle_deg <= 180)) {
    throw Error("the largest angle to a light must be in (0, 180] degrees, or 0");
  }
  LightCells cells;
  cells.kind = kind;
  cells.directions = directions;
  constexpr int kFace = LightCells::kFace;
  if (kind == FieldColumns::kCubeTexels) {
    const int resolution = cells.cube_resolution = CubeResolution(directions.size());
    std::vector<int> texels;
    for (int y = 0; y < kProbeRows; ++y) {
      for (int x = 0; x < LightCells::kColumns; ++x) {
        texels.push_back(CubeMap{resolution}.TexelOf(RowDirection(x, y).cast<float>()));
      }
    }
    AddRuns(texels, cells);
    return cells;
  }
  const Reach reach = MakeReach(directions, options);
  AddRuns(NearestLights(reach, LightCells::kColumns, kProbeRows, RowDirection), cells);
  cells.cube_light = NearestLights(reach, kFace, 6 * kFace, [](int x, int y) {
    return CubeMap{kFace}.Direction(y * kFace + x).cast<double>().normalized();
  });
  return cells;
}

}  // namespace lfm
