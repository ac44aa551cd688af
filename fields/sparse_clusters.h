// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/options.h"
#include "core/progress.h"
#include "fields/clustered_model.h"
#include "fields/field.h"
#include "fields/haar_basis.h"
#include "fields/sparse_factorization.h"

namespace lfm {

/// Which cluster the rows begin in.
enum class ClusterStart {
  kSimilar,  ///< k-means over the rows' shapes
  kRandom,   ///< any, with a fixed seed, as the paper
};

/// In which basis functions and residual are written.
enum class FunctionsBasis {
  kNone,
  kHaar,  ///< fields/haar_basis.h
};

struct SparseClusterOptions {
  int clusters = 128;
  int terms = 4;
  double min_cluster = 0.1, max_cluster = 8;  ///< of the mean number of rows in a cluster
  L1Solver l1_solver = L1Solver::kReweighted;
  ResidualSign residual_sign = ResidualSign::kAny;
  FactorStart factor_start = FactorStart::kPca;
  ClusterStart cluster_start = ClusterStart::kSimilar;
  int bootstrap_factor = 0;  ///< 0: chosen
  int rounds = 20;
  int refine = 1;
  int alternatives = 4;
  int residuals = -1;
  double residual_threshold = 1.0 / 256;
  FunctionsBasis functions_basis = FunctionsBasis::kNone;

  void Declare(OptionVisitor& v) {
    v.Integer({"clusters",
               "Clusters to begin with; more cost little: a basis each. The limits of "
               "size may change their number.",
               "", 1, 32768},
              clusters);
    v.Integer(
        {"cluster-terms", "Terms of a cluster's basis: weights that every row stores.", "", 1, 16},
        terms);
    v.Number(
        {"min-cluster",
         "Clusters with less than so many times the mean number of rows are dissolved.", "", 0, 1},
        min_cluster);
    v.Number(
        {"max-cluster", "Clusters with more than so many times the mean number of rows are halved.",
         "", 2, 1e9},
        max_cluster);
    v.Enumeration({"l1-solver",
                   "What finds weights of least absolute error: reweighting, the same and then the "
                   "exact optimum, or the paper's linear or quadratic programme (very slow)."},
                  {"reweighted", "exact", "linear-programme", "quadratic-programme"}, l1_solver);
    v.Enumeration({"residual-sign", "Whether the residual may be negative."}, {"any", "positive"},
                  residual_sign);
    v.Enumeration({"factor-start", "Where a cluster's factorisation begins."}, {"pca", "random"},
                  factor_start);
    v.Enumeration({"cluster-start",
                   "Which cluster rows begin in: rows of like shape together, or "
                   "any."},
                  {"similar", "random"}, cluster_start);
    v.Integer({"bootstrap-factor",
               "Clusters are found in a picture smaller by this factor; 0: chosen so that they "
               "keep enough rows.",
               "", 0, 64},
              bootstrap_factor);
    v.Integer(
        {"cluster-rounds", "Rounds of factorising and choosing clusters, at most.", "", 0, 1000},
        rounds);
    v.Integer({"refine", "Rounds at full resolution that follow.", "", 0, 100}, refine);
    v.Integer({"alternatives", "Clusters that a row is tried in, of those it may join.", "", 1, 64},
              alternatives);
    v.Integer({"residuals", "Residual entries that a row keeps at most, the largest; -1: all.", "",
               -1, 65536},
              residuals);
    v.Number({"residual-threshold", "Residual entries up to this magnitude are left out.",
              "radiance", 0, 1e30},
             residual_threshold);
    v.Enumeration({"functions-basis",
                   "What functions and residual are written in: lights as they are, or Haar "
                   "wavelets over them."},
                  {"none", "haar"}, functions_basis);
  }
};

struct SparseClusterResult {
  /// In the basis of `haar`, when there is one; numbers rounded as in fields/stored_numbers.h.
  /// Rows without energy are in a last cluster, without functions, when there are such rows.
  ClusteredModel model;
  std::optional<HaarBasis> haar;

  int clusters = 0;  ///< with functions
  int bootstrap_factor = 1;
  int64_t bootstrap_rows = 0;  ///< with energy, at low resolution
  int64_t dark_rows = 0;       ///< without energy
  /// sum |E| / sum |R| after each choice of clusters: at low resolution, then at full.
  std::vector<double> bootstrap_error, full_error;
  int64_t smallest_cluster = 0, largest_cluster = 0;  ///< rows, of those with functions
  double residuals_per_row = 0;                       ///< kept, of rows with energy
};

/// Clustered sparse residual factorisation (Yamada 2009, Sections 3.3, 3.4 and 5) of a field's
/// rows, each colour channel of a point on its own:
///
///   R_r = sum_t weight[r][t] F^c(r)_t + E_r,    c(r) = argmin_k |E_r^k|_1       (Equations 2, 14)
///
/// At low resolution (fields/coarse_field.h) clusters are factorised and rows put in the best one,
/// by turns, until fewer than 1 in 200 rows move or the error falls by less than 0.3 % in three. A
/// row is tried exactly in the `alternatives` clusters that explain most of its energy and in the
/// one it is in. Clusters too small are merged into the next best of their members; too large ones
/// are halved; numbers that fall free go to halves of the clusters of greatest error. At full
/// resolution a row may join the clusters of its cell and the cells around, of its own channel and
/// then of the others; `refine` rounds fit the bases to all rows. Last, bases are rounded as they
/// will be stored, weights are solved for these and rounded, and the residual is what is then left
/// (fields/residual.h).
///
/// Deterministic: does not depend on the number of threads. Takes about the field's own memory
/// again at most.
/// Extremes: rows without energy take part in nothing; a field of them has no cluster with
/// functions; clusters are at most as many as rows with energy, terms at most min(rows, columns) of
/// a cluster; the limits of size give way where they cannot hold (one cluster left; more than 65534
/// clusters). Any scale from 1e-25 to 1e25.
/// Throws Error when an option is out of range, a number is not finite, the field's sizes do not
/// fit together, or there are more than 65536 columns.
SparseClusterResult ClusterSparse(const Field& field, const SparseClusterOptions& options,
                                  Progress& progress);

}  // namespace lfm
