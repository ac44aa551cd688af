// SPDX-License-Identifier: BSD-3-Clause
#include "fields/adaptive_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/compact_rows.h"
#include "fields/matrix_products.h"

namespace lfm {
namespace {

using Rows = std::vector<int64_t>;

// A node and the rows that it has: full_rows at most also in coordinates of their own.
struct Piece {
  int node = 0;
  Rows rows;
  CompactRows compact;  // no rows: too many
};

struct Division {
  Piece halves[2];
  PatchSize sizes[2];
  double gain = 0;
};

class Divider {
 public:
  Divider(RowsView full, RowsView reduced, const AdaptiveOptions& options)
      : full_(full), reduced_(reduced), options_(options), energies_(RowEnergies(full)) {}

  Piece FirstPiece(Rows rows) const {
    Piece piece;
    piece.rows = std::move(rows);
    AddCoordinates(piece);
    return piece;
  }

  int64_t TermsOfPiece(const Piece& piece) const {
    return piece.compact.energies.empty()
               ? TermsNeeded(GatherRows(full_, piece.rows).View(), options_.energy_share)
               : TermsNeeded(piece.compact, options_.energy_share);
  }

  // The cheapest of a few divisions; gain 0: none pays.
  Division Divide(const Piece& piece, const PatchSize& size) const {
    Division best;
    if (size.pixels < 2 * options_.min_rows || size.terms < 2) return best;
    FunctionRows gathered;
    RowsView seen = piece.compact.coordinates.View();
    if (piece.compact.energies.empty()) {
      gathered = GatherRows(reduced_, piece.rows);
      seen = gathered.View();
    }
    int before = 0;
    for (const int part : {8, 4, 2}) {
      const int terms = static_cast<int>(std::max<int64_t>(1, size.terms / part));
      if (terms == before) continue;
      before = terms;
      const Clustering halves = ClusterRows(seen, {.clusters = 2,
                                                   .terms = terms,
                                                   .iterations = options_.iterations,
                                                   .min_rows = options_.min_rows});
      if (halves.clusters == 2) KeepBetter(piece, size, halves, best);
    }
    return best;
  }

 private:
  void AddCoordinates(Piece& piece) const {
    if (static_cast<int64_t>(piece.rows.size()) > options_.full_rows) return;
    std::vector<double> energies;
    for (const int64_t row : piece.rows) energies.push_back(energies_[row]);
    piece.compact =
        CompactedRows(GatherRows(full_, piece.rows).View(), std::move(energies), LostShare());
  }

  double LostShare() const { return (1 - options_.energy_share) / 1024; }

  void KeepBetter(const Piece& piece, const PatchSize& size, const Clustering& halves,
                  Division& best) const {
    const std::vector<Rows> members = halves.Members();
    Division division;
    for (int i = 0; i < 2; ++i) {
      Piece& half = division.halves[i];
      for (const int64_t row : members[i]) half.rows.push_back(piece.rows[row]);
      if (piece.compact.energies.empty()) {
        AddCoordinates(half);
      } else {
        half.compact = PartOf(piece.compact, members[i]);
      }
      division.sizes[i] = {static_cast<int64_t>(members[i].size()), TermsOfPiece(half)};
    }
    division.gain = GainOfDivision(size, division.sizes, options_.global_terms);
    if (division.gain <= best.gain) return;
    best = std::move(division);
    // Halves need fewer coordinates than the whole.
    for (Piece& half : best.halves) {
      if (piece.compact.energies.empty()) continue;
      half.compact = CompactedRows(half.compact.coordinates.View(),
                                   std::move(half.compact.energies), LostShare());
    }
  }

  RowsView full_, reduced_;
  const AdaptiveOptions& options_;
  std::vector<double> energies_;
};

void CheckOptions(RowsView full, RowsView reduced, const AdaptiveOptions& options) {
  if (full.rows != reduced.rows) throw Error("adaptive clusters: reduced rows of another number");
  if (options.initial_clusters < 1 || options.search_terms < 1 || options.iterations < 0 ||
      options.min_rows < 1 || options.full_rows < 0 || !(options.energy_share > 0) ||
      !(options.energy_share <= 1) || !(options.global_terms >= 0) ||
      !std::isfinite(options.global_terms)) {
    throw Error("adaptive clusters: an option is out of range");
  }
}

// Ends what cannot be divided, and returns the halves of the rest.
std::vector<Piece> DivideAll(const Divider& divider, std::vector<Piece> pieces,
                             AdaptiveClusters& result) {
  std::vector<Division> divisions(pieces.size());
  ParallelFor(0, static_cast<int64_t>(pieces.size()), [&](int64_t i) {
    divisions[i] = divider.Divide(pieces[i], result.nodes[pieces[i].node].size);
  });
  std::vector<Piece> next;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const int node = pieces[i].node;
    result.nodes[node].gain = divisions[i].gain;
    if (divisions[i].gain <= 0) {
      result.nodes[node].cluster = result.clustering.clusters++;
      for (const int64_t row : pieces[i].rows) {
        result.clustering.cluster[row] = result.nodes[node].cluster;
      }
      continue;
    }
    for (int half = 0; half < 2; ++half) {
      DivisionNode child;
      child.parent = node;
      child.size = divisions[i].sizes[half];
      divisions[i].halves[half].node = result.nodes[node].children[half] =
          static_cast<int>(result.nodes.size());
      result.nodes.push_back(child);
      next.push_back(std::move(divisions[i].halves[half]));
    }
  }
  return next;
}

}  // namespace

AdaptiveClusters DivideClusters(RowsView full, RowsView reduced, const AdaptiveOptions& options) {
  CheckOptions(full, reduced, options);
  if (!std::isfinite(EnergyOf(full))) RequireFinite(full, "rows to be clustered");
  const Divider divider(full, reduced, options);
  AdaptiveClusters result;
  result.clustering.cluster.resize(static_cast<size_t>(full.rows));
  const Clustering first = ClusterRows(reduced, {.clusters = options.initial_clusters,
                                                 .terms = options.search_terms,
                                                 .iterations = options.iterations,
                                                 .min_rows = options.min_rows});
  std::vector<Piece> pieces;
  for (const Rows& rows : first.Members()) {
    pieces.push_back(divider.FirstPiece(rows));
    pieces.back().node = static_cast<int>(result.nodes.size());
    DivisionNode node;
    node.size = {static_cast<int64_t>(rows.size()), divider.TermsOfPiece(pieces.back())};
    result.nodes.push_back(node);
  }
  while (!pieces.empty()) pieces = DivideAll(divider, std::move(pieces), result);
  std::vector<PatchSize> sizes;
  for (const DivisionNode& node : result.nodes) {
    if (node.cluster >= 0) sizes.push_back(node.size);
  }
  result.cost = CostOf(sizes, options.global_terms);
  return result;
}

int64_t GlobalTerms(RowsView rows, int64_t sample, double share) {
  if (sample < 1) throw Error("the global basis needs a row at least");
  const std::vector<double> energies = RowEnergies(rows);
  Rows lit;
  for (int64_t row = 0; row < rows.rows; ++row) {
    if (energies[row] > 0 || std::isnan(energies[row])) lit.push_back(row);
  }
  const auto count = static_cast<int64_t>(lit.size());
  Rows drawn;
  for (int64_t i = 0; i < std::min(sample, count); ++i) {
    drawn.push_back(lit[i * count / std::min(sample, count)]);
  }
  return std::max<int64_t>(1, TermsNeeded(GatherRows(rows, drawn).View(), share));
}

}  // namespace lfm
