// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/options.h"
#include "fields/adaptive_clusters.h"
#include "fields/clustered_model.h"
#include "fields/cost_model.h"
#include "fields/field.h"

namespace lfm {

/// How rows come to their clusters.
enum class CpcaDivision {
  kAdaptive,  ///< few clusters, divided in two as long as the cost falls (Mahajan 2007,
              ///< Section 5.2)
  kFixed,     ///< a given number of clusters (Sloan 2003)
  kBlocks,    ///< square blocks of one size (pictures only)
  kQuadtree,  ///< square blocks divided into four as long as the cost falls (Section 5.3)
};

/// Clustered and blockwise PCA of a field.
struct CpcaOptions {
  CpcaDivision division = CpcaDivision::kAdaptive;
  double energy_percent = 99.9;
  int max_terms = 0;
  int clusters = 64;
  int initial_clusters = 8;
  int search_terms = 8;
  int wavelets = 256;
  int full_rows = 2000;
  int min_rows = 1;
  int block = 16;
  int global_terms = 0;

  void Declare(OptionVisitor& v) {
    v.Enumeration({"cpca-division", "How points come to their clusters."},
                  {"adaptive", "fixed", "blocks", "quadtree"}, division);
    v.Number({"cpca-energy",
              "Share of its energy that every cluster's terms hold: more is closer and larger.",
              "%", 0, 100},
             energy_percent);
    v.Integer({"cpca-max-terms", "No cluster has more terms than this; 0: no limit.", "", 0, 65535},
              max_terms);
    v.Integer({"cpca-clusters", "Clusters of the fixed division.", "", 1, 65536}, clusters);
    v.Integer(
        {"cpca-initial-clusters", "Clusters that the adaptive division begins with.", "", 1, 4096},
        initial_clusters);
    v.Integer({"cpca-search-terms", "Terms of a cluster while points look for theirs.", "", 1, 256},
              search_terms);
    v.Integer(
        {"cpca-wavelets",
         "Haar coefficients that large clusters are told apart by, 0: all directions (slower).", "",
         0, 1 << 20},
        wavelets);
    v.Integer({"cpca-full-rows",
               "Adaptive: clusters up to this size are divided by all directions.", "", 0, 1 << 30},
              full_rows);
    v.Integer({"cpca-min-rows", "No cluster is smaller.", "", 1, 1 << 30}, min_rows);
    v.Integer({"cpca-block", "Side of the blocks; of a quadtree, the largest (a power of two).",
               "px", 1, 4096},
              block);
    v.Integer({"cpca-global-terms",
               "Functions N that light is projected into first, for the cost; 0: what holds the "
               "share of the energy of some of the points.",
               "", 0, 1 << 20},
              global_terms);
  }
};

struct CpcaResult {
  ClusteredModel model;
  std::vector<PatchSize> sizes;  ///< a cluster
  double global_terms = 0;       ///< N
  RenderingCost cost;            ///< with N
};

/// Rows of all channels are clustered together, or, by blocks, each channel for itself. A field
/// without rows gives a model without clusters. Throws Error for blocks of a field that is no
/// picture, options out of range and numbers that are not finite.
CpcaResult EncodeClusteredPca(const Field& field, const CpcaOptions& options);

}  // namespace lfm
