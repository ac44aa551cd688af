// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// The inner loops of iteratively reweighted least squares (fields/l1_reweighted.h), compiled for
/// several instruction sets and dispatched at run time. Plain pointers only. Problems are solved
/// side by side, a vector lane each, so that nothing is summed across lanes, the basis is loaded
/// once for all of them, and what a problem gives does not depend on its neighbours.
namespace lfm::kernels {

enum class L1Level { kBaseline, kAvx2, kAvx512 };

/// Products of basis functions are summed in runs of at most this many, which stay in registers.
constexpr int kL1Run = 12;
/// Basis functions at most.
constexpr int kL1Terms = 16;
/// Problems side by side at most.
constexpr int kL1Lanes = 16;

/// An orthonormal basis of `terms` functions of `columns` numbers.
struct L1Basis {
  int columns = 0;
  int terms = 0;
  const float* functions = nullptr;  ///< columns x terms
  /// q_i q_k at each column, i <= k, k fastest: the pairs in runs of kL1Run (the last may be
  /// shorter), one run after another, each columns x run.
  const float* products = nullptr;
};

/// Problems in lanes: [i][lane].
struct L1Group {
  const float* targets = nullptr;  ///< columns x lanes; the mean magnitude about 1, or all 0
  float* weights = nullptr;        ///< terms x lanes; in: the start; out: the best found
  /// Of each iteration: below this part of the mean residual the error counts as a square.
  const float* smoothing = nullptr;
  int iterations = 0;
  bool from_projection = true;  ///< start at the least squares instead of `weights`
};

struct L1Kernels {
  int lanes = 0;
  /// [terms - 1]. Lowers sum |targets - weights functions| in each lane; never ends above the
  /// start.
  void (*reweight[kL1Terms])(const L1Basis&, const L1Group&) = {};
  /// errors[lane] = sum |targets - weights functions|, float64; functions columns x terms.
  void (*error)(const float* functions, int columns, int terms, const float* targets,
                const float* weights, double* errors) = nullptr;
};

/// Whether this machine, and this compilation, has the level.
bool HasL1Level(L1Level level);
/// The level must be there.
const L1Kernels& L1KernelsOf(L1Level level);
/// The highest level that is there.
const L1Kernels& BestL1Kernels();

}  // namespace lfm::kernels
