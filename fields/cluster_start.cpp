// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cluster_start.h"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <random>

#include "core/parallel.h"

namespace lfm {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr uint64_t kSeed = 2009;
constexpr int kRounds = 8;
constexpr int64_t kChunk = 128;

// Drawing by hand: the standard library's shuffle differs between implementations.
std::vector<int64_t> Shuffled(int64_t count) {
  std::vector<int64_t> order(static_cast<size_t>(count));
  std::iota(order.begin(), order.end(), int64_t{0});
  std::mt19937_64 random(kSeed);
  for (int64_t i = count - 1; i > 0; --i) {
    std::swap(order[i], order[random() % static_cast<uint64_t>(i + 1)]);
  }
  return order;
}

Matrix UnitRows(const ActiveRows& rows) {
  Matrix unit(rows.count(), rows.all.columns);
  ParallelFor(
      0, rows.count(),
      [&](int64_t i) {
        unit.row(i) =
            Eigen::Map<const Eigen::RowVectorXf>(rows.all.Row(rows.which[i]), rows.all.columns);
        unit.row(i) /= unit.row(i).cwiseAbs().maxCoeff();
        unit.row(i).normalize();
      },
      256);
  return unit;
}

// Rows drawn in turn, each as likely as the square of its distance to those before (k-means++).
Matrix FirstCenters(const Matrix& unit, int clusters) {
  Matrix centers(clusters, unit.cols());
  std::mt19937_64 random(kSeed);
  std::vector<float> squares(static_cast<size_t>(unit.rows()), 4);
  Eigen::Index drawn = static_cast<Eigen::Index>(random() % static_cast<uint64_t>(unit.rows()));
  for (int k = 0;; ++k) {
    centers.row(k) = unit.row(drawn);
    if (k + 1 == clusters) return centers;
    ParallelChunks(unit.rows(), kChunk, [&](int64_t begin, int64_t end, int64_t) {
      for (int64_t i = begin; i < end; ++i) {
        const float square = (unit.row(i) - centers.row(k)).squaredNorm();
        squares[i] = std::min(squares[i], square);
      }
    });
    double left = std::accumulate(squares.begin(), squares.end(), 0.0) *
                  (static_cast<double>(random() >> 11) * 0x1p-53);
    drawn = 0;
    while (drawn + 1 < unit.rows() && (left -= squares[drawn]) > 0) ++drawn;
  }
}

// The centre nearest to each unit row; of equals the first.
std::vector<uint16_t> Nearest(const Matrix& unit, const Matrix& centers) {
  std::vector<uint16_t> nearest(static_cast<size_t>(unit.rows()));
  const Eigen::RowVectorXf half_squares = 0.5f * centers.rowwise().squaredNorm().transpose();
  ParallelChunks(unit.rows(), kChunk, [&](int64_t begin, int64_t end, int64_t) {
    Matrix scores = unit.middleRows(begin, end - begin) * centers.transpose();
    scores.rowwise() -= half_squares;
    for (int64_t i = 0; i < scores.rows(); ++i) {
      Eigen::Index best = 0;
      scores.row(i).maxCoeff(&best);
      nearest[begin + i] = static_cast<uint16_t>(best);
    }
  });
  return nearest;
}

}  // namespace

std::vector<uint16_t> RandomClusters(int64_t rows, int clusters) {
  const std::vector<int64_t> order = Shuffled(rows);
  std::vector<uint16_t> cluster(static_cast<size_t>(rows));
  for (int64_t i = 0; i < rows; ++i) cluster[order[i]] = static_cast<uint16_t>(i % clusters);
  return cluster;
}

std::vector<uint16_t> SimilarClusters(const ActiveRows& rows, int clusters) {
  const Matrix unit = UnitRows(rows);
  Matrix centers = FirstCenters(unit, clusters);
  std::vector<uint16_t> nearest = Nearest(unit, centers);
  for (int round = 1; round < kRounds; ++round) {
    Matrix sums = Matrix::Zero(clusters, unit.cols());
    std::vector<int64_t> counts(static_cast<size_t>(clusters));
    for (int64_t i = 0; i < unit.rows(); ++i) {
      sums.row(nearest[i]) += unit.row(i);
      ++counts[nearest[i]];
    }
    for (int k = 0; k < clusters; ++k) {
      if (counts[k] > 0) centers.row(k) = sums.row(k) / static_cast<float>(counts[k]);
    }
    nearest = Nearest(unit, centers);
  }
  return nearest;
}

}  // namespace lfm
