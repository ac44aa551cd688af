// SPDX-License-Identifier: BSD-3-Clause
#include "encode/view_refit.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/parallel.h"
#include "encode/decoded_term.h"
#include "encode/model_layout.h"
#include "encode/patch_resolution.h"
#include "encode/quantization.h"
#include "encode/vertex_factorization.h"
#include "encode/view_resolution.h"

namespace lfm {
namespace {

constexpr double kKeep = 1e-3;  // how much the present view maps count

VertexOperator OperatorOf(const LightFieldSource& source, const LightFieldModel& model,
                          std::span<const int> ring, int vertex) {
  return BuildVertexOperator(source, vertex, ring, [&](int triangle) {
    return MeanAtResolution(model, triangle, source.patch(triangle).edge_samples);
  });
}

FittedViews FitVertex(const LightFieldSource& source, const LightFieldModel& model,
                      std::span<const int> ring, int vertex, double guessed_weight) {
  const int terms = model.vertex_terms[vertex];
  FittedViews fitted;
  fitted.gram = Eigen::MatrixXd::Zero(terms, terms);
  if (terms == 0) return fitted;
  const VertexOperator f = OperatorOf(source, model, ring, vertex);
  for (const float scale : ColumnScale(f, guessed_weight)) {
    fitted.direction_weights.push_back(scale * scale);
  }
  std::vector<DecodedTerm> decoded(terms);
  for (int k = 0; k < terms; ++k) {
    const TermMaps maps = TermAtResolution(model, f, ring, vertex, k);
    DecodeSurface(f, maps, decoded[k]);
    fitted.views.push_back(DecodedView(maps, f.directions));
    for (int l = 0; l <= k; ++l) {
      fitted.gram(k, l) = fitted.gram(l, k) = DotProduct(decoded[k].surface, decoded[l].surface);
    }
  }
  if (model.mean_in_terms || !(fitted.gram.trace() > 0)) return fitted;
  const Eigen::VectorXd keep =
      (kKeep * fitted.gram.diagonal()).array() + 1e-12 * fitted.gram.trace();
  const Eigen::LLT<Eigen::MatrixXd> solver(fitted.gram + Eigen::MatrixXd(keep.asDiagonal()));
  for (int q = 0; q < f.directions; ++q) {
    for (int channel = 0; channel < 3; ++channel) {
      Eigen::VectorXd right(terms);
      for (int k = 0; k < terms; ++k) {
        right[k] = decoded[k].product[channel * f.directions + q] +
                   keep[k] * fitted.views[k][3 * q + channel];
      }
      const Eigen::VectorXd values = solver.solve(right);
      for (int k = 0; k < terms; ++k) {
        fitted.views[k][3 * q + channel] = static_cast<float>(values[k]);
      }
    }
  }
  return fitted;
}

// Sum over directions and channels of weight * a * b.
double Weighted(const std::vector<float>& weights, const std::vector<float>& a,
                const std::vector<float>& b) {
  double sum = 0;
  for (size_t q = 0; q < weights.size(); ++q) {
    double product = 0;
    for (size_t c = 0; c < 3; ++c) product += static_cast<double>(a[3 * q + c]) * b[3 * q + c];
    sum += weights[q] * product;
  }
  return sum;
}

// Unknowns: scale and bias of each term; the rest of the fitted map is left over.
std::vector<MapRange> FitRanges(const FittedViews& fitted,
                                const std::vector<std::vector<float>>& codes) {
  const int terms = static_cast<int>(codes.size());
  const std::vector<float> ones(codes.front().size(), 1.f);
  const auto basis = [&](int i) -> const std::vector<float>& {
    return i % 2 == 0 ? codes[i / 2] : ones;
  };
  Eigen::MatrixXd normal(2 * terms, 2 * terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * terms);
  for (int i = 0; i < 2 * terms; ++i) {
    for (int j = 0; j <= i; ++j) {
      normal(i, j) = normal(j, i) =
          fitted.gram(i / 2, j / 2) * Weighted(fitted.direction_weights, basis(i), basis(j));
    }
    for (int l = 0; l < terms; ++l) {
      right[i] +=
          fitted.gram(i / 2, l) * Weighted(fitted.direction_weights, basis(i), fitted.views[l]);
    }
  }
  normal.diagonal() *= 1 + 1e-9;
  normal.diagonal().array() += 1e-12 * normal.trace();
  const Eigen::VectorXd found = normal.ldlt().solve(right);
  std::vector<MapRange> ranges(terms);
  const double total = Weighted(fitted.direction_weights, ones, ones);
  for (int k = 0; k < terms; ++k) {
    const bool usable = found.allFinite() && found[2 * k] >= 0;
    const double mean =
        total > 0 ? Weighted(fitted.direction_weights, ones, fitted.views[k]) / total : 0;
    ranges[k] =
        usable ? MapRange{static_cast<float>(found[2 * k]), static_cast<float>(found[2 * k + 1])}
               : MapRange{0, static_cast<float>(mean)};
  }
  return ranges;
}

}  // namespace

std::vector<FittedViews> RefitViews(const LightFieldSource& source, const LightFieldModel& model,
                                    double guessed_weight) {
  const VertexRings rings = ComputeVertexRings(model.mesh);
  std::vector<FittedViews> views(model.vertex_terms.size());
  ParallelFor(0, static_cast<int64_t>(views.size()), [&](int64_t v) {
    const auto ring = rings.Ring(v);
    views[v] = FitVertex(source, model, ring, static_cast<int>(v), guessed_weight);
  });
  return views;
}

void WriteViews(const std::vector<FittedViews>& views, LightFieldModel& model) {
  const size_t vertices = views.size();
  ParallelFor(0, static_cast<int64_t>(vertices), [&](int64_t v) {
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      const LightFieldModel::TilePosition tile = model.ViewTile(k, static_cast<int>(v));
      const std::vector<float> view = ResamplerBetween(model.grid, tile.grid)(views[v].views[k]);
      const auto [low, high] = std::minmax_element(view.begin(), view.end());
      const MapRange range = ViewRange(*low, *high);
      model.view_ranges[k * vertices + v] = range;
      std::vector<uint8_t> codes;
      for (const float value : view) codes.push_back(QuantizeValue(range, value));
      WriteTile(codes, k, tile, model);
    }
  });
}

LightFieldModel FitViewRanges(LightFieldModel model, const std::vector<FittedViews>& views) {
  const size_t vertices = views.size();
  ParallelFor(0, static_cast<int64_t>(vertices), [&](int64_t v) {
    const int terms = model.vertex_terms[v];
    if (terms == 0 || !(views[v].gram.trace() > 0)) return;
    std::vector<std::vector<float>> codes;
    for (int k = 0; k < terms; ++k) {
      TermMaps maps = ReadVertexTerm(model, {}, static_cast<int>(v), k);
      maps.view_range = MapRange{};
      codes.push_back(DecodedView(maps, model.grid * model.grid));
    }
    const std::vector<MapRange> ranges = FitRanges(views[v], codes);
    for (int k = 0; k < terms; ++k) model.view_ranges[k * vertices + v] = ranges[k];
  });
  return model;
}

}  // namespace lfm
