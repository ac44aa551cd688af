// SPDX-License-Identifier: BSD-3-Clause
#include "encode/vertex_factorization.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "encode/decoded_term.h"
#include "encode/precise_pca.h"
#include "encode/product_kernels.h"
#include "encode/quantization.h"

namespace lfm {
namespace {

constexpr double kInvisible = 0.5 / 255;
constexpr double kPcaTolerance = 1e-6;

// The leading direction of R, whose columns are F_p^T U: R mix is F_p^T (U mix).
Eigen::VectorXf LeadingMix(const std::vector<float>& remainder, int rows, int width) {
  Eigen::MatrixXd gram(width, width);
  kernels::Gram(remainder.data(), rows, width, gram.data());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  return solver.eigenvectors().col(width - 1).cast<float>();
}

std::vector<float> TimesVector(const std::vector<float>& x, int rows, int width,
                               const Eigen::VectorXf& v) {
  std::vector<float> y(rows);
  for (int r = 0; r < rows; ++r) {
    y[r] = Eigen::Map<const Eigen::VectorXf>(x.data() + size_t{1} * r * width, width).dot(v);
  }
  return y;
}

// The captured subspace, with surface maps made equal on shared samples, and F^T of it.
struct Subspace {
  int width = 8;
  std::vector<float> left;   // M x width, orthonormal, continuous over the ring
  std::vector<float> right;  // 3N x width, (F D)^T left
};

// Continuity is a linear condition: making the whole basis continuous first, rather than each term
// afterwards, leaves the best continuous terms to be found inside.
Subspace MakeContinuousSubspace(const VertexOperator& f, const LinearMap& scaled,
                                const SharedSamples& shared, PcaResult pca) {
  Subspace space{pca.width, std::move(pca.left), std::move(pca.right)};
  std::vector<PatchValues> patches;
  for (const RingBlock& block : f.blocks) {
    patches.push_back(
        {space.left.data() + size_t{1} * block.first_row * space.width, block.views > 0});
  }
  MakeContinuous(shared, space.width, patches);
  Orthonormalize(space.left, f.rows, space.width);
  scaled.multiply_transposed(space.left.data(), space.width, space.right.data());
  return space;
}

// The least squares view map of the remainder that the earlier quantised terms left.
void FitView(const VertexOperator& f, const std::vector<DecodedTerm>& earlier, TermMaps& maps,
             DecodedTerm& decoded) {
  std::vector<double> fit = decoded.product;
  for (const DecodedTerm& term : earlier) {
    const double overlap = DotProduct(term.surface, decoded.surface);
    for (int col = 0; col < f.cols(); ++col) fit[col] -= overlap * term.view[col];
  }
  const double norm = DotProduct(decoded.surface, decoded.surface);
  std::vector<float> view(f.cols());
  for (int col = 0; col < f.cols(); ++col) view[col] = static_cast<float>(fit[col] / norm);
  QuantizeView(view, maps);
  DecodeView(f, maps, decoded);
}

// R becomes F_{p+1}^T U: minus D v (u^T U).
void Deflate(const DecodedTerm& term, const std::vector<float>& column_scale, const Subspace& space,
             std::vector<float>& remainder) {
  Eigen::VectorXf overlap = Eigen::VectorXf::Zero(space.width);
  for (size_t row = 0; row < term.surface.size(); ++row) {
    overlap += term.surface[row] * Eigen::Map<const Eigen::VectorXf>(
                                       space.left.data() + row * space.width, space.width);
  }
  for (size_t col = 0; col < term.view.size(); ++col) {
    Eigen::Map<Eigen::VectorXf>(remainder.data() + col * space.width, space.width) -=
        (term.view[col] * column_scale[col % column_scale.size()]) * overlap;
  }
}

// The next term's surface map u, not yet scaled, and the extents of u and v; none when no 8-bit
// level would change.
struct Candidate {
  std::vector<float> surface;
  Extent extent;
  AlphaSplit split;
};
std::optional<Candidate> NextTerm(const VertexOperator& f, const SharedSamples& shared,
                                  const Subspace& space, const std::vector<float>& remainder,
                                  const std::vector<float>& column_scale) {
  Eigen::VectorXf mix = LeadingMix(remainder, f.cols(), space.width);
  Candidate next;
  next.surface = TimesVector(space.left, f.rows, space.width, mix);
  // Singular vectors have no sign of their own: mostly positive surface maps are easier to look at.
  double sum = 0;
  for (const float value : next.surface) sum += value;
  if (sum < 0) {
    mix = -mix;
    for (float& value : next.surface) value = -value;
  }
  const std::vector<float> view = TimesVector(remainder, f.cols(), space.width, mix);
  Extent view_extent;
  for (size_t col = 0; col < view.size(); ++col) {
    view_extent.Include(view[col] / column_scale[col % column_scale.size()]);
  }
  ContinueIntoUnseen(f, shared, next.surface);
  next.extent = SurfaceExtent(EdgeSamples(f), next.surface);
  const double max_u = next.extent.max_abs(), max_v = view_extent.max_abs();
  if (!(max_u * max_v > kInvisible)) return std::nullopt;
  next.split = SplitAlpha(max_u, max_v);
  return next;
}

}  // namespace

std::vector<float> ColumnScale(const VertexOperator& f, double guessed_weight) {
  std::vector<double> seen(f.directions, 0.0);
  double samples = 0;
  for (const RingBlock& block : f.blocks) {
    if (block.views == 0) continue;
    samples += block.samples;
    for (int q = 0; q < f.directions; ++q) seen[q] += block.seen[q] ? block.samples : 0;
  }
  std::vector<float> scale(f.directions, 1.f);
  if (samples == 0) return scale;
  for (int q = 0; q < f.directions; ++q) {
    const double share = seen[q] / samples;
    scale[q] = static_cast<float>(std::sqrt(guessed_weight + (1 - guessed_weight) * share));
  }
  return scale;
}

VertexTerms FactorizeVertex(const VertexOperator& f, const SharedSamples& shared,
                            const FactorizationOptions& options) {
  const std::vector<float> column_scale = ColumnScale(f, options.guessed_weight);
  const Energies energies = ComputeEnergies(f, column_scale);
  VertexTerms result;
  for (const RingBlock& block : f.blocks) {
    if (block.views > 0) result.entries += int64_t{block.samples} * f.cols();
  }
  result.squared_errors = {energies.plain};
  result.singular_value_share.assign(options.terms, 0.0);
  const LinearMap scaled = ScaledMap(f, column_scale);
  PcaResult pca =
      options.precision == Precision::kDouble
          ? RoundedToFloat(ComputePrecisePca(PreciseScaledMap(f, column_scale), options.terms),
                           f.rows, f.cols())
          : SolvePca(scaled, {.terms = options.terms, .tolerance = kPcaTolerance}, options.solver);
  for (int k = 0; k < pca.terms && energies.scaled > 0; ++k) {
    result.singular_value_share[k] =
        pca.singular_values[k] * pca.singular_values[k] / energies.scaled;
  }
  const int terms = pca.terms;
  if (terms == 0) return result;
  const Subspace space = MakeContinuousSubspace(f, scaled, shared, std::move(pca));
  std::vector<float> remainder = space.right;
  std::vector<DecodedTerm> decoded;
  for (int k = 0; k < terms; ++k) {
    const auto next = NextTerm(f, shared, space, remainder, column_scale);
    if (!next) break;
    TermMaps maps;
    DecodedTerm term;
    QuantizeSurface(EdgeSamples(f), shared, next->surface, next->extent, next->split.surface, maps);
    DecodeSurface(f, maps, term);
    FitView(f, decoded, maps, term);
    Deflate(term, column_scale, space, remainder);
    decoded.push_back(std::move(term));
    result.terms.push_back(std::move(maps));
    result.squared_errors.push_back(
        std::max(result.squared_errors.back() + ErrorChange(decoded), 0.0));
  }
  return result;
}

}  // namespace lfm
