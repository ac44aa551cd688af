// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int64_t kRowsAtOnce = 512;
constexpr float kMostFloat = std::numeric_limits<float>::max();

// A double within float's range.
float ToFloat(double value) {
  return static_cast<float>(std::clamp<double>(value, -kMostFloat, kMostFloat));
}

}  // namespace

LightFit FitLights(RowsView rows, const std::vector<Eigen::Vector3d>& to_lights,
                   const LightFrame& frame, LightBasis basis, FitSpace space) {
  return FitLights(rows, to_lights, frame, std::vector<LightBasis>{basis}, space).front();
}

std::vector<LightFit> FitLights(RowsView rows, const std::vector<Eigen::Vector3d>& to_lights,
                                const LightFrame& frame, const std::vector<LightBasis>& bases,
                                FitSpace space) {
  if (rows.columns != static_cast<int>(to_lights.size())) {
    throw Error("light fit: " + std::to_string(rows.columns) + " values a row, but " +
                std::to_string(to_lights.size()) + " lights");
  }
  RequireFinite(rows, "light fit");
  // All solvers on top of each other; what one light adds is contiguous.
  Eigen::MatrixXd solver(0, rows.columns);
  std::vector<LightFit> fits;
  for (LightBasis basis : bases) {
    const Eigen::MatrixXd of_basis = MakeLightSolver(basis, frame, to_lights).solver;
    solver.conservativeResize(solver.rows() + of_basis.rows(), Eigen::NoChange);
    solver.bottomRows(of_basis.rows()) = of_basis;
    fits.push_back({basis, space, frame, MakeFunctionRows(rows.rows, LightBasisTerms(basis))});
  }
  ParallelChunks(rows.rows, kRowsAtOnce, [&](int64_t begin, int64_t end, int64_t) {
    Eigen::VectorXd sum(solver.rows());
    for (int64_t r = begin; r < end; ++r) {
      const float* row = rows.Row(r);
      sum.setZero();
      for (int j = 0; j < rows.columns; ++j) {
        const double value = space == FitSpace::kDisplay ? SrgbFromLinear(row[j]) : row[j];
        sum += value * solver.col(j);
      }
      const double* next = sum.data();
      for (LightFit& fit : fits) {
        float* out = fit.coefficients.Row(r);
        for (int t = 0; t < fit.coefficients.columns; ++t) out[t] = ToFloat(*next++);
      }
    }
  });
  return fits;
}

std::vector<float> EvaluateFit(const LightFit& fit, const Eigen::Vector3d& to_light) {
  const Eigen::VectorXd values = LightBasisValues(fit.basis, fit.frame.Local(to_light));
  std::vector<float> shown(static_cast<size_t>(fit.coefficients.rows));
  ParallelChunks(fit.coefficients.rows, kRowsAtOnce, [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t r = begin; r < end; ++r) {
      double sum = 0;
      for (int t = 0; t < fit.coefficients.columns; ++t) {
        sum += values[t] * fit.coefficients.Row(r)[t];
      }
      const float value = std::max(0.0f, ToFloat(sum));
      shown[r] =
          fit.space == FitSpace::kDisplay ? std::min(LinearFromSrgb(value), kMostFloat) : value;
    }
  });
  return shown;
}

}  // namespace lfm
