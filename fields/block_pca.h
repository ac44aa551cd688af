// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/clustered_pca.h"
#include "fields/cost_model.h"
#include "fields/function_rows.h"

namespace lfm {

/// The pixels of a picture that rows stand for.
struct RowsOfPicture {
  int width = 0, height = 0;
  std::vector<int64_t> row;  ///< a pixel, row by row from the top: its row, or -1: not occupied
};

/// Every pixel whose row has energy, `rows` being a row a pixel.
RowsOfPicture OccupiedPixels(RowsView rows, int width, int height);

/// A square of pixels, cut at the picture's edge.
struct Block {
  int x = 0, y = 0, side = 0;
  PatchSize size = {};  ///< occupied pixels, measured terms
};

struct BlockDivision {
  /// A block each in `blocks`' order. Rows that no pixel stands for are in a cluster of their own,
  /// the last one.
  Clustering clustering;
  std::vector<Block> blocks;
  RenderingCost cost;
};

/// When a quadtree's blocks are divided.
enum class QuadtreeRule {
  kWhilePaying,  ///< the paper's: as long as d > 0
  kCheapest,     ///< wherever the cheapest division of the quarters, however deep, is cheaper
};

struct BlockOptions {
  double energy_share = 0.999;  ///< of every block's energy
  double global_terms = 0;      ///< N
};

/// Blockwise PCA with blocks of one size (Nayar 2004; Mahajan 2007, Section 4.3). Black pixels are
/// no pixels, blocks of nothing else no blocks. Throws Error when the picture does not fit the rows
/// or an option is out of range.
BlockDivision FixedBlocks(RowsView rows, const RowsOfPicture& picture, int side,
                          const BlockOptions& options);

struct QuadtreeOptions {
  int largest = 64;  ///< side of the blocks to begin with, a power of two
  int smallest = 1;  ///< not divided further
  QuadtreeRule rule = QuadtreeRule::kWhilePaying;
  BlockOptions blocks = {};
};

/// Blocks divided adaptively into four (Mahajan 2007, Sections 4.2 and 5.3).
BlockDivision DivideBlocks(RowsView rows, const RowsOfPicture& picture,
                           const QuadtreeOptions& options);

}  // namespace lfm
