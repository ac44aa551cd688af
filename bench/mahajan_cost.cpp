// SPDX-License-Identifier: BSD-3-Clause
// Costs of clustered and blockwise PCA, in the form of Mahajan 2007, Figures 8 and 9 and Section 5:
//   lfm-bench-mahajan-cost --data DIR --out DIR [--part face|street|sphere|time|all]
// DIR holds transport captures of lfm-capture: face, street. Tables go to standard output as
// Markdown, charts and pictures to OUT. Captures should be of direct light alone ("bounces": 0 in
// the scene) : the noise of bounced light has full rank, and N and n count it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/cost_curves.h"
#include "bench/phong_sphere.h"
#include "bench/transport_rows.h"
#include "core/atomic_file.h"
#include "core/command_line.h"
#include "fields/global_basis.h"

namespace lfm::bench {
namespace {

namespace fs = std::filesystem;

enum class Part { kAll, kFace, kStreet, kSphere, kTime };

struct CostOptions {
  std::string data = ".", out = ".", face = "face", street = "street";
  Part part = Part::kAll;
  double energy_percent = 99.9;
  int wavelets = 256;
  int centres = 12;
  int light_halvings = 0;
  RowLength length = RowLength::kCompact;
  SearchedRows searched = SearchedRows::kFull;

  void Declare(OptionVisitor& v) {
    v.Text({"data", "Folder of the captures."}, data);
    v.Text({"out", "Folder of charts and pictures."}, out);
    v.Text({"face", "Name of the capture of Figure 9."}, face);
    v.Text({"street", "Name of the capture of Figure 11."}, street);
    v.Enumeration({"part", "What is measured."}, {"all", "face", "street", "sphere", "time"}, part);
    v.Number({"energy", "Share of the energy that every patch holds.", "%", 1, 100},
             energy_percent);
    v.Integer({"wavelets", "Coefficients of the reduced rows.", "", 1, 1 << 20}, wavelets);
    v.Integer({"light-halvings", "Halve the cube map's resolution this often.", "", 0, 8},
              light_halvings);
    v.Enumeration({"rows", "Which rows are measured."}, {"full", "compact"}, length);
    v.Enumeration({"searched", "Which rows the cluster curves are searched by."},
                  {"full", "wavelets"}, searched);
    v.Integer({"centres", "Patches that mu is estimated from.", "", 1, 1000}, centres);
  }
};

void WriteChart(const CostOptions& options, const std::string& name, const std::string& svg) {
  WriteFileAtomically(fs::path(options.out) / (name + ".svg"), svg);
}

void PrintOptimum(const MeasuredField& field, const std::vector<CurvePoint>& curve, double parts,
                  int centres) {
  const double mu = MeasuredMu(field, parts, centres);
  std::printf(
      "\nr = %.0f: mu = %.3f, p* = N (r mu - 1) / (1 - mu) = %.0f pixels; measured minimum at "
      "%.0f pixels a patch (%s)\n",
      parts, mu, OptimalPatchPixels({parts, mu}, field.global_terms), Cheapest(curve).MeanPixels(),
      Cheapest(curve).name.c_str());
}

// Cluster counts of about these many pixels each.
std::vector<CurvePoint> ClusterCurve(const MeasuredField& field, SearchedRows searched,
                                     Progress& progress) {
  std::vector<CurvePoint> curve;
  for (const int pixels : {2400, 1200, 600, 300, 200, 120, 60, 30}) {
    const auto clusters = static_cast<int>(field.Full().rows / pixels);
    if (clusters > 1) curve.push_back(AtClusters(field, clusters, searched));
    progress.Advance();
  }
  return curve;
}

// Equation 17 and 18 against time and bytes; numbers do not matter, sizes do.
void PrintTimes(const std::vector<CurvePoint>& curve, int columns, double global_terms) {
  using Clock = std::chrono::steady_clock;
  std::printf(
      "\nEquations 17 and 18 against time (best of 9) and bytes\n\n"
      "| | n (p + l) | ms | ns a product | MB | n (p + N) | ms | ns a product |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const CurvePoint& point : curve) {
    ClusteredModel model;
    GlobalBasis global;
    model.columns = columns;
    global.functions = MakeFunctionRows(static_cast<int64_t>(global_terms), columns);
    for (size_t c = 0; c < point.sizes.size(); ++c) {
      model.bases.push_back(MakeFunctionRows(point.sizes[c].terms, columns));
      global.local.push_back(
          MakeFunctionRows(point.sizes[c].terms, static_cast<int>(global_terms)));
      model.cluster.insert(model.cluster.end(), point.sizes[c].pixels, static_cast<uint16_t>(c));
    }
    model.rows = static_cast<int64_t>(model.cluster.size());
    int64_t count = 0;
    for (int64_t row = 0; row < model.rows; ++row) {
      model.first_weight.push_back(count);
      count += model.Terms(row);
    }
    model.weights.assign(static_cast<size_t>(count), 0.5f);
    const std::vector<float> light(static_cast<size_t>(columns), 1);
    double best[2] = {1e9, 1e9};
    for (int i = 0; i < 9; ++i) {
      for (int way = 0; way < 2; ++way) {
        const auto start = Clock::now();
        const std::vector<float> lit = way == 0 ? Relit(model, light) : Relit(model, global, light);
        const std::chrono::duration<double> seconds = Clock::now() - start;
        best[way] = std::min(best[way], seconds.count());
      }
    }
    const double direct = CostOf(point.sizes, columns).Total();
    auto numbers = static_cast<double>(model.weights.size());
    for (const FunctionRows& basis : model.bases) {
      numbers += static_cast<double>(basis.rows) * basis.columns;
    }
    std::printf("| %s | %.3g | %.2f | %.2f | %.1f | %.3g | %.2f | %.2f |\n", point.name.c_str(),
                direct, 1e3 * best[0], 1e9 * best[0] / direct, 4e-6 * numbers, point.cost.Total(),
                1e3 * best[1], 1e9 * best[1] / point.cost.Total());
    std::fflush(stdout);
  }
}

TransportRows Read(const CostOptions& options, const std::string& name) {
  TransportRows rows = ReadTransportRows(fs::path(options.data) / name);
  for (int i = 0; i < options.light_halvings; ++i) rows = CoarserLight(rows);
  return rows;
}

void MeasureFace(const CostOptions& options, Progress& progress) {
  constexpr int kCurvePoints = 16;
  progress.Start("costs of the face", kCurvePoints);
  TransportRows rows = Read(options, options.face);
  TransportRows half = HalfSize(rows);
  const double share = options.energy_percent / 100;
  const MeasuredField small =
      MeasureField(std::move(half), share, options.wavelets, options.length);
  const MeasuredField field =
      MeasureField(std::move(rows), share, options.wavelets, options.length);
  std::vector<CurvePoint> blocks;
  for (const int side : {2, 4, 8, 16, 32}) blocks.push_back(AtBlocks(field, side));
  PrintCurve("Figure 9a: blocks of one size", blocks);
  PrintOptimum(field, blocks, 4, options.centres);
  WriteChart(options, "figure_9a", CurveToSvg("Blockwise PCA", blocks));
  PrintCurve("Quadtrees", {AtQuadtree(field, QuadtreeRule::kWhilePaying),
                           AtQuadtree(field, QuadtreeRule::kCheapest)});
  const std::vector<CurvePoint> large = ClusterCurve(field, options.searched, progress);
  PrintCurve("Figure 9b: clusters", large);
  PrintOptimum(field, large, 2, options.centres);
  WriteChart(options, "figure_9b", CurveToSvg("Clustered PCA", large));
  const std::vector<CurvePoint> less = ClusterCurve(small, options.searched, progress);
  PrintCurve("Figure 9c: half the resolution, pixels averaged two by two", less);
  PrintOptimum(small, less, 2, options.centres);
  const double mu = MeasuredMu(field, 2, options.centres);
  const double measured = Cheapest(large).cost.Total() / Cheapest(less).cost.Total();
  const double predicted = GrowthOfCost(mu, 2);
  std::printf(
      "\nFigure 9c: total cost grows by %.3f with four times the pixels; predicted 4 mu^2 = "
      "%.3f (%+.1f %%)\n",
      measured, predicted, 100 * (measured / predicted - 1));
  const CurvePoint adaptive = Adaptive(field);
  PrintCurve("Adaptive", {adaptive, AtClusters(field, adaptive.patches, SearchedRows::kWavelets),
                          AtClusters(field, adaptive.patches, SearchedRows::kFull)});
  PrintTimes(large, field.columns, field.global_terms);
}

void MeasureStreet(const CostOptions& options, Progress& progress) {
  const TransportRows all = Read(options, options.street);
  const MeasuredField field =
      MeasureField(SomeOf(all, RowsOfGround(all)), options.energy_percent / 100, options.wavelets,
                   options.length);
  const CurvePoint adaptive = Adaptive(field);
  PrintCurve("Section 5.2: the street's ground, adaptive", {adaptive});
  std::vector<CurvePoint> fixed;
  constexpr int kFixed = 5;
  progress.Start("fixed numbers of clusters", kFixed);
  for (const int clusters : {10, 50, 219, 5000, adaptive.patches}) {
    fixed.push_back(AtClusters(field, clusters, SearchedRows::kWavelets));
    progress.Advance();
  }
  fixed.push_back(AtClusters(field, adaptive.patches, SearchedRows::kFull));
  PrintCurve("Fixed numbers of clusters", fixed);
  for (const CurvePoint& point : fixed) {
    std::printf("%s: %.2f times the adaptive cost\n", point.name.c_str(),
                point.cost.Total() / adaptive.cost.Total());
  }
  const double mu = MeasuredMu(field, 2, options.centres);
  std::printf(
      "mu = %.3f, p* = %.0f, %.0f clusters\n", mu, OptimalPatchPixels({2, mu}, field.global_terms),
      static_cast<double>(field.Full().rows) / OptimalPatchPixels({2, mu}, field.global_terms));
}

// Sizes as Figure 9b has them: p pixels need n = 3 sqrt(p) terms.
void MeasureTime() {
  constexpr int kPixels = 38000, kColumns = 6144;
  constexpr double kGlobal = 150;
  std::vector<CurvePoint> curve;
  for (const int clusters : {10, 50, 220, 1000, 5000}) {
    const int pixels = kPixels / clusters;
    CurvePoint point;
    point.name = std::to_string(clusters) + " clusters";
    point.sizes.assign(clusters, {pixels, std::lround(3 * std::sqrt(pixels))});
    point.cost = CostOf(point.sizes, kGlobal);
    point.patches = clusters;
    curve.push_back(point);
  }
  PrintTimes(curve, kColumns, kGlobal);
}

void Measure(const CostOptions& options, Progress& progress) {
  fs::create_directories(options.out);
  const auto wanted = [&](Part part) { return options.part == Part::kAll || options.part == part; };
  if (wanted(Part::kSphere)) DrawPhongSphere(100, 80, fs::path(options.out) / "figure_8.png");
  if (wanted(Part::kTime)) MeasureTime();
  if (wanted(Part::kFace)) MeasureFace(options, progress);
  if (wanted(Part::kStreet)) MeasureStreet(options, progress);
}

}  // namespace
}  // namespace lfm::bench

int main(int argc, char** argv) {
  lfm::bench::CostOptions options;
  lfm::CommandLine command("lfm-bench-mahajan-cost",
                           "Measures the costs of clustered and blockwise PCA of light transport.",
                           "lfm-bench-mahajan-cost --data captures --out figures");
  command.Options(lfm::AnyOptions(options));
  return command.Run(argc, argv,
                     [&](lfm::Progress& progress) { lfm::bench::Measure(options, progress); });
}
