// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cost_curves.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <utility>

#include "core/line_chart.h"
#include "fields/block_pca.h"
#include "fields/compact_rows.h"
#include "fields/matrix_products.h"

namespace lfm::bench {
namespace {

constexpr int kSearchTerms = 8, kIterations = 10;
constexpr int64_t kSample = 3000;

CurvePoint PointOf(std::string name, std::vector<PatchSize> sizes, double global_terms) {
  CurvePoint point;
  point.name = std::move(name);
  point.patches = static_cast<int>(sizes.size());
  point.cost = CostOf(sizes, global_terms);
  point.sizes = std::move(sizes);
  return point;
}

CurvePoint PointOf(std::string name, const BlockDivision& division, double global_terms) {
  std::vector<PatchSize> sizes;
  for (const Block& block : division.blocks) sizes.push_back(block.size);
  return PointOf(std::move(name), std::move(sizes), global_terms);
}

}  // namespace

MeasuredField MeasureField(TransportRows rows, double share, int wavelets, RowLength length) {
  constexpr int kExpected = 400;
  MeasuredField field;
  field.share = share;
  field.columns = rows.rows.columns;
  field.wavelets = ReduceByWavelets(rows.rows.View(), GridOfColumns(field.columns), wavelets);
  if (length == RowLength::kCompact) {
    rows.rows =
        CompactedRows(rows.rows.View(), RowEnergies(rows.rows.View()), (1 - share) / 100, kExpected)
            .coordinates;
  }
  field.source = std::move(rows);
  field.global_terms = static_cast<double>(GlobalTerms(field.Full(), kSample, share));
  std::printf(
      "\n%s: %ld rows, %d directions (%d coordinates), N = %.0f, %d wavelets hold %.2f %%\n",
      field.source.name.c_str(), static_cast<long>(field.Full().rows), field.columns,
      field.Full().columns, field.global_terms, field.wavelets.rows.columns,
      100 * field.wavelets.kept_share);
  std::fflush(stdout);
  return field;
}

CurvePoint AtClusters(const MeasuredField& field, int clusters, SearchedRows searched) {
  const bool full = searched == SearchedRows::kFull;
  const Clustering found =
      ClusterRows(full ? field.Full() : field.wavelets.rows.View(),
                  {.clusters = clusters, .terms = kSearchTerms, .iterations = kIterations});
  return PointOf((full ? "full rows, " : "wavelets, ") + std::to_string(clusters),
                 MeasureClusters(field.Full(), found, {.energy_share = field.share}),
                 field.global_terms);
}

CurvePoint AtBlocks(const MeasuredField& field, int side) {
  return PointOf(
      "blocks of " + std::to_string(side),
      FixedBlocks(field.Full(), field.source.picture, side, {field.share, field.global_terms}),
      field.global_terms);
}

CurvePoint AtQuadtree(const MeasuredField& field, QuadtreeRule rule) {
  return PointOf(rule == QuadtreeRule::kWhilePaying ? "quadtree while d > 0" : "cheapest quadtree",
                 DivideBlocks(field.Full(), field.source.picture,
                              {.rule = rule, .blocks = {field.share, field.global_terms}}),
                 field.global_terms);
}

CurvePoint Adaptive(const MeasuredField& field) {
  const AdaptiveClusters result = DivideClusters(
      field.Full(), field.wavelets.rows.View(),
      {.energy_share = field.share, .global_terms = field.global_terms, .iterations = kIterations});
  std::vector<PatchSize> sizes;
  for (const DivisionNode& node : result.nodes) {
    if (node.cluster >= 0) sizes.push_back(node.size);
  }
  return PointOf("adaptive", std::move(sizes), field.global_terms);
}

double MeasuredMu(const MeasuredField& field, double parts, int centres) {
  constexpr int64_t kLeast = 16, kMost = 1024;
  const std::vector<Eigen::Vector3f>& positions = field.source.positions;
  const auto rows = static_cast<int64_t>(positions.size());
  double sum = 0;
  for (int c = 0; c < centres; ++c) {
    const Eigen::Vector3f centre = positions[(2 * c + 1) * rows / (2 * centres)];
    std::vector<int64_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int64_t a, int64_t b) {
      return (positions[a] - centre).squaredNorm() < (positions[b] - centre).squaredNorm();
    });
    std::vector<PatchSize> patches;
    for (int64_t p = kLeast; p <= std::min(kMost, rows); p *= 2) {
      const std::vector<int64_t> nearest(order.begin(), order.begin() + p);
      patches.push_back({p, TermsNeeded(GatherRows(field.Full(), nearest).View(), field.share)});
    }
    sum += SlopeOfTerms(patches);
  }
  return MuOfSlope(sum / centres, parts);
}

const CurvePoint& Cheapest(const std::vector<CurvePoint>& curve) {
  return *std::min_element(curve.begin(), curve.end(), [](const auto& a, const auto& b) {
    return a.cost.Total() < b.cost.Total();
  });
}

void PrintCurve(const char* title, const std::vector<CurvePoint>& curve) {
  std::printf("\n%s\n\n| | patches | pixels a patch | overhead | per pixel | cost a pixel |\n",
              title);
  std::printf("|---|---|---|---|---|---|\n");
  for (const CurvePoint& point : curve) {
    const auto pixels = static_cast<double>(std::max<int64_t>(1, point.cost.pixels));
    std::printf("| %s | %d | %.0f | %.1f | %.1f | %.1f |\n", point.name.c_str(), point.patches,
                point.MeanPixels(), point.cost.overhead / pixels, point.cost.per_pixel / pixels,
                point.cost.PerPixel());
  }
  std::fflush(stdout);
}

std::string CurveToSvg(const std::string& title, const std::vector<CurvePoint>& curve) {
  LineChart chart = {.title = title,
                     .x_label = "pixels a patch",
                     .y_label = "basis functions a pixel",
                     .x_scale = ChartScale::kLogarithmic};
  std::vector<CurvePoint> sorted = curve;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.MeanPixels() < b.MeanPixels(); });
  chart.curves = {{"global to local", {}, {}}, {"local to pixel", {}, {}}, {"total", {}, {}}};
  for (const CurvePoint& point : sorted) {
    const auto pixels = static_cast<double>(std::max<int64_t>(1, point.cost.pixels));
    const double values[] = {point.cost.overhead / pixels, point.cost.per_pixel / pixels,
                             point.cost.PerPixel()};
    for (int i = 0; i < 3; ++i) {
      chart.curves[i].x.push_back(point.MeanPixels());
      chart.curves[i].y.push_back(values[i]);
    }
  }
  return ChartToSvg(chart);
}

}  // namespace lfm::bench
