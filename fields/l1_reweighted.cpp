// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_reweighted.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "fields/orthonormal_basis.h"

namespace lfm {
namespace {

// What all rows share, as the kernels want it.
struct SharedBasis {
  OrthonormalBasis orthonormal;
  std::vector<float> functions, products;  // of the orthonormal functions
  std::vector<float> own;                  // the basis itself, columns x terms, scaled by powers
  std::vector<int> exponent;               // of 2, a function: own = basis * 2^-exponent
};

std::vector<float> PairProducts(const Eigen::MatrixXd& functions) {
  const int terms = static_cast<int>(functions.rows());
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < terms; ++i) {
    for (int k = i; k < terms; ++k) pairs.emplace_back(i, k);
  }
  std::vector<float> products;
  products.reserve(pairs.size() * functions.cols());
  for (size_t first = 0; first < pairs.size(); first += kernels::kL1Run) {
    const size_t last = std::min(first + kernels::kL1Run, pairs.size());
    for (Eigen::Index j = 0; j < functions.cols(); ++j) {
      for (size_t p = first; p < last; ++p) {
        products.push_back(
            static_cast<float>(functions(pairs[p].first, j) * functions(pairs[p].second, j)));
      }
    }
  }
  return products;
}

SharedBasis Share(RowsView basis) {
  SharedBasis shared;
  shared.orthonormal = Orthonormalize(basis);
  const Eigen::MatrixXd& q = shared.orthonormal.functions;
  const Eigen::MatrixXf single = q.cast<float>();  // rank x columns: as the kernels want it
  shared.functions.assign(single.data(), single.data() + single.size());
  shared.products = PairProducts(q);
  const int terms = static_cast<int>(basis.rows);
  shared.own.resize(static_cast<size_t>(basis.columns) * terms);
  for (int t = 0; t < terms; ++t) {
    const float* function = basis.Row(t);
    float most = 0;
    for (int j = 0; j < basis.columns; ++j) most = std::max(most, std::abs(function[j]));
    shared.exponent.push_back(most > 0 ? std::ilogb(most) : 0);
    for (int j = 0; j < basis.columns; ++j) {
      shared.own[static_cast<size_t>(j) * terms + t] =
          static_cast<float>(std::ldexp(double{function[j]}, -shared.exponent[t]));
    }
  }
  return shared;
}

kernels::L1Basis ViewOf(const SharedBasis& shared, int columns) {
  return {columns, shared.orthonormal.Rank(), shared.functions.data(), shared.products.data()};
}

// A group of rows side by side and what is known of them.
struct Lanes {
  int64_t first = 0;
  int count = 0, lanes = 0;
  std::vector<float> targets;  // columns x lanes, scaled by powers of two
  std::vector<int> exponent;   // a row: targets = row * 2^-exponent
  std::vector<float> weights;  // of the orthonormal functions
};

// Several sums at once: one would wait for itself.
double MagnitudeSum(const float* row, int columns) {
  constexpr int kSums = 8;
  double sums[kSums] = {};
  int j = 0;
  for (; j + kSums <= columns; j += kSums) {
    for (int k = 0; k < kSums; ++k) sums[k] += std::abs(row[j + k]);
  }
  for (; j < columns; ++j) sums[0] += std::abs(row[j]);
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

void LoadTargets(RowsView targets, int64_t first, Lanes& group) {
  constexpr int kMostExponent = 126;  // the scale is a float32, too
  const int lanes = group.lanes, columns = targets.columns;
  group.first = first;
  group.count = static_cast<int>(std::min<int64_t>(lanes, targets.rows - first));
  for (int l = 0; l < lanes; ++l) {
    group.exponent[l] = 0;
    if (l >= group.count) {
      for (int j = 0; j < columns; ++j) group.targets[static_cast<size_t>(j) * lanes + l] = 0;
      continue;
    }
    const float* row = targets.Row(first + l);
    const double sum = MagnitudeSum(row, columns);
    if (!std::isfinite(sum)) RequireFinite(targets, "L1 targets");
    if (sum > 0) {
      group.exponent[l] = std::clamp(std::ilogb(sum / columns), -kMostExponent, kMostExponent);
    }
    const float scale = std::ldexp(1.0F, -group.exponent[l]);
    for (int j = 0; j < columns; ++j) {
      group.targets[static_cast<size_t>(j) * lanes + l] = row[j] * scale;
    }
  }
}

// Start weights of the group's rows for the orthonormal functions; absurd ones no more so than
// float32 can bear.
void LoadStart(const std::vector<float>& start, const Eigen::MatrixXd& mixing, Lanes& group) {
  constexpr double kMost = 1e18;
  const Eigen::Index terms = mixing.rows();
  for (int l = 0; l < group.count; ++l) {
    const Eigen::Map<const Eigen::VectorXf> x(start.data() + (group.first + l) * terms, terms);
    const Eigen::VectorXd y = mixing.transpose() * x.cast<double>();
    for (Eigen::Index k = 0; k < y.size(); ++k) {
      group.weights[k * group.lanes + l] =
          static_cast<float>(std::clamp(std::ldexp(y[k], -group.exponent[l]), -kMost, kMost));
    }
  }
}

// The errors of weights as they are stored, n x t from the group's first row on.
std::vector<double> StoredErrors(const SharedBasis& shared, const Lanes& group, int columns,
                                 const float* weights, const kernels::L1Kernels& kernels) {
  const int terms = static_cast<int>(shared.exponent.size());
  float scaled[kernels::kL1Terms * kernels::kL1Lanes] = {};
  for (int l = 0; l < group.count; ++l) {
    for (int t = 0; t < terms; ++t) {
      scaled[t * group.lanes + l] =
          static_cast<float>(std::ldexp(double{weights[static_cast<size_t>(l) * terms + t]},
                                        shared.exponent[t] - group.exponent[l]));
    }
  }
  std::vector<double> errors(group.lanes);
  kernels.error(shared.own.data(), columns, terms, group.targets.data(), scaled, errors.data());
  for (int l = 0; l < group.count; ++l) errors[l] = std::ldexp(errors[l], group.exponent[l]);
  return errors;
}

// The group's weights into the solution; where the start was no worse, the start.
void Store(const SharedBasis& shared, const Lanes& group, int columns,
           const std::vector<float>& start, const kernels::L1Kernels& kernels,
           L1Solution& solution) {
  const Eigen::Index terms = shared.orthonormal.mixing.rows();
  float* stored = solution.weights.data() + group.first * terms;
  const int rank = shared.orthonormal.Rank();
  for (int l = 0; l < group.count; ++l) {
    Eigen::VectorXd y(rank);
    for (int k = 0; k < rank; ++k) {
      y[k] = std::ldexp(double{group.weights[static_cast<size_t>(k) * group.lanes + l]},
                        group.exponent[l]);
    }
    Eigen::Map<Eigen::VectorXf>(stored + l * terms, terms) =
        (shared.orthonormal.inverse.transpose() * y).cast<float>();
  }
  const std::vector<double> errors = StoredErrors(shared, group, columns, stored, kernels);
  std::copy_n(errors.begin(), group.count, solution.errors.begin() + group.first);
  if (start.empty()) return;
  const float* before = start.data() + group.first * terms;
  const std::vector<double> before_errors = StoredErrors(shared, group, columns, before, kernels);
  for (int l = 0; l < group.count; ++l) {
    if (!(before_errors[l] <= errors[l])) continue;  // nor an error beyond all numbers
    std::copy_n(before + l * terms, terms, stored + l * terms);
    solution.errors[group.first + l] = before_errors[l];
  }
}

// From a tenth of the mean residual to a ten-thousandth.
std::vector<float> SmoothingSchedule(int iterations) {
  constexpr double kCoarsest = 0.1, kFinest = 1e-4;
  std::vector<float> parts(iterations);
  for (int i = 0; i < iterations; ++i) {
    const double along = iterations > 1 ? double(i) / (iterations - 1) : 0;
    parts[i] = static_cast<float>(kCoarsest * std::pow(kFinest / kCoarsest, along));
  }
  return parts;
}

}  // namespace

L1Solution SolveReweighted(RowsView basis, RowsView targets, int iterations,
                           const std::vector<float>& start, const kernels::L1Kernels& kernels) {
  const SharedBasis shared = Share(basis);
  const int columns = basis.columns, lanes = kernels.lanes;
  const std::vector<float> smoothing = SmoothingSchedule(iterations);
  L1Solution solution;
  solution.weights.resize(targets.rows * basis.rows);
  solution.errors.resize(targets.rows);
  // Some hundred microseconds a chunk.
  const int64_t chunk = lanes * std::max<int64_t>(1, (1 << 15) / (int64_t{columns} * lanes));
  ParallelChunks(targets.rows, chunk, [&](int64_t begin, int64_t end, int64_t) {
    Lanes group;
    group.lanes = lanes;
    group.targets.resize(static_cast<size_t>(columns) * lanes);
    group.exponent.resize(lanes);
    group.weights.resize(kernels::kL1Terms * lanes);
    for (int64_t first = begin; first < end; first += lanes) {
      LoadTargets(targets, first, group);
      if (!start.empty()) LoadStart(start, shared.orthonormal.mixing, group);
      if (shared.orthonormal.Rank() > 0) {
        kernels.reweight[shared.orthonormal.Rank() - 1](
            ViewOf(shared, columns), {group.targets.data(), group.weights.data(), smoothing.data(),
                                      iterations, start.empty()});
      }
      Store(shared, group, columns, start, kernels, solution);
    }
  });
  return solution;
}

}  // namespace lfm
