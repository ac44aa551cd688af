// SPDX-License-Identifier: BSD-3-Clause
#include "encode/nmf.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "encode/product_kernels.h"

namespace lfm {
namespace {

using Gram = Eigen::MatrixXd;  // width x width

constexpr double kStartTolerance = 1e-4;  // of the subspace; the last iterations see all of F
constexpr double kLeastError = 1e-8;      // of the energy: below that lies rounding
constexpr int kRounds = 4;                // of descent, a product
constexpr int kBesides = 4;               // singular triplets of the subspace beyond the terms

/// A factor: rows x width, row-major.
struct Factor {
  int rows = 0, width = 8;
  std::vector<float> values;

  float& At(int row, int column) { return values[static_cast<size_t>(row) * width + column]; }
  float At(int row, int column) const { return values[static_cast<size_t>(row) * width + column]; }
  Gram GramMatrix() const {
    Gram gram(width, width);
    kernels::Gram(values.data(), rows, width, gram.data());
    if (!gram.allFinite()) {
      throw Error("NMF: the matrix holds values that are not finite, or beyond 1e+25");
    }
    return gram;
  }
};

Factor Zeros(int rows, int width) {
  return {rows, width, std::vector<float>(static_cast<size_t>(rows) * width, 0.F)};
}

/// Products of what is factorised with either factor.
struct Products {
  std::function<void(const Factor& right, Factor& out)> times;            // F V
  std::function<void(const Factor& left, Factor& out)> transposed_times;  // F^T U
};

// The first `terms` of `stride` numbers a row.
void DescendRows(const float* products, const Gram& gram, int terms, int stride, int rows,
                 int rounds, float* x) {
  const Eigen::MatrixXf g = gram.topLeftCorner(terms, terms).cast<float>();
  Eigen::VectorXf inverse(terms);
  for (int k = 0; k < terms; ++k) {
    inverse[k] = gram(k, k) > 0 ? static_cast<float>(1 / gram(k, k)) : 0;
  }
  kernels::DescendNonnegative(products, g.data(), inverse.data(), terms, stride, rows, rounds, x);
}

void Descend(const Factor& products, const Gram& gram, int terms, Factor& x) {
  DescendRows(products.values.data(), gram, terms, x.width, x.rows, kRounds, x.values.data());
}

double Inner(const Factor& a, const Factor& b) {
  double sums[8] = {};  // as many as the compiler can keep in registers
  for (size_t i = 0; i < a.values.size(); i += 8) {
    for (size_t k = 0; k < 8; ++k) {
      sums[k] += static_cast<double>(a.values[i + k]) * b.values[i + k];
    }
  }
  return std::accumulate(std::begin(sums), std::end(sums), 0.0);
}

/// What iterations hold besides the factors.
struct Workspace {
  Factor u_products, v_products;
  Gram v_gram;
};

// Both factors in turn; returns ||F||^2 - ||F - U V^T||^2 of the new pair.
double Alternate(const Products& f, int terms, Factor& u, Factor& v, Workspace& work) {
  f.times(v, work.u_products);
  Descend(work.u_products, work.v_gram, terms, u);
  f.transposed_times(u, work.v_products);
  const Gram u_gram = u.GramMatrix();
  Descend(work.v_products, u_gram, terms, v);
  work.v_gram = v.GramMatrix();
  return 2 * Inner(work.v_products, v) - u_gram.cwiseProduct(work.v_gram).sum();
}

int Iterate(const Products& f, double energy, double tolerance, int max_iterations, int terms,
            Factor& u, Factor& v, double& fall) {
  Workspace work{Zeros(u.rows, u.width), Zeros(v.rows, v.width), v.GramMatrix()};
  fall = -INFINITY;
  int iteration = 0;
  while (iteration < max_iterations) {
    const double before = std::exchange(fall, Alternate(f, terms, u, v, work));
    ++iteration;
    const double error = std::max(energy - fall, 0.0) + kLeastError * energy;
    if (fall - before <= tolerance * error) break;
  }
  return iteration;
}

// The nonnegative part of u v^T that has more energy, split evenly.
void StartTerm(const Factor& left, const Factor& right, int k, Factor& u, Factor& v) {
  double up = 0, un = 0, vp = 0, vn = 0;
  const auto add = [](float value, double& positive, double& negative) {
    (value > 0 ? positive : negative) += static_cast<double>(value) * value;
  };
  for (int row = 0; row < u.rows; ++row) add(left.At(row, k), up, un);
  for (int row = 0; row < v.rows; ++row) add(right.At(row, k), vp, vn);
  const float sign = up * vp >= un * vn ? 1 : -1;
  for (int row = 0; row < u.rows; ++row) u.At(row, k) = std::max(0.F, sign * left.At(row, k));
  for (int row = 0; row < v.rows; ++row) v.At(row, k) = std::max(0.F, sign * right.At(row, k));
}

// The first columns of a matrix of `width`, as many as `kept`.
Factor FirstColumns(const std::vector<float>& values, int rows, int width, int kept, float scale) {
  Factor first = Zeros(rows, kept);
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < kept; ++k) {
      first.At(row, k) = scale * values[static_cast<size_t>(row) * width + k];
    }
  }
  return first;
}

// F ~ L R^T: F V = L (R^T V), F^T U = R (L^T U).
Products ProductsInSubspace(const Factor& left, const Factor& right) {
  const auto through = [](const Factor& first, const Factor& second, const Factor& x, Factor& out) {
    std::vector<float> small(static_cast<size_t>(first.width) * x.width);
    kernels::MultiplyTransposed(first.values.data(), first.rows, first.width, x.values.data(),
                                x.width, small.data());
    kernels::Multiply(second.values.data(), second.rows, second.width, small.data(), x.width,
                      out.values.data());
  };
  return {[=, &left, &right](const Factor& v, Factor& out) { through(right, left, v, out); },
          [=, &left, &right](const Factor& u, Factor& out) { through(left, right, u, out); }};
}

Products ProductsWith(const LinearMap& map, float prescale) {
  const auto scale = [prescale](Factor& out) {
    for (float& value : out.values) value *= prescale;
  };
  return {[&map, scale](const Factor& v, Factor& out) {
            map.multiply(v.values.data(), v.width, out.values.data());
            scale(out);
          },
          [&map, scale](const Factor& u, Factor& out) {
            map.multiply_transposed(u.values.data(), u.width, out.values.data());
            scale(out);
          }};
}

// Columns of u sum to one, terms go by their energy, terms without any are dropped.
NmfResult Arrange(const Factor& u, const Factor& v, int terms, float unscale) {
  const Gram u_gram = u.GramMatrix(), v_gram = v.GramMatrix();
  std::vector<int> order(terms);
  std::iota(order.begin(), order.end(), 0);
  const auto energy = [&](int k) { return u_gram(k, k) * v_gram(k, k); };
  std::erase_if(order, [&](int k) { return !(energy(k) > 0); });
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return energy(a) > energy(b); });
  NmfResult result;
  result.terms = static_cast<int>(order.size());
  result.width = u.width;
  Factor left = Zeros(u.rows, u.width), right = Zeros(v.rows, v.width);
  for (int k = 0; k < result.terms; ++k) {
    double sum = 0;
    for (int row = 0; row < u.rows; ++row) sum += u.At(row, order[k]);
    for (int row = 0; row < u.rows; ++row) {
      left.At(row, k) = static_cast<float>(u.At(row, order[k]) / sum);
    }
    for (int row = 0; row < v.rows; ++row) {
      right.At(row, k) = static_cast<float>(v.At(row, order[k]) * sum * unscale);
    }
  }
  result.left = std::move(left.values);
  result.right = std::move(right.values);
  return result;
}

}  // namespace

NmfResult ComputeNmf(const LinearMap& map, const NmfOptions& options) {
  const PcaResult pca = ComputePca(map, {.terms = options.terms, .tolerance = kStartTolerance});
  const int width = std::max(8, (options.terms + 7) / 8 * 8);
  Factor u = Zeros(map.rows, width), v = Zeros(map.cols, width);
  if (pca.terms == 0) {
    NmfResult none;
    none.width = width;
    none.left = std::move(u.values);
    none.right = std::move(v.values);
    return none;
  }
  // Units in which the largest singular value is about one.
  const int exponent = std::ilogb(pca.singular_values.front());
  const float prescale = std::ldexp(1.F, -exponent), unscale = std::ldexp(1.F, exponent);
  const int kept = std::min(pca.width, (options.terms + kBesides + 7) / 8 * 8);
  const Factor left = FirstColumns(pca.left, map.rows, pca.width, kept, 1),
               right = FirstColumns(pca.right, map.cols, pca.width, kept, prescale);
  double energy = 0;
  for (const double s : pca.singular_values) energy += s * prescale * s * prescale;
  for (int k = 0; k < pca.terms; ++k) StartTerm(left, right, k, u, v);

  double fall = 0;
  const int inside = Iterate(ProductsInSubspace(left, right), energy, options.tolerance,
                             options.max_iterations, pca.terms, u, v, fall);
  const int exact = Iterate(ProductsWith(map, prescale), energy, options.tolerance,
                            options.max_exact, pca.terms, u, v, fall);
  NmfResult result = Arrange(u, v, pca.terms, unscale);
  result.iterations = inside;
  result.exact_iterations = exact;
  result.squared_error_fall = fall * unscale * unscale;
  return result;
}

void DescendNonnegative(const std::vector<float>& products, const Eigen::MatrixXd& gram, int terms,
                        int rounds, std::vector<float>& x) {
  if (terms == 0) return;
  if (terms > 16) throw Error("NMF: terms must lie in [0, 16]", ErrorKind::kSystem);
  DescendRows(products.data(), gram, terms, terms, static_cast<int>(x.size()) / terms, rounds,
              x.data());
}

}  // namespace lfm
