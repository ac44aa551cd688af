// SPDX-License-Identifier: BSD-3-Clause
#include "encode/precise_pca.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encode/pseudo_random.h"

namespace lfm {
namespace {

constexpr int kChannels = 3, kMostPasses = 200;
constexpr double kTolerance = 1e-14, kDropSingularValue = 1e-14;

using RowMajorFloat = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd Centred(const RingBlock& block) {
  return Eigen::Map<const RowMajorFloat>(block.centred.data(), block.samples,
                                         Eigen::Index{kChannels} * block.views)
      .cast<double>();
}

// Calls visit(row of the views, row of the directions, weight) for each entry of W.
template <typename Visit>
void ForEachWeight(const RingBlock& block, int directions, const Visit& visit) {
  for (int c = 0; c < kChannels; ++c) {
    for (size_t e = 0; e < block.view.size(); ++e) {
      visit(c * block.views + block.view[e], c * directions + static_cast<int>(e / 3),
            static_cast<double>(block.weight[e]));
    }
  }
}

Eigen::MatrixXd Change(const RingBlock& block) {
  return Eigen::Map<const RowMajorFloat>(block.change.data(), 3,
                                         static_cast<Eigen::Index>(block.change.size() / 3))
      .cast<double>();
}

Eigen::MatrixXd Shares(const RingBlock& block) {
  return Eigen::Map<const RowMajorFloat>(block.shares.data(), block.samples, 3).cast<double>();
}

Eigen::VectorXd ScaleOfColumns(const VertexOperator& f, const std::vector<float>& column_scale) {
  Eigen::VectorXd scale(f.cols());
  for (int col = 0; col < f.cols(); ++col) scale[col] = column_scale[col % f.directions];
  return scale;
}

Eigen::MatrixXd RandomStart(int rows, int columns) {
  Eigen::MatrixXd x(rows, columns);
  PseudoRandom random;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) x(r, c) = random.Next();
  }
  return x;
}

Eigen::MatrixXd Orthonormal(const Eigen::MatrixXd& x) {
  if (!x.allFinite()) throw Error("PCA: the matrix holds values that are not finite");
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(x);
  return qr.householderQ() * Eigen::MatrixXd::Identity(x.rows(), x.cols());
}

}  // namespace

PreciseMap PreciseScaledMap(const VertexOperator& f, const std::vector<float>& column_scale) {
  const auto multiply = [&f, &column_scale](const Eigen::MatrixXd& x) {
    const Eigen::MatrixXd scaled = ScaleOfColumns(f, column_scale).asDiagonal() * x;
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(f.rows, x.cols());
    for (const RingBlock& block : f.blocks) {
      if (block.views == 0) continue;
      Eigen::MatrixXd by_view = Eigen::MatrixXd::Zero(kChannels * block.views, x.cols());
      ForEachWeight(block, f.directions, [&](int view, int direction, double weight) {
        by_view.row(view) += weight * scaled.row(direction);
      });
      y.middleRows(block.first_row, block.samples) = Centred(block) * by_view;
      if (block.change.empty()) continue;
      y.middleRows(block.first_row, block.samples) += Shares(block) * (Change(block) * scaled);
    }
    return y;
  };
  const auto multiply_transposed = [&f, &column_scale](const Eigen::MatrixXd& y) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(f.cols(), y.cols());
    for (const RingBlock& block : f.blocks) {
      if (block.views == 0) continue;
      const Eigen::MatrixXd by_view =
          Centred(block).transpose() * y.middleRows(block.first_row, block.samples);
      ForEachWeight(block, f.directions, [&](int view, int direction, double weight) {
        x.row(direction) += weight * by_view.row(view);
      });
      if (block.change.empty()) continue;
      x += Change(block).transpose() *
           (Shares(block).transpose() * y.middleRows(block.first_row, block.samples));
    }
    return Eigen::MatrixXd(ScaleOfColumns(f, column_scale).asDiagonal() * x);
  };
  return {f.rows, f.cols(), multiply, multiply_transposed};
}

PrecisePca ComputePrecisePca(const PreciseMap& map, int terms) {
  if (terms < 0 || terms > 16) throw Error("PCA: terms must lie in [0, 16]");
  PrecisePca result;
  const int columns = std::min({std::max(16, terms + 8), map.rows, map.cols});
  if (columns == 0 || terms == 0) return result;
  Eigen::MatrixXd right = RandomStart(map.cols, columns);
  for (double captured = 0;;) {
    const Eigen::MatrixXd left = Orthonormal(map.multiply(right));
    right = map.multiply_transposed(left);
    if (!right.allFinite()) throw Error("PCA: the matrix holds values that are not finite");
    // Of the triangular factor alone: F^T left may be thousands of rows high.
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(right);
    const Eigen::MatrixXd triangle = qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(triangle, Eigen::ComputeFullV);
    const Eigen::VectorXd& values = svd.singularValues();
    const double before = captured;
    captured = values.head(std::min(columns, terms)).squaredNorm();
    ++result.passes;
    right = right * svd.matrixV();
    if (captured - before > kTolerance * captured && result.passes < kMostPasses) {
      right /= values[0];  // products of products would leave the range of numbers
      continue;
    }
    int rank = 0;
    while (rank < columns && values[rank] > kDropSingularValue * values[0]) ++rank;
    result.left = (left * svd.matrixV()).leftCols(rank);
    result.right = right.leftCols(rank);
    result.singular_values = values.head(rank);
    result.terms = std::min(terms, rank);
    return result;
  }
}

PcaResult RoundedToFloat(const PrecisePca& pca, int rows, int cols) {
  PcaResult result;
  result.terms = pca.terms;
  result.rank = static_cast<int>(pca.singular_values.size());
  result.width = std::max(1, (result.rank + 7) / 8) * 8;
  result.passes = pca.passes;
  result.singular_values.assign(pca.singular_values.begin(), pca.singular_values.end());
  result.left.assign(static_cast<size_t>(rows) * result.width, 0.F);
  result.right.assign(static_cast<size_t>(cols) * result.width, 0.F);
  for (int k = 0; k < result.rank; ++k) {
    for (int r = 0; r < rows; ++r) {
      result.left[size_t{1} * r * result.width + k] = static_cast<float>(pca.left(r, k));
    }
    for (int c = 0; c < cols; ++c) {
      result.right[size_t{1} * c * result.width + k] = static_cast<float>(pca.right(c, k));
    }
  }
  return result;
}

}  // namespace lfm
