// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/options.h"
#include "core/progress.h"
#include "fields/cost_model.h"
#include "fields/field.h"
#include "fields/patches.h"
#include "fields/slope_fit.h"

namespace lfm {

/// How far it is from one vertex to another.
enum class VertexDistance { kSpace, kEdges };

struct AnalysisOptions {
  double energy_share = 0.9995;
  double global_share = 0.999;
  int centers = 8;
  int min_area = 16, max_area = 2048;
  int steps_an_octave = 2;
  double octaves = 3;
  PatchShape shape = PatchShape::kDisc;
  VertexDistance distance = VertexDistance::kSpace;
  int global_rows = 2048;
  double black_share = 1e-3;
  int largest_block = 32;

  void Declare(OptionVisitor& v) {
    v.Number({"energy-share", "Share of a patch's energy that its dimensions hold.", "", 0, 1},
             energy_share);
    v.Number({"global-share", "The same for N, the basis of everything.", "", 0, 1}, global_share);
    v.Integer({"centers", "Patches are grown about so many points.", "", 1, 10000}, centers);
    v.Integer({"min-area", "Smallest patch.", "points", 1, 1 << 20}, min_area);
    v.Integer(
        {"max-area", "Largest patch; time grows with its square or more.", "points", 1, 1 << 20},
        max_area);
    v.Integer({"area-steps", "Patches an octave of area.", "", 1, 16}, steps_an_octave);
    v.Number({"slope-octaves", "Slopes are fitted to so many octaves, the largest.", "", 0.5, 20},
             octaves);
    v.Enumeration({"patch-shape", "Patches of a picture."}, {"disc", "square"}, shape);
    v.Enumeration({"vertex-distance", "Patches of a mesh grow through space or along edges."},
                  {"space", "edges"}, distance);
    v.Integer({"global-rows", "N is found from so many points, drawn at random.", "", 1, 1 << 20},
              global_rows);
    v.Number({"black-share",
              "Points with less than this share of the mean energy are background: alone they "
              "would show the dimensions of noise.",
              "", 0, 1},
             black_share);
    v.Integer({"largest-block",
               "Rendering cost of a picture in blocks of 1, 2, 4 ... up to so many pixels a side; "
               "0: not measured.",
               "px", 0, 1024},
              largest_block);
  }
};

/// Dimensionality against area about one centre (Mahajan 2007, Figure 7).
struct DimensionCurve {
  int64_t center = 0;
  std::vector<double> areas;       ///< points of each patch, ascending
  std::vector<double> dimensions;  ///< terms that hold the share
  /// Over the last octaves; nothing where there are not two patches with energy.
  std::optional<SlopeFit> slope;
};

/// What Section 5.1 sets a method's parameters by (fields/cost_model.h).
struct SizePrediction {
  Shrinkage shrinkage;  ///< into 2 parts for clusters, 4 for blocks; mu from the mean slope
  double pixels = 0;    ///< p* (Equation 27); 0: as small as can be; infinite: any patch may grow
};

/// A picture in blocks of one size (Figure 9a).
struct BlockCost {
  int side = 0;
  RenderingCost cost;
};

struct AnalysisResult {
  std::string name;
  int64_t points = 0, occupied = 0;
  int columns = 0;
  std::vector<DimensionCurve> curves;
  /// Mean over the centres that have a slope, and half the width of its 95 % interval by their
  /// spread; absent without any, or with one.
  std::optional<double> slope, slope_half_width;
  int64_t global_terms = 0;  ///< N
  int64_t global_rows = 0;   ///< from so many points
  std::vector<SizePrediction> predictions;
  std::vector<BlockCost> block_costs;  ///< by side; of pictures only
};

/// Grays of all occupied points: the mean over the channels of each, and which are occupied.
struct OccupiedField {
  FunctionRows rows;              ///< points x columns
  std::vector<uint8_t> occupied;  ///< a point
};
/// A point is occupied when the field's mask has it, it has more than `black_share` of the points'
/// mean energy, and, among pixels of light transport, does not see the light itself: one texel with
/// weight 1 and nothing else (such pixels do not count in the mean). Throws Error when a number is
/// not finite.
OccupiedField GrayOfField(const Field& field, double black_share);

/// Throws Error when a number is out of range or --max-area below --min-area.
void CheckAnalysisOptions(const AnalysisOptions& options);

/// Dimensions of patches growing about `centers` (empty: spread evenly, options.centers of them),
/// the slopes, N from random rows (fixed seed), what Equation 27 makes of them, and the measured
/// cost of blocks. `triangles`: of
/// a mesh, for VertexDistance::kEdges.
///
/// Extremes: nothing occupied gives no curve and N = 0; fewer points than the smallest area give
/// curves without patches; equal rows give dimension 1 and slope 0. Throws Error when options are
/// out of range, a centre is not occupied, or kEdges is asked for without triangles.
AnalysisResult AnalyzeField(const Field& field, const std::vector<Eigen::Vector3i>& triangles,
                            const std::vector<int64_t>& centers, const AnalysisOptions& options,
                            Progress& progress);

/// Everything above under the same names, and the local slopes.
nlohmann::json AnalysisToJson(const AnalysisResult& result);

/// Dimensionality against area on logarithmic axes, a curve a centre (at most eight), as SVG.
std::string AnalysisToSvg(const AnalysisResult& result);
/// Basis functions a pixel against the pixels of a block: overhead, per-pixel part and their sum
/// (Figures 2 and 9a), as SVG.
std::string BlockCostsToSvg(const AnalysisResult& result);

/// A line a finding.
std::vector<std::string> Findings(const AnalysisResult& result);

}  // namespace lfm
