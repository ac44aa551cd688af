// SPDX-License-Identifier: BSD-3-Clause
#include "encode/nonnegative_terms.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encode/decoded_term.h"
#include "encode/nmf.h"
#include "encode/paper_factorization.h"

namespace lfm {
namespace {

constexpr int kRefitRounds = 40;
constexpr int kPaperIterations = 500;
constexpr double kPaperTolerance = 1e-4;

NmfResult ByPaper(const LinearMap& map, int terms) {
  NmfResult result;
  result.width = std::max(8, (terms + 7) / 8 * 8);
  result.left.assign(static_cast<size_t>(map.rows) * result.width, 0.f);
  result.right.assign(static_cast<size_t>(map.cols) * result.width, 0.f);
  if (!(map.max_abs > 0) || terms == 0) return result;
  // Rounding may leave entries just below zero.
  const Eigen::MatrixXf f = FormMatrix(map).cwiseMax(0.f);
  const PaperFactors<float> factors = PaperNmf<float>(
      f, {.terms = terms, .tolerance = kPaperTolerance, .max_iterations = kPaperIterations});
  result.terms = static_cast<int>(factors.left.cols());
  for (int k = 0; k < result.terms; ++k) {
    for (int row = 0; row < map.rows; ++row) {
      result.left[size_t{1} * row * result.width + k] = factors.left(row, k);
    }
    for (int col = 0; col < map.cols; ++col) {
      result.right[size_t{1} * col * result.width + k] =
          factors.right(col, k) * static_cast<float>(map.max_abs);
    }
  }
  return result;
}

NmfResult Solve(const LinearMap& map, const FactorizationOptions& options) {
  if (options.solver == PcaSolver::kFactored) return ComputeNmf(map, {.terms = options.terms});
  if (options.solver == PcaSolver::kPaper) return ByPaper(map, options.terms);
  throw Error(
      "--solver dense finds singular values; with --factorization nmf take factored or paper");
}

std::vector<float> Column(const std::vector<float>& matrix, int rows, int width, int column) {
  std::vector<float> values(rows);
  for (int row = 0; row < rows; ++row) values[row] = matrix[size_t{1} * row * width + column];
  return values;
}

// Quantises the surface map of term k; false where it has no light.
bool QuantizeTermSurface(const VertexOperator& f, const SharedSamples& shared, std::vector<float> u,
                         const std::vector<float>& v, TermMaps& maps, DecodedTerm& decoded) {
  ContinueIntoUnseen(f, shared, u);
  std::vector<PatchValues> patches;
  for (const RingBlock& block : f.blocks) {
    patches.push_back({u.data() + block.first_row, block.views > 0});
  }
  MakeContinuous(shared, 1, patches);
  for (float& value : u) value = std::max(value, 0.f);
  const Extent extent = SurfaceExtent(EdgeSamples(f), u);
  const float max_v = *std::max_element(v.begin(), v.end());
  if (!(extent.max_abs() > 0) || !(max_v > 0)) return false;
  const AlphaSplit split = SplitAlpha(extent.max_abs(), max_v);
  QuantizeSurface(EdgeSamples(f), shared, u, extent, split.surface, maps);
  DecodeSurface(f, maps, decoded);
  return DotProduct(decoded.surface, decoded.surface) > 0;
}

// All view maps, nonnegative and together, to the surface maps as they were quantised.
void RefitViews(const VertexOperator& f, std::vector<std::vector<float>> start,
                std::vector<TermMaps>& maps, std::vector<DecodedTerm>& terms) {
  const auto count = static_cast<int>(terms.size());
  Eigen::MatrixXd gram(count, count);
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) gram(a, b) = DotProduct(terms[a].surface, terms[b].surface);
  }
  std::vector<float> products(static_cast<size_t>(f.cols()) * count), views(products.size());
  for (int k = 0; k < count; ++k) {
    for (int col = 0; col < f.cols(); ++col) {
      products[size_t{1} * col * count + k] = static_cast<float>(terms[k].product[col]);
      views[size_t{1} * col * count + k] = start[k][col];
    }
  }
  DescendNonnegative(products, gram, count, kRefitRounds, views);
  for (int k = 0; k < count; ++k) {
    QuantizeView(Column(views, f.cols(), count, k), maps[k]);
    DecodeView(f, maps[k], terms[k]);
  }
}

}  // namespace

VertexTerms FactorizeNonnegative(const VertexOperator& f, const SharedSamples& shared,
                                 double mean_only_error, const FactorizationOptions& options) {
  const std::vector<float> column_scale = ColumnScale(f, options.guessed_weight);
  const double energy = ComputeEnergies(f, column_scale).plain;
  VertexTerms result;
  for (const RingBlock& block : f.blocks) {
    if (block.views > 0) result.entries += int64_t{block.samples} * f.cols();
  }
  result.squared_errors = {mean_only_error};
  result.singular_value_share.assign(options.terms, 0.0);
  const NmfResult nmf = Solve(ScaledMap(f, column_scale), options);
  std::vector<std::vector<float>> views;
  std::vector<DecodedTerm> decoded;
  for (int k = 0; k < nmf.terms; ++k) {
    std::vector<float> view = Column(nmf.right, f.cols(), nmf.width, k);
    for (size_t col = 0; col < view.size(); ++col) view[col] /= column_scale[col % f.directions];
    TermMaps maps;
    DecodedTerm term;
    if (!QuantizeTermSurface(f, shared, Column(nmf.left, f.rows, nmf.width, k), view, maps, term)) {
      continue;
    }
    // In the units of the quantised surface map, so that descent starts near its end.
    const double own = DotProduct(term.surface, term.surface);
    double overlap = 0;
    for (size_t col = 0; col < view.size(); ++col) overlap += term.product[col] * view[col];
    double norm = 0;
    for (const float value : view) norm += static_cast<double>(value) * value;
    const auto scale = static_cast<float>(std::max(overlap, 0.0) / std::max(own * norm, 1e-30));
    for (float& value : view) value *= scale;
    views.push_back(std::move(view));
    decoded.push_back(std::move(term));
    result.terms.push_back(std::move(maps));
  }
  if (result.terms.empty()) return result;
  RefitViews(f, std::move(views), result.terms, decoded);
  double error = energy;
  std::vector<DecodedTerm> before;
  const auto shows_nothing = [&](const DecodedTerm& term) {
    return !(DotProduct(term.view, term.view) > 0);
  };
  for (size_t k = decoded.size(); k-- > 0;) {
    if (!shows_nothing(decoded[k])) continue;
    decoded.erase(decoded.begin() + static_cast<std::ptrdiff_t>(k));
    result.terms.erase(result.terms.begin() + static_cast<std::ptrdiff_t>(k));
  }
  for (size_t k = 0; k < decoded.size(); ++k) {
    before.push_back(std::move(decoded[k]));
    const double change = ErrorChange(before);
    result.singular_value_share[k] = energy > 0 ? -change / energy : 0;
    error = std::max(error + change, 0.0);
    result.squared_errors.push_back(error);
  }
  return result;
}

}  // namespace lfm
