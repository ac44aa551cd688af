// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// What one triangle's patches take and lose at each level of resolution: 0 keeps every sample,
/// each further one is the next coarser (CoarserEdgeSamples). One level at least.
struct PatchCosts {
  std::vector<int64_t> term_bytes;  ///< of the three surface maps of one term
  std::vector<int64_t> mean_bytes;  ///< of the mean view
  std::vector<double> mean_errors;  ///< squared error that the level of the mean view adds
  /// Squared error that the level of a term's surface maps adds at a corner that has the term:
  /// `term_errors[(term * 3 + corner) * levels + level]`; empty with one level.
  std::vector<float> term_errors;

  int levels() const { return static_cast<int>(term_bytes.size()); }
  /// What `level` of a term adds over the corners whose bits (1 << corner) are set.
  double TermError(int term, int corners, int level) const;
  int BestMeanLevel(double lambda) const;
  /// The level that minimises error + lambda x bytes; the first of equals.
  int BestTermLevel(int term, int corners, double lambda) const;
  /// That minimum; 0 where no corner has the term.
  double TermCost(int term, int corners, double lambda) const;
};

/// How many terms each vertex gets, and in which resolution triangles and vertices keep their maps.
struct MapSelection {
  std::vector<int> terms;  ///< V
  /// T; the level of the mean view, then of the surface maps of each term that the triangle has.
  std::vector<std::vector<uint8_t>> levels;
  std::vector<std::vector<uint8_t>> view_levels;  ///< V; the grid of each of the vertex's view maps
  bool operator==(const MapSelection&) const = default;
};

/// What every number of terms of every vertex costs and brings.
struct MapCosts {
  const TriangleMesh& mesh;
  /// `squared_errors[v][k]`: with the first k terms of vertex v; as many as it may have, and one.
  std::vector<std::vector<double>> squared_errors;
  std::vector<int64_t> entries;     ///< V; of the vertex's matrix
  std::vector<PatchCosts> patches;  ///< T
  /// Of one view map at each grid (ViewGridLevels), finest first; one at least.
  std::vector<int64_t> view_bytes;
  /// V; squared error that the grid of a vertex's view map adds, `[term * grids + grid]`; not
  /// read with one grid.
  std::vector<std::vector<float>> view_errors;
  /// Of the tables that hold an entry a vertex or triangle for each term that any vertex has.
  int64_t rank_bytes = 0;

  int grids() const { return static_cast<int>(view_bytes.size()); }
  double ViewError(int vertex, int term, int grid) const {
    return grid == 0 ? 0 : view_errors[vertex][static_cast<size_t>(term) * grids() + grid];
  }
  /// The grid that minimises error + lambda x bytes; the first of equals.
  int BestViewGrid(int vertex, int term, double lambda) const;
  /// As estimated: what levels add is added up.
  double SquaredError(const MapSelection& maps) const;
  /// Of all maps and their tables, without gaps between patches.
  int64_t Bytes(const MapSelection& maps) const;
};

/// The most terms that every vertex may have, every sample of them.
MapSelection AllMaps(const MapCosts& costs);

/// The fewest terms with which the root mean square error of a vertex's matrix, 1.0 being the peak,
/// is no larger than `rms`; all where none suffices. Every sample of them.
MapSelection MapsForTolerance(const MapCosts& costs, double rms);

/// Terms and levels that minimise squared error + lambda x bytes, over all vertices together: each
/// vertex in turn, given its neighbours' terms (a patch's texels hold three corners, so that a term
/// costs less where a neighbour has it) and the best levels for each choice, until nothing changes;
/// then the last terms go as long as so few vertices have them that their tables are not worth it.
/// lambda = 0: what lowers the error, alone.
MapSelection MapsForLambda(const MapCosts& costs, double lambda);

/// MapsForLambda with the lambda at which a term of an average vertex (its view map, and its share
/// of the patches, every sample of them, when its neighbours have the term too) is worth its bytes
/// when it lowers the mean square error of the vertex's matrix by rms^2. View maps count as those
/// of the finest grid until terms are chosen: a term has to be drawn, however few bytes it takes.
/// Independent of how much of a scene is glossy: no terms where they would bring nothing but noise.
/// rms = 0: what lowers the error, alone.
MapSelection MapsForGain(const MapCosts& costs, double rms);

/// Of the answers of MapsForLambda the one with the largest lambda whose squared error is at most
/// `squared_error`; all maps where none is.
MapSelection MapsForError(const MapCosts& costs, double squared_error);
/// The one with the smallest lambda whose maps take at most `bytes` by `bytes_of` (MapCosts::Bytes
/// where none is given); no terms, and mean views of the coarsest level, where none does.
MapSelection MapsForBytes(const MapCosts& costs, int64_t bytes,
                          const std::function<int64_t(const MapSelection&)>& bytes_of = {});

}  // namespace lfm
