// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/cube_map.h"
#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

/// Light sums of the cells, and the solid angle that they were taken over.
struct CellSums {
  std::vector<Vector3d> energy;
  std::vector<double> solid_angle;
};

LightVector ToLightVector(const LightCells& cells, const CellSums& sums) {
  const auto count = static_cast<int>(cells.directions.size());
  LightVector light = MakeLightVector(count, 3);
  for (int i = 0; i < count; ++i) {
    double scale = 1;
    if (cells.kind == FieldColumns::kCubeTexels) {
      scale = sums.solid_angle[i] > 0 ? 1 / sums.solid_angle[i] : 0;
    }
    for (int c = 0; c < 3; ++c) {
      light.Channel(c)[i] = static_cast<float>(scale * sums.energy[i][c]);
    }
  }
  return light;
}

// The sum of a row from its left edge to `place` columns, over any number of turns.
Vector3d RowSum(const double* row, int columns, double place) {
  const double turns = std::floor(place / columns);
  const double inside = std::clamp(place - turns * columns, 0.0, static_cast<double>(columns));
  const int column = std::min(static_cast<int>(inside), columns - 1);
  const Eigen::Map<const Vector3d> left(row + 3 * column), right(row + 3 * (column + 1));
  const Eigen::Map<const Vector3d> all(row + 3 * columns);
  return left + (inside - column) * (right - left) + turns * all;
}

// Radiance out of one direction, that of the pixel there.
Vector3d RadianceAt(const LightProbe& probe, const Vector3d& direction) {
  const double azimuth = std::atan2(direction.y(), direction.x());
  const double polar = std::atan2(direction.head<2>().norm(), direction.z());
  const int row = std::min(static_cast<int>(polar / kPi * kProbeRows), kProbeRows - 1);
  const int column =
      std::min(static_cast<int>((0.5 - azimuth / (2 * kPi)) * probe.columns), probe.columns - 1);
  const double* at = &probe.sums[(static_cast<size_t>(row) * (probe.columns + 1) + column) * 3];
  const double solid_angle =
      2 * kPi / probe.columns *
      (std::cos(kPi * row / kProbeRows) - std::cos(kPi * (row + 1) / kProbeRows));
  return (Eigen::Map<const Vector3d>(at + 3) - Eigen::Map<const Vector3d>(at)) / solid_angle;
}

// Texels too small for a place of their own take the radiance at their middle.
void FillEmptyTexels(const LightCells& cells, const LightProbe& probe,
                     const Eigen::Matrix3d& probe_from_world, CellSums& sums) {
  if (cells.kind != FieldColumns::kCubeTexels) return;
  for (size_t i = 0; i < sums.energy.size(); ++i) {
    if (sums.solid_angle[i] > 0) continue;
    const Eigen::Vector3f middle = CubeMap{cells.cube_resolution}.Direction(static_cast<int>(i));
    sums.energy[i] = RadianceAt(probe, probe_from_world * middle.cast<double>());
    sums.solid_angle[i] = 1;
  }
}

}  // namespace

LightVector SampleProbe(const LightCells& cells, const LightProbe& probe, double turn_deg) {
  if (!std::isfinite(turn_deg)) throw Error("the surroundings are turned by no finite angle");
  const double shift = std::remainder(turn_deg, 360) / 360 * probe.columns;
  const double scale = static_cast<double>(probe.columns) / LightCells::kColumns;
  CellSums sums;
  sums.energy.assign(cells.directions.size(), Vector3d::Zero());
  sums.solid_angle = cells.solid_angle;
  for (int y = 0; y < kProbeRows; ++y) {
    const double* row = &probe.sums[static_cast<size_t>(y) * (probe.columns + 1) * 3];
    Vector3d before = RowSum(row, probe.columns, shift);
    for (int i = cells.first_run[y]; i < cells.first_run[y + 1]; ++i) {
      const bool last = i + 1 == cells.first_run[y + 1];
      const int end = last ? LightCells::kColumns : cells.runs[i + 1].begin;
      const Vector3d after = RowSum(row, probe.columns, end * scale + shift);
      if (cells.runs[i].light >= 0) {
        sums.energy[cells.runs[i].light] += (after - before).cwiseMax(0);
      }
      before = after;
    }
  }
  FillEmptyTexels(cells, probe,
                  Eigen::AngleAxisd(-turn_deg * kPi / 180, Vector3d::UnitZ()).toRotationMatrix(),
                  sums);
  return ToLightVector(cells, sums);
}

LightVector SampleProbeTurned(const LightCells& cells, const LightProbe& probe,
                              const Eigen::Matrix3d& world_from_probe) {
  if (!((world_from_probe * world_from_probe.transpose()).isIdentity(1e-6))) {
    throw Error("the surroundings are turned by no rotation");
  }
  constexpr int64_t kChunk = 1 << 15;
  const auto pixels = static_cast<int64_t>(probe.direction.size());
  std::vector<CellSums> chunks(static_cast<size_t>((pixels + kChunk - 1) / kChunk));
  const Eigen::Matrix3f turn = world_from_probe.cast<float>();
  ParallelChunks(pixels, kChunk, [&](int64_t begin, int64_t end, int64_t chunk) {
    CellSums& sums = chunks[chunk];
    sums.energy.assign(cells.directions.size(), Vector3d::Zero());
    sums.solid_angle.assign(cells.directions.size(), 0.0);
    for (int64_t i = begin; i < end; ++i) {
      const Eigen::Vector3f direction = turn * probe.direction[i];
      const int light = cells.kind == FieldColumns::kCubeTexels
                            ? CubeMap{cells.cube_resolution}.TexelOf(direction)
                            : cells.cube_light[CubeMap{LightCells::kFace}.TexelOf(direction)];
      if (light < 0) continue;
      sums.energy[light] += probe.energy[i].cast<double>();
      sums.solid_angle[light] += probe.solid_angle[i];
    }
  });
  CellSums sums = std::move(chunks[0]);
  for (size_t chunk = 1; chunk < chunks.size(); ++chunk) {
    for (size_t i = 0; i < sums.energy.size(); ++i) {
      sums.energy[i] += chunks[chunk].energy[i];
      sums.solid_angle[i] += chunks[chunk].solid_angle[i];
    }
  }
  FillEmptyTexels(cells, probe, world_from_probe.transpose(), sums);
  return ToLightVector(cells, sums);
}

LightVector SampleDirection(const LightCells& cells, const LightTriangulation& lights,
                            const Vector3d& to_light) {
  if (!to_light.allFinite() || !(to_light.norm() > 0)) {
    throw Error("the light's direction has no length, or is not finite");
  }
  LightVector light = MakeLightVector(static_cast<int>(cells.directions.size()), 1);
  const LightShares shares = InterpolateLights(lights, to_light / to_light.cwiseAbs().maxCoeff());
  for (int k = 0; k < 3; ++k) {
    if (shares.share[k] == 0) continue;
    const double unit = cells.kind == FieldColumns::kCubeTexels
                            ? CubeMap{cells.cube_resolution}.SolidAngle(shares.light[k])
                            : 1;
    light.values[shares.light[k]] += static_cast<float>(shares.share[k] / unit);
  }
  return light;
}

LightVector SampleCap(const LightCells& cells, const LightTriangulation& lights,
                      const Vector3d& to_light, double radius_deg) {
  if (!(radius_deg >= 0 && radius_deg <= 180)) {
    throw Error("a round light's radius must be 0 to 180 degrees");
  }
  if (radius_deg == 0) return SampleDirection(cells, lights, to_light);
  constexpr int kPlaces = 64;
  const LightVector middle = SampleDirection(cells, lights, to_light);  // checks the direction
  LightVector light = MakeLightVector(middle.directions, 1);
  const Vector3d axis = (to_light / to_light.cwiseAbs().maxCoeff()).normalized();
  const Vector3d x = axis.unitOrthogonal(), y = axis.cross(x);
  const double height = 1 - std::cos(radius_deg * kPi / 180);
  for (int i = 0; i < kPlaces; ++i) {
    const double z = 1 - height * (i + 0.5) / kPlaces, angle = i * kPi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const LightVector place = SampleDirection(
        cells, lights, z * axis + r * std::cos(angle) * x + r * std::sin(angle) * y);
    for (size_t k = 0; k < light.values.size(); ++k) light.values[k] += place.values[k] / kPlaces;
  }
  return light;
}

}  // namespace lfm
