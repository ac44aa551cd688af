// SPDX-License-Identifier: BSD-3-Clause
#include "bench/yamada_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include "bench/field_errors.h"
#include "core/atomic_file.h"
#include "core/line_chart.h"
#include "fields/clustered_pca.h"
#include "fields/residual.h"
#include "fields/stored_numbers.h"

namespace lfm {
namespace {

const std::vector<double> kPercents = {0, 3, 5, 10, 20, 30};

// 0 to 30 % of the lights, finer where the errors fall fast.
std::vector<int> CurveCounts(const YamadaField& data) {
  std::vector<int> counts;
  const int last = data.Residuals(30);
  for (int n = 0; n < last; n += n < 16 ? 2 : n < 32 ? 4 : 8) counts.push_back(n);
  counts.push_back(last);
  return counts;
}

std::string Name(const YamadaConfiguration& c) {
  return std::to_string(c.clusters) + " clusters, " + std::to_string(c.terms) + " terms";
}

void WriteChart(const YamadaField& data, const std::string& name, const LineChart& chart) {
  WriteFileAtomically(data.out / (name + ".svg"), ChartToSvg(chart));
}

LineChart ErrorChart(const std::string& title) {
  return {title, "residual entries a row", "relative error", ChartScale::kLinear,
          {},    ChartScale::kLogarithmic};
}

void AddCurve(LineChart& chart, const std::string& name, const std::vector<int>& x,
              const std::vector<double>& y) {
  chart.curves.push_back({name, {x.begin(), x.end()}, y});
}

std::vector<int> TableCounts(const YamadaField& data) {
  std::vector<int> counts;
  for (double percent : kPercents) counts.push_back(data.Residuals(percent));
  return counts;
}

struct KindChart {
  const char* name;
  const std::vector<int64_t>* rows;
  LineChart chart;
};

std::vector<KindChart> Figure4Charts(const YamadaField& data) {
  const FunctionKinds& kinds = data.kinds;
  return {{"figure4a_object", &kinds.object, ErrorChart(data.field.name + ": all of the object")},
          {"figure4b_unoccluded", &kinds.unoccluded, ErrorChart(data.field.name + ": unoccluded")},
          {"figure4c_specular", &kinds.specular, ErrorChart(data.field.name + ": specular")}};
}

void PrintTableRow(const YamadaField& data, const YamadaConfiguration& c,
                   const ClusteredModel& model, const FrameRate& frame_rate) {
  const std::vector<int> counts = TableCounts(data);
  const std::vector<float> row_errors = RowErrors(model, data.field.functions.View(), counts);
  const std::vector<double> errors = MeanErrors(row_errors, counts.size(), data.kinds.object);
  std::printf("%-8s %4d %3d ", data.field.name.c_str(), c.clusters, c.terms);
  for (size_t i = 0; i < counts.size(); ++i) {
    char rate[16] = "-";
    if (frame_rate) std::snprintf(rate, sizeof rate, "%.0f", frame_rate(model, counts[i]));
    std::printf(" | %4s %.4f %6.2f", rate, errors[i],
                static_cast<double>(ModelBytes(model, counts[i])) * 1e-6);
  }
  std::printf("\n");
  std::fflush(stdout);
}

double ShareOfFloat16(const ClusteredModel& model, int residuals) {
  return static_cast<double>(ModelBytes(model, residuals)) /
         (2.0 * static_cast<double>(model.rows) * model.columns);
}

// Where the ratio of two error curves falls below 1 for good; -1: never.
int Crossing(const std::vector<int>& counts, const std::vector<double>& ratio) {
  int at = -1;
  for (size_t i = ratio.size(); i-- > 0 && ratio[i] < 1;) at = counts[i];
  return at;
}

struct Contender {
  std::string name;
  ClusteredModel model;
  int residuals = 0;
};

// Errors of the object's rows; the background has none.
std::vector<float> OfObject(const std::vector<float>& row_errors,
                            const std::vector<int64_t>& object) {
  std::vector<float> errors(row_errors.size(), -1.0f);
  for (const int64_t r : object) errors[r] = row_errors[r];
  return errors;
}

// One picture after another, from the left; a second row under it.
Image Beside(const std::vector<Image>& above, const std::vector<Image>& below) {
  const int width = above[0].width(), height = above[0].height();
  const int columns = static_cast<int>(std::max(above.size(), below.size()));
  Image sheet(width * columns, 2 * height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const auto place = [&](const Image& picture, int column, int row) {
    for (int y = 0; y < height; ++y) {
      std::memcpy(&sheet.At<uint8_t>(column * width, row * height + y), &picture.At<uint8_t>(0, y),
                  static_cast<size_t>(width) * 3);
    }
  };
  for (size_t i = 0; i < above.size(); ++i) place(above[i], static_cast<int>(i), 0);
  const size_t shift = static_cast<size_t>(columns) - below.size();
  for (size_t i = 0; i < below.size(); ++i) place(below[i], static_cast<int>(i + shift), 1);
  return sheet;
}

}  // namespace

int YamadaField::Residuals(double percent) const {
  return static_cast<int>(std::lround(percent / 100 * field.functions.columns));
}

ClusteredModel ClusteredPca(const Field& field, int clusters, int terms) {
  ClusterSearchOptions search;
  search.clusters = clusters;
  search.terms = terms;
  TermsOptions kept;
  kept.max_terms = terms;
  const RowsView rows = field.functions.View();
  return RoundToStored(ModelOfClusters(rows, ClusterRows(rows, search), kept));
}

ClusteredModel LeadingTerms(const ClusteredModel& model, int terms) {
  ClusteredModel fewer = model;
  fewer.weights.clear();
  for (FunctionRows& basis : fewer.bases) {
    basis.rows = std::min<int64_t>(basis.rows, terms);
    basis.values.resize(static_cast<size_t>(basis.rows * basis.stride));
  }
  for (int64_t r = 0; r < model.rows; ++r) {
    const auto from = model.weights.begin() + model.first_weight[r];
    fewer.first_weight[r] = static_cast<int64_t>(fewer.weights.size());
    fewer.weights.insert(fewer.weights.end(), from, from + fewer.Terms(r));
  }
  return fewer;
}

ClusteredModel SparseModel(const YamadaField& data, int clusters, int terms, Progress& progress) {
  SparseClusterOptions options;
  options.clusters = clusters;
  options.terms = terms;
  options.residuals = data.Residuals(30);
  options.residual_threshold = 0;
  return ClusterSparse(data.field, options, progress).model;
}

void PrintTable1(const YamadaField& data, const std::vector<YamadaConfiguration>& configurations,
                 const FrameRate& frame_rate, Progress& progress) {
  std::printf("Table 1. Frames a second, error (Equation 16, rows of the object), MB\n");
  std::printf("dataset  clus trm ");
  for (double percent : kPercents) std::printf(" | %15.0f %%  ", percent);
  std::printf("\n");
  const std::vector<int> counts = CurveCounts(data);
  std::vector<KindChart> charts = Figure4Charts(data);
  LineChart sparse = {data.field.name + ": sparseness of the residual",
                      "threshold",
                      "share of entries below",
                      ChartScale::kLogarithmic,
                      {},
                      ChartScale::kLinear};
  for (const YamadaConfiguration& c : configurations) {
    const ClusteredModel model = SparseModel(data, c.clusters, c.terms, progress);
    PrintTableRow(data, c, model, frame_rate);
    const std::vector<float> errors = RowErrors(model, data.field.functions.View(), counts);
    for (KindChart& kind : charts) {
      AddCurve(kind.chart, Name(c), counts, MeanErrors(errors, counts.size(), *kind.rows));
    }
    ChartCurve curve{Name(c), {}, {}};
    for (double threshold = 1.0 / 1024; threshold <= 1.0 / 16; threshold *= 2) {
      curve.x.push_back(threshold);
      curve.y.push_back(
          ResidualSparseness(model, data.field.functions.View(), threshold, data.kinds.object));
    }
    std::printf("         below 1/256: %.3f\n", curve.y[2]);
    sparse.curves.push_back(curve);
  }
  for (const KindChart& kind : charts) WriteChart(data, kind.name, kind.chart);
  WriteChart(data, "figure4d_sparseness", sparse);
}

void PrintFigure5(const YamadaField& data, const std::vector<YamadaConfiguration>& configurations,
                  Progress& progress) {
  const std::vector<int> counts = CurveCounts(data);
  LineChart chart = {data.field.name + ": error against clustered PCA's",
                     "residual entries a row",
                     "ratio of relative errors",
                     ChartScale::kLinear,
                     {},
                     ChartScale::kLinear};
  std::printf("\nFigure 5. Error, sparse / clustered PCA, with the same residual entries\n");
  for (const YamadaConfiguration& c : configurations) {
    const RowsView truth = data.field.functions.View();
    const ClusteredModel sparse = SparseModel(data, c.clusters, c.terms, progress);
    const ClusteredModel pca =
        WithResidual(ClusteredPca(data.field, c.clusters, c.terms), truth, {data.Residuals(30), 0});
    const auto of = [&](const ClusteredModel& model) {
      return MeanErrors(RowErrors(model, truth, counts), counts.size(), data.kinds.object);
    };
    const std::vector<double> a = of(sparse), b = of(pca);
    std::vector<double> ratio;
    for (size_t i = 0; i < a.size(); ++i) ratio.push_back(a[i] / b[i]);
    std::printf("%s:", Name(c).c_str());
    for (size_t i = 0; i < a.size(); i += 2) std::printf(" %d: %.3f", counts[i], ratio[i]);
    std::printf("; below 1 from %d on\n", Crossing(counts, ratio));
    std::fflush(stdout);
    AddCurve(chart, Name(c), counts, ratio);
  }
  WriteChart(data, "figure5_against_clustered_pca", chart);
}

void PrintFigure6(const YamadaField& data, Progress& progress) {
  constexpr int kClusters = 64, kStored = 16;
  const RowsView truth = data.field.functions.View();
  std::vector<Contender> contenders;
  contenders.push_back(
      {"PCA, best 16 of 64", LeadingTerms(ClusteredPca(data.field, kClusters, 64), kStored), 0});
  contenders.push_back({"PCA, 16", ClusteredPca(data.field, kClusters, kStored), 0});
  contenders.push_back(
      {"PCA, 4 + 12", WithResidual(ClusteredPca(data.field, kClusters, 4), truth, {12, 0}), 12});
  for (int terms : {4, 8, 16}) {
    contenders.push_back(
        {"sparse, " + std::to_string(terms) + " + " + std::to_string(kStored - terms),
         SparseModel(data, kClusters, terms, progress), kStored - terms});
  }
  std::printf(
      "\nFigure 6. Error with 64 clusters; object, unoccluded, specular; MB, ratio to "
      "float16\n");
  std::vector<std::vector<float>> errors;
  for (const Contender& c : contenders) {
    errors.push_back(RowErrors(c.model, truth, {c.residuals}));
    std::printf("%-20s", c.name.c_str());
    for (const auto* rows : {&data.kinds.object, &data.kinds.unoccluded, &data.kinds.specular}) {
      std::printf(" %.4f", MeanErrors(errors.back(), 1, *rows)[0]);
    }
    std::printf("  %.2f MB  %.1f %%\n",
                static_cast<double>(ModelBytes(c.model, c.residuals)) * 1e-6,
                100 * ShareOfFloat16(c.model, c.residuals));
    std::fflush(stdout);
  }
  constexpr double kFullScale = 0.2;
  std::vector<Image> maps, differences;
  for (size_t i = 0; i < contenders.size(); ++i) {
    if (i == 1 || i == 2) continue;
    errors[i] = OfObject(errors[i], data.kinds.object);
    maps.push_back(ErrorPicture(data.field, errors[i], 1, 0, kFullScale));
    if (i > 0)
      differences.push_back(DifferencePicture(data.field, errors[0], errors[i], kFullScale));
  }
  WriteImage(Beside(maps, differences), data.out / "figure6_errors.png");
}

void PrintHaar(const YamadaField& data, Progress& progress) {
  std::printf("\nHaar basis over the lights, 64 clusters, 4 terms\n");
  for (FunctionsBasis basis : {FunctionsBasis::kNone, FunctionsBasis::kHaar}) {
    SparseClusterOptions options;
    options.clusters = 64;
    options.residuals = data.Residuals(30);
    options.residual_threshold = 0;
    options.functions_basis = basis;
    const SparseClusterResult result = ClusterSparse(data.field, options, progress);
    const FunctionRows truth =
        result.haar ? ToHaar(*result.haar, data.field.functions) : data.field.functions;
    const std::vector<int> counts = TableCounts(data);
    const auto errors =
        MeanErrors(RowErrors(result.model, truth.View(), counts), counts.size(), data.kinds.object);
    std::printf("%-5s below 1/256: %.3f; error", result.haar ? "haar" : "none",
                ResidualSparseness(result.model, truth.View(), 1.0 / 256, data.kinds.object));
    for (size_t i = 0; i < counts.size(); ++i)
      std::printf(" %.0f %%: %.4f", kPercents[i], errors[i]);
    std::printf("\n");
  }
}

}  // namespace lfm
