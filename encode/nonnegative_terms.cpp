// SPDX-License-Identifier: BSD-3-Clause
#include "encode/nonnegative_terms.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/error.h"
#include "encode/decoded_term.h"
#include "encode/nmf.h"
#include "encode/paper_factorization.h"
#include "encode/product_kernels.h"

namespace lfm {
namespace {

constexpr int kRefitRounds = 40, kAfterRoundingRounds = 8;
constexpr double kKeepApart = 1e-6;  // terms that have become alike
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

// One term on its way into codes.
struct QuantizedTerm {
  TermMaps maps;
  DecodedTerm decoded;
  std::vector<float> view;  ///< as it fits the decoded surface map
};

// The surface map in codes; none where it has no light. `u` becomes what the codes mean.
std::optional<QuantizedTerm> QuantizeTermSurface(const VertexOperator& f,
                                                 const SharedSamples& shared, std::vector<float>& u,
                                                 const std::vector<float>& v) {
  ContinueIntoUnseen(f, shared, u);
  std::vector<PatchValues> patches;
  for (const RingBlock& block : f.blocks) {
    patches.push_back({u.data() + block.first_row, block.views > 0});
  }
  MakeContinuous(shared, 1, patches);
  for (float& value : u) value = std::max(value, 0.f);
  const Extent extent = SurfaceExtent(EdgeSamples(f), u);
  const float max_v = *std::max_element(v.begin(), v.end());
  if (!(extent.max_abs() > 0) || !(max_v > 0)) return std::nullopt;
  const AlphaSplit split = SplitAlpha(extent.max_abs(), max_v);
  QuantizedTerm term;
  QuantizeSurface(EdgeSamples(f), shared, u, extent, split.surface, term.maps);
  DecodeSurface(f, term.maps, term.decoded);
  if (!(DotProduct(term.decoded.surface, term.decoded.surface) > 0)) return std::nullopt;
  for (size_t row = 0; row < u.size(); ++row) {
    u[row] = static_cast<float>(term.decoded.surface[row] / split.surface);
  }
  for (const float value : v) term.view.push_back(static_cast<float>(value * split.view));
  return term;
}

// What the rounding of factor k costs, the later factors take back as far as they can: least
// squares beside their partners (whose products are `partner_gram`) gives each the same multiple of
// it in every row.
void TakeBackRounding(const Eigen::MatrixXd& partner_gram, int k,
                      const std::vector<float>& rounding,
                      std::vector<std::vector<float>>& factors) {
  const auto later = static_cast<int>(factors.size()) - k - 1;
  if (later == 0) return;
  Eigen::MatrixXd gram = partner_gram.bottomRightCorner(later, later);
  gram.diagonal() *= 1 + kKeepApart;
  const Eigen::VectorXd share = gram.ldlt().solve(partner_gram.col(k).tail(later));
  if (!share.allFinite()) return;
  for (int l = 0; l < later; ++l) {
    std::vector<float>& factor = factors[k + 1 + l];
    for (size_t row = 0; row < factor.size(); ++row) {
      factor[row] -= static_cast<float>(share[l]) * rounding[row];
    }
  }
}

Eigen::MatrixXd GramOf(const std::vector<float>& matrix, int rows, int width, int terms) {
  Eigen::MatrixXd gram(width, width);
  kernels::Gram(matrix.data(), rows, width, gram.data());
  return gram.topLeftCorner(terms, terms);
}

// Surface maps one after the other; each is rounded while those that follow can still make up for
// it.
std::vector<QuantizedTerm> QuantizeSurfaces(const VertexOperator& f, const SharedSamples& shared,
                                            const NmfResult& nmf,
                                            const std::vector<float>& column_scale) {
  const Eigen::MatrixXd gram = GramOf(nmf.right, f.cols(), nmf.width, nmf.terms);
  std::vector<std::vector<float>> surfaces;
  for (int k = 0; k < nmf.terms; ++k) surfaces.push_back(Column(nmf.left, f.rows, nmf.width, k));
  std::vector<QuantizedTerm> terms;
  for (int k = 0; k < nmf.terms; ++k) {
    std::vector<float> view = Column(nmf.right, f.cols(), nmf.width, k);
    for (size_t col = 0; col < view.size(); ++col) view[col] /= column_scale[col % f.directions];
    std::vector<float> rounding = surfaces[k];
    auto term = QuantizeTermSurface(f, shared, surfaces[k], view);
    if (!term) continue;
    for (size_t row = 0; row < rounding.size(); ++row) {
      rounding[row] = surfaces[k][row] - rounding[row];
    }
    TakeBackRounding(gram, k, rounding, surfaces);
    terms.push_back(std::move(*term));
  }
  return terms;
}

// All view maps, nonnegative and together, to the surface maps as they were quantised; then in
// codes one after the other, each time fitting those that are left.
void RefitViews(const VertexOperator& f, std::vector<QuantizedTerm>& terms) {
  const auto count = static_cast<int>(terms.size());
  std::vector<std::vector<float>> remainders;
  for (const QuantizedTerm& term : terms) {
    remainders.emplace_back(term.decoded.product.begin(), term.decoded.product.end());
  }
  for (int first = 0; first < count; ++first) {
    const int left = count - first;
    Eigen::MatrixXd gram(left, left);
    std::vector<float> products(static_cast<size_t>(f.cols()) * left), views(products.size());
    for (int a = 0; a < left; ++a) {
      for (int b = 0; b < left; ++b) {
        gram(a, b) = DotProduct(terms[first + a].decoded.surface, terms[first + b].decoded.surface);
      }
      for (int col = 0; col < f.cols(); ++col) {
        products[size_t{1} * col * left + a] = remainders[first + a][col];
        views[size_t{1} * col * left + a] = terms[first + a].view[col];
      }
    }
    DescendNonnegative(products, gram, left, first == 0 ? kRefitRounds : kAfterRoundingRounds,
                       views);
    for (int k = 0; k < left; ++k) terms[first + k].view = Column(views, f.cols(), left, k);
    QuantizeView(terms[first].view, terms[first].maps);
    DecodeView(f, terms[first].maps, terms[first].decoded);
    for (int k = 1; k < left; ++k) {
      for (int col = 0; col < f.cols(); ++col) {
        remainders[first + k][col] -=
            static_cast<float>(gram(0, k)) * terms[first].decoded.view[col];
      }
    }
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
  std::vector<QuantizedTerm> terms = QuantizeSurfaces(f, shared, nmf, column_scale);
  RefitViews(f, terms);
  std::erase_if(terms, [](const QuantizedTerm& term) {
    return !(DotProduct(term.decoded.view, term.decoded.view) > 0);
  });
  double error = energy;
  std::vector<DecodedTerm> before;
  for (size_t k = 0; k < terms.size(); ++k) {
    result.terms.push_back(std::move(terms[k].maps));
    before.push_back(std::move(terms[k].decoded));
    const double change = ErrorChange(before);
    result.singular_value_share[k] = energy > 0 ? -change / energy : 0;
    error = std::max(error + change, 0.0);
    result.squared_errors.push_back(error);
  }
  return result;
}

}  // namespace lfm
