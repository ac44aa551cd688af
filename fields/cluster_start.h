// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/row_clusters.h"

// Which cluster each row begins in. Private to fields.

namespace lfm {

/// Every row in a random cluster, all equally large (Yamada 2009, Section 3.3), by a fixed seed.
std::vector<uint16_t> RandomClusters(int64_t rows, int clusters);

/// Rows of like shape together: k-means over rows scaled to unit norm, a few rounds, from rows
/// drawn far apart by a fixed seed (k-means++). Some clusters may stay empty.
std::vector<uint16_t> SimilarClusters(const ActiveRows& rows, int clusters);

}  // namespace lfm
