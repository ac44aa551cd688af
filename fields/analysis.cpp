// SPDX-License-Identifier: BSD-3-Clause
#include "fields/analysis.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/block_pca.h"
#include "fields/dimension.h"

namespace lfm {
namespace {

constexpr double kSeesLightTolerance = 1e-3;
constexpr uint64_t kGlobalSeed = 1;

double RowEnergy(const float* row, int columns) {
  double energy = 0;
  for (int c = 0; c < columns; ++c) energy += static_cast<double>(row[c]) * row[c];
  return energy;
}

bool SeesLightItself(const float* row, int columns) {
  double sum = 0, largest = 0;
  for (int c = 0; c < columns; ++c) {
    sum += std::abs(row[c]);
    largest = std::max<double>(largest, row[c]);
  }
  return std::abs(largest - 1) < kSeesLightTolerance && sum - largest < kSeesLightTolerance;
}

std::vector<Eigen::Vector3f> PlacesOf(const Field& field) {
  if (field.width == 0) return field.positions;
  std::vector<Eigen::Vector3f> places(field.points);
  for (int64_t point = 0; point < field.points; ++point) {
    places[point] = {static_cast<float>(point % field.width),
                     static_cast<float>(point / field.width), 0};
  }
  return places;
}

NestedPatches PatchesAbout(const Field& field, const std::vector<Eigen::Vector3i>& triangles,
                           const std::vector<uint8_t>& occupied, int64_t center,
                           const AnalysisOptions& options) {
  const PatchAreas areas{options.min_area, options.max_area, options.steps_an_octave};
  if (field.width > 0) {
    return PixelPatches(field.width, field.height, occupied, center, options.shape, areas);
  }
  if (options.distance == VertexDistance::kSpace) {
    return VertexPatches(field.positions, occupied, center, areas);
  }
  return GeodesicPatches(field.positions, triangles, occupied, center, areas);
}

DimensionCurve CurveOf(const FunctionRows& rows, const NestedPatches& patches,
                       const AnalysisOptions& options) {
  DimensionCurve curve;
  curve.center = patches.center;
  const FunctionRows gathered = GatherRows(rows.View(), patches.points);
  int expected = 0;
  for (const int64_t size : patches.sizes) {
    const RowsView patch{gathered.values.data(), size, gathered.columns, gathered.stride};
    expected = DimensionOf(patch, options.energy_share, expected);
    curve.areas.push_back(static_cast<double>(size));
    curve.dimensions.push_back(static_cast<double>(expected));
  }
  curve.slope = FitSlope(curve.areas, curve.dimensions, options.octaves);
  return curve;
}

// The first `count` of all points in a random order that every machine draws alike.
std::vector<int64_t> RandomPoints(const std::vector<uint8_t>& occupied, int64_t count) {
  std::vector<int64_t> points;
  for (size_t point = 0; point < occupied.size(); ++point) {
    if (occupied[point] != 0) points.push_back(static_cast<int64_t>(point));
  }
  std::mt19937_64 random(kGlobalSeed);
  const auto total = static_cast<int64_t>(points.size());
  const int64_t wanted = std::min(count, total);
  for (int64_t i = 0; i < wanted; ++i) {
    std::swap(points[i], points[i + static_cast<int64_t>(random() % (total - i))]);
  }
  points.resize(wanted);
  std::sort(points.begin(), points.end());
  return points;
}

void SummarizeSlopes(AnalysisResult& result) {
  std::vector<double> slopes;
  for (const DimensionCurve& curve : result.curves) {
    if (curve.slope) slopes.push_back(curve.slope->slope);
  }
  if (slopes.empty()) return;
  const auto n = static_cast<double>(slopes.size());
  const double mean = std::accumulate(slopes.begin(), slopes.end(), 0.0) / n;
  result.slope = mean;
  if (slopes.size() < 2) return;
  double squares = 0;
  for (const double slope : slopes) squares += (slope - mean) * (slope - mean);
  const int degrees = static_cast<int>(slopes.size()) - 1;
  result.slope_half_width = StudentFactor95(degrees) * std::sqrt(squares / degrees / n);
}

std::vector<SizePrediction> PredictSizes(double slope, int64_t global_terms) {
  std::vector<SizePrediction> predictions;
  for (const double parts : {2.0, 4.0}) {
    const Shrinkage shrinkage{parts, MuOfSlope(slope, parts)};
    predictions.push_back(
        {shrinkage, OptimalPatchPixels(shrinkage, static_cast<double>(global_terms))});
  }
  return predictions;
}

std::vector<BlockCost> CostsOfBlocks(const Field& field, const OccupiedField& gray,
                                     int64_t global_terms, const AnalysisOptions& options,
                                     Progress& progress) {
  std::vector<BlockCost> costs;
  RowsOfPicture picture{field.width, field.height, std::vector<int64_t>(field.points, -1)};
  for (int64_t point = 0; point < field.points; ++point) {
    if (gray.occupied[point] != 0) picture.row[point] = point;
  }
  for (int side = 1; side <= options.largest_block; side *= 2) {
    const BlockOptions blocks{options.energy_share, static_cast<double>(global_terms)};
    costs.push_back({side, FixedBlocks(gray.rows.View(), picture, side, blocks).cost});
    progress.Advance();
  }
  return costs;
}

}  // namespace

void CheckAnalysisOptions(const AnalysisOptions& options) {
  AnalysisOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  if (options.max_area < options.min_area) {
    throw Error("--max-area " + std::to_string(options.max_area) + " is below --min-area " +
                std::to_string(options.min_area));
  }
}

OccupiedField GrayOfField(const Field& field, double black_share) {
  RequireFinite(field.functions.View(), field.name.c_str());
  const int columns = field.functions.columns;
  const bool light_behind = field.kind == FieldColumns::kCubeTexels && field.width > 0;
  OccupiedField gray{MakeFunctionRows(field.points, columns),
                     std::vector<uint8_t>(field.points, 0)};
  std::vector<double> energies(field.points);  // 0: certainly not occupied
  ParallelFor(0, field.points, [&](int64_t point) {
    float* row = gray.rows.Row(point);
    for (int channel = 0; channel < field.channels; ++channel) {
      const float* values = field.functions.Row(field.RowOf(point, channel));
      for (int c = 0; c < columns; ++c) row[c] += values[c] / static_cast<float>(field.channels);
    }
    const bool counts = field.mask.empty() || field.mask[point] != 0;
    if (counts && !(light_behind && SeesLightItself(row, columns))) {
      energies[point] = RowEnergy(row, columns);
    }
  });
  double sum = 0;
  for (const double energy : energies) sum += energy;
  const auto lit = std::count_if(energies.begin(), energies.end(), [](double e) { return e > 0; });
  const double mean = lit > 0 ? sum / static_cast<double>(lit) : 0;
  for (int64_t point = 0; point < field.points; ++point) {
    gray.occupied[point] = energies[point] > black_share * mean;
  }
  return gray;
}

AnalysisResult AnalyzeField(const Field& field, const std::vector<Eigen::Vector3i>& triangles,
                            const std::vector<int64_t>& centers, const AnalysisOptions& options,
                            Progress& progress) {
  CheckAnalysisOptions(options);
  if (field.width == 0 && options.distance == VertexDistance::kEdges && triangles.empty()) {
    throw Error(field.name +
                ": there is no mesh along whose edges patches could grow; take --vertex-distance "
                "space");
  }
  const OccupiedField gray = GrayOfField(field, options.black_share);
  AnalysisResult result;
  result.name = field.name;
  result.points = field.points;
  result.columns = field.functions.columns;
  result.occupied = std::count(gray.occupied.begin(), gray.occupied.end(), uint8_t{1});
  const std::vector<int64_t> chosen =
      centers.empty() ? SpreadCenters(PlacesOf(field), gray.occupied, options.centers) : centers;
  progress.Start("dimensions", static_cast<int64_t>(chosen.size()) + 1);
  for (const int64_t center : chosen) {
    result.curves.push_back(CurveOf(
        gray.rows, PatchesAbout(field, triangles, gray.occupied, center, options), options));
    progress.Advance();
  }
  SummarizeSlopes(result);
  const std::vector<int64_t> random = RandomPoints(gray.occupied, options.global_rows);
  result.global_rows = static_cast<int64_t>(random.size());
  result.global_terms =
      DimensionOf(GatherRows(gray.rows.View(), random).View(), options.global_share);
  progress.Advance();
  if (result.slope) {
    result.predictions = PredictSizes(*result.slope, result.global_terms);
  }
  if (field.width > 0 && result.occupied > 0 && options.largest_block > 0) {
    progress.Start("cost of blocks", std::bit_width(static_cast<unsigned>(options.largest_block)));
    result.block_costs = CostsOfBlocks(field, gray, result.global_terms, options, progress);
  }
  return result;
}

}  // namespace lfm
