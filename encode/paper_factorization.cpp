// SPDX-License-Identifier: BSD-3-Clause
#include "encode/paper_factorization.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encode/pseudo_random.h"
#include "encode/quantization.h"

namespace lfm {
namespace {

template <typename Scalar>
void RequireFinite(const Eigen::MatrixX<Scalar>& f, const PaperOptions& options) {
  if (!f.allFinite()) throw Error("factorisation: the matrix holds values that are not finite");
  if (options.terms < 0) throw Error("factorisation: the number of terms must not be negative");
}

// In (0, 1].
template <typename Scalar>
Eigen::MatrixX<Scalar> PositiveStart(Eigen::Index rows, Eigen::Index columns,
                                     PseudoRandom& random) {
  Eigen::MatrixX<Scalar> x(rows, columns);
  for (Scalar& value : x.reshaped()) value = static_cast<Scalar>((random.Next() + 2) / 2);
  return x.cwiseMax(Scalar{1e-3F});
}

template <typename Scalar>
void DivideOrZero(const Eigen::MatrixX<Scalar>& numerator,
                  const Eigen::MatrixX<Scalar>& denominator, Eigen::MatrixX<Scalar>& x) {
  x.array() *= (denominator.array() > 0).select(numerator.array() / denominator.array(), Scalar{0});
}

template <typename Scalar>
double SquaredError(const Eigen::MatrixX<Scalar>& f, const PaperFactors<Scalar>& factors) {
  return static_cast<double>((f - factors.left * factors.right.transpose()).squaredNorm());
}

}  // namespace

template <typename Scalar>
PaperFactors<Scalar> PaperPca(const Eigen::MatrixX<Scalar>& f, const PaperOptions& options) {
  RequireFinite(f, options);
  constexpr Scalar kNothingLeft = sizeof(Scalar) == sizeof(float) ? Scalar(1e-6) : Scalar(1e-12);
  PaperFactors<Scalar> factors;
  factors.left.resize(f.rows(), 0);
  factors.right.resize(f.cols(), 0);
  PseudoRandom random;
  const Scalar largest = f.size() > 0 ? f.cwiseAbs().maxCoeff() : 0;
  for (int p = 0; p < options.terms; ++p) {
    const Eigen::MatrixX<Scalar> remainder = f - factors.left * factors.right.transpose();
    if (largest <= 0 || remainder.cwiseAbs().maxCoeff() <= kNothingLeft * largest) break;
    const Eigen::MatrixX<Scalar> gram = remainder.transpose() * remainder;
    Eigen::VectorX<Scalar> v = PositiveStart<Scalar>(f.cols(), 1, random);
    v.normalize();
    int iteration = 0;
    Scalar length = 0;
    for (Scalar moved = 2; moved > options.tolerance && iteration < options.max_iterations;) {
      const Eigen::VectorX<Scalar> next = gram * v;
      length = next.norm();
      if (!(length > 0)) break;
      moved = (next / length - v).norm();
      v = next / length;
      ++iteration;
    }
    if (!(length > 0)) break;
    const Scalar lambda = std::sqrt((gram * v).norm());
    const Eigen::VectorX<Scalar> u = remainder * v / lambda;
    const AlphaSplit split = SplitAlpha(static_cast<double>(u.cwiseAbs().maxCoeff() * lambda),
                                        static_cast<double>(v.cwiseAbs().maxCoeff()));
    factors.left.conservativeResize(Eigen::NoChange, p + 1);
    factors.right.conservativeResize(Eigen::NoChange, p + 1);
    factors.left.col(p) = u * (lambda * static_cast<Scalar>(split.surface));
    factors.right.col(p) = v * static_cast<Scalar>(split.view);
    factors.singular_values.push_back(static_cast<double>(lambda));
    factors.iterations.push_back(iteration);
  }
  return factors;
}

template <typename Scalar>
PaperFactors<Scalar> PaperNmf(const Eigen::MatrixX<Scalar>& f, const PaperOptions& options) {
  RequireFinite(f, options);
  constexpr int kBetweenTests = 10;
  if (f.size() > 0 && f.minCoeff() < 0) {
    throw Error("NMF: the matrix holds negative values; the mean view must not be subtracted");
  }
  PaperFactors<Scalar> factors;
  const bool empty = f.size() == 0 || f.maxCoeff() <= 0;
  const int terms = empty ? 0 : options.terms;
  PseudoRandom random;
  Eigen::MatrixX<Scalar>&u = factors.left, &v = factors.right;
  u = PositiveStart<Scalar>(f.rows(), terms, random);
  v = PositiveStart<Scalar>(f.cols(), terms, random);
  factors.iterations = {0};
  if (terms == 0) return factors;
  double error = SquaredError(f, factors);
  int& iteration = factors.iterations.front();
  while (iteration < options.max_iterations) {
    DivideOrZero<Scalar>(f * v, u * (v.transpose() * v), u);
    DivideOrZero<Scalar>(f.transpose() * u, v * (u.transpose() * u), v);
    for (int k = 0; k < terms; ++k) {
      const Scalar sum = u.col(k).sum();
      if (!(sum > 0)) continue;
      u.col(k) /= sum;
      v.col(k) *= sum;
    }
    if (++iteration % kBetweenTests != 0) continue;
    const double before = error;
    error = SquaredError(f, factors);
    if (before - error <= options.tolerance * error) break;
  }
  return factors;
}

template PaperFactors<float> PaperPca(const Eigen::MatrixXf&, const PaperOptions&);
template PaperFactors<double> PaperPca(const Eigen::MatrixXd&, const PaperOptions&);
template PaperFactors<float> PaperNmf(const Eigen::MatrixXf&, const PaperOptions&);
template PaperFactors<double> PaperNmf(const Eigen::MatrixXd&, const PaperOptions&);

}  // namespace lfm
