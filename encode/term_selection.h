// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// What every number of terms of every vertex costs and brings.
struct TermCosts {
  const TriangleMesh& mesh;
  /// `squared_errors[v][k]`: with the first k terms of vertex v; as many as it may have, and one.
  std::vector<std::vector<double>> squared_errors;
  std::vector<int64_t> entries;      ///< V; of the vertex's matrix
  std::vector<int64_t> patch_bytes;  ///< T; of a triangle's three surface maps of one term
  int64_t view_bytes = 0;            ///< of one view map

  double SquaredError(const std::vector<int>& terms) const;
  /// Of all maps of the terms, without gaps between patches.
  int64_t Bytes(const std::vector<int>& terms) const;
};

/// The most terms that every vertex may have.
std::vector<int> AllTerms(const TermCosts& costs);

/// The fewest terms with which the root mean square error of a vertex's matrix, 1.0 being the peak,
/// is no larger than `rms`; all where none suffices.
std::vector<int> TermsForTolerance(const TermCosts& costs, double rms);

/// Terms that minimise squared error + lambda x bytes, over all vertices together: each vertex in
/// turn, given its neighbours' terms (a patch's texels hold three corners, so that a term costs
/// less where a neighbour has it), until nothing changes. lambda = 0: what lowers the error, alone.
std::vector<int> TermsForLambda(const TermCosts& costs, double lambda);

/// TermsForLambda with the lambda at which a term of an average vertex (its view map, and its share
/// of the patches when its neighbours have the term too) is worth its bytes when it lowers the mean
/// square error of the vertex's matrix by rms^2. Independent of how much of a scene is glossy: no
/// terms where they would bring nothing but noise. rms = 0: what lowers the error, alone.
std::vector<int> TermsForGain(const TermCosts& costs, double rms);

/// Of the answers of TermsForLambda the one with the largest lambda whose squared error is at most
/// `squared_error`; all terms where none is.
std::vector<int> TermsForError(const TermCosts& costs, double squared_error);
/// The one with the smallest lambda whose maps take at most `bytes`; no terms at all where none
/// does.
std::vector<int> TermsForBytes(const TermCosts& costs, int64_t bytes);

}  // namespace lfm
