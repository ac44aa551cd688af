// SPDX-License-Identifier: BSD-3-Clause
#include "fields/function_kinds.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kIterations = 12;
constexpr double kLitShare = 0.05;  // of the row's robust peak: below it nothing tells the slope

// A row's value that a tenth of its lights exceed: highlights are narrower, lit sides wider.
double RobustPeak(const float* row, int columns, std::vector<float>& scratch) {
  scratch.assign(row, row + columns);
  const auto at = scratch.begin() + columns * 9 / 10;
  std::nth_element(scratch.begin(), at, scratch.end());
  return *at;
}

// b n, the diffuse part's peak times its normal.
std::optional<Eigen::Vector3d> FitDiffuse(const float* row, double peak,
                                          const std::vector<Eigen::Vector3d>& directions) {
  const auto count = static_cast<int>(directions.size());
  Eigen::Vector3d fit = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    int lit = 0;
    for (int j = 0; j < count; ++j) {
      const double expected = fit.dot(directions[j]);
      if (!(row[j] > kLitShare * peak) || (iteration > 0 && expected <= 0)) continue;
      const double off = std::abs(row[j] - expected);
      // The first round has no fit: bright lights would all be highlights.
      const double weight =
          iteration == 0 ? (row[j] > peak ? peak / row[j] : 1) : 1 / (off + 0.01 * peak);
      normal += weight * directions[j] * directions[j].transpose();
      right += weight * row[j] * directions[j];
      ++lit;
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (lit < 4 || solver.vectorD().minCoeff() < 1e-6 * solver.vectorD().maxCoeff()) {
      return std::nullopt;
    }
    fit = solver.solve(right);
  }
  if (!fit.allFinite() || !(fit.norm() > 0)) return std::nullopt;
  return fit;
}

struct Kinds {
  bool object = false, unoccluded = false, specular = false;
};

Kinds KindsOf(const float* row, const Field& field, const FunctionKindOptions& options,
              std::vector<float>& scratch) {
  Kinds kinds;
  const int columns = field.functions.columns;
  double sum = 0;
  for (int j = 0; j < columns; ++j) sum += std::abs(row[j]);
  kinds.object = sum > 0 && sum >= options.noise * columns;
  if (!kinds.object) return kinds;
  const double peak = RobustPeak(row, columns, scratch);
  if (!(peak > 0)) return kinds;
  const auto fit = FitDiffuse(row, peak, field.directions);
  if (!fit) return kinds;
  const double diffuse_peak = fit->norm();
  int above = 0, blocked = 0;
  for (int j = 0; j < columns; ++j) {
    const double expected = std::max(0.0, fit->dot(field.directions[j]));
    if (row[j] - expected > options.highlight * diffuse_peak) kinds.specular = true;
    if (expected <= options.horizon_cosine * diffuse_peak) continue;
    ++above;
    if (row[j] < options.dark * expected) ++blocked;
  }
  kinds.unoccluded = above > 0 && blocked <= options.blocked_share * above;
  return kinds;
}

}  // namespace

FunctionKinds SplitByKind(const Field& field, const FunctionKindOptions& options) {
  if (static_cast<int64_t>(field.directions.size()) != field.functions.columns) {
    throw Error(field.name + ": not as many directions as columns");
  }
  RequireFinite(field.functions.View(), field.name.c_str());
  std::vector<Kinds> kinds(static_cast<size_t>(field.functions.rows));
  ParallelChunks(field.functions.rows, 256, [&](int64_t begin, int64_t end, int64_t) {
    std::vector<float> scratch;
    for (int64_t r = begin; r < end; ++r) {
      kinds[r] = KindsOf(field.functions.Row(r), field, options, scratch);
    }
  });
  FunctionKinds split;
  for (int64_t r = 0; r < field.functions.rows; ++r) {
    if (kinds[r].object) split.object.push_back(r);
    if (kinds[r].unoccluded) split.unoccluded.push_back(r);
    if (kinds[r].specular) split.specular.push_back(r);
  }
  return split;
}

}  // namespace lfm
