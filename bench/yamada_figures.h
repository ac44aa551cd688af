// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "core/progress.h"
#include "fields/clustered_model.h"
#include "fields/field.h"
#include "fields/function_kinds.h"
#include "fields/sparse_clusters.h"

// The table and figures of Yamada 2009, Section 5, for one field. Each prints to stdout and writes
// its charts and pictures into a folder.

namespace lfm {

/// What the figures share.
struct YamadaField {
  Field field;
  FunctionKinds kinds;
  std::filesystem::path out;  ///< where charts go

  int Residuals(double percent) const;  ///< so much of the lights
};

/// Clustered PCA with so many clusters and terms, without residual.
ClusteredModel ClusteredPca(const Field& field, int clusters, int terms);
/// The first `terms` of every cluster's.
ClusteredModel LeadingTerms(const ClusteredModel& model, int terms);

/// A clustered sparse factorisation with as much residual as 30 % of the lights, no threshold.
ClusteredModel SparseModel(const YamadaField& data, int clusters, int terms, Progress& progress);

/// Frames a second of relighting with so many residual entries a row.
using FrameRate = std::function<double(const ClusteredModel& model, int residuals)>;

struct YamadaConfiguration {
  int clusters = 128, terms = 4;
};

/// Table 1, and the curves of Figure 4, over the same models. Without `frame_rate` its columns
/// show "-".
void PrintTable1(const YamadaField& data, const std::vector<YamadaConfiguration>& configurations,
                 const FrameRate& frame_rate, Progress& progress);
/// Figure 5: the ratio of the error to clustered PCA's with the same residual.
void PrintFigure5(const YamadaField& data, const std::vector<YamadaConfiguration>& configurations,
                  Progress& progress);
/// Figure 6: the best 16 terms of 64 of clustered PCA, and 16 of 16, against 4 + 12, 8 + 8 and
/// 16 + 0 terms and residuals; 64 clusters.
void PrintFigure6(const YamadaField& data, Progress& progress);
/// The Haar basis: sparseness, error and bytes beside those without.
void PrintHaar(const YamadaField& data, Progress& progress);

}  // namespace lfm
