// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "bench/transport_rows.h"
#include "fields/adaptive_clusters.h"
#include "fields/clustered_pca.h"
#include "fields/wavelet_reduction.h"

namespace lfm::bench {

/// What every measurement of a capture starts from.
struct MeasuredField {
  TransportRows source;  ///< rows: all directions, or coordinates
  int columns = 0;       ///< l of the full rows
  double share = 0.999;
  double global_terms = 0;  ///< N, from evenly drawn rows
  WaveletReduction wavelets;

  RowsView Full() const { return source.rows.View(); }
};

/// Whether rows are measured in coordinates that lose 1 % of what `share` leaves out: quicker where
/// the whole needs much fewer terms than there are directions.
enum class RowLength { kFull, kCompact };

MeasuredField MeasureField(TransportRows rows, double share, int wavelets, RowLength length);

/// A point of a cost curve.
struct CurvePoint {
  std::string name;
  int patches = 0;
  RenderingCost cost;
  std::vector<PatchSize> sizes;
  double MeanPixels() const { return patches > 0 ? static_cast<double>(cost.pixels) / patches : 0; }
};

enum class SearchedRows { kFull, kWavelets };

CurvePoint AtClusters(const MeasuredField& field, int clusters, SearchedRows searched);
CurvePoint AtBlocks(const MeasuredField& field, int side);
CurvePoint AtQuadtree(const MeasuredField& field, QuadtreeRule rule);
CurvePoint Adaptive(const MeasuredField& field);

/// mu of `parts` from patches round `centres` evenly drawn rows: the nearest 16, 32 ... 1024 rows
/// by position, one slope each; their mean (Section 5.1).
double MeasuredMu(const MeasuredField& field, double parts, int centres);

/// The cheapest point.
const CurvePoint& Cheapest(const std::vector<CurvePoint>& curve);

/// As a Markdown table on standard output.
void PrintCurve(const char* title, const std::vector<CurvePoint>& curve);
/// Overhead, per-pixel and total cost a pixel against the mean patch size.
std::string CurveToSvg(const std::string& title, const std::vector<CurvePoint>& curve);

}  // namespace lfm::bench
