// SPDX-License-Identifier: BSD-3-Clause
#include "fields/block_pca.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/compact_rows.h"
#include "fields/matrix_products.h"

namespace lfm {
namespace {

// A block with its rows: their numbers and coordinates.
struct Node {
  Block block;
  std::vector<int64_t> rows;
  std::vector<int> x, y;
  CompactRows compact;
};

void Check(RowsView rows, const RowsOfPicture& picture, const BlockOptions& options) {
  const bool fits = picture.width >= 0 && picture.height >= 0 &&
                    picture.row.size() == static_cast<size_t>(picture.width) * picture.height &&
                    std::all_of(picture.row.begin(), picture.row.end(),
                                [&](int64_t row) { return row >= -1 && row < rows.rows; });
  if (!fits) throw Error("block PCA: the picture does not fit the rows");
  if (!(options.energy_share > 0) || !(options.energy_share <= 1) || !(options.global_terms >= 0) ||
      !std::isfinite(options.global_terms)) {
    throw Error("block PCA: an option is out of range");
  }
}

std::vector<Node> Grid(const RowsOfPicture& picture, int side) {
  std::vector<Node> nodes;
  for (int y = 0; y < picture.height; y += side) {
    for (int x = 0; x < picture.width; x += side) {
      Node node;
      node.block = {.x = x, .y = y, .side = side};
      for (int j = y; j < std::min(y + side, picture.height); ++j) {
        for (int i = x; i < std::min(x + side, picture.width); ++i) {
          const int64_t row = picture.row[int64_t{j} * picture.width + i];
          if (row < 0) continue;
          node.rows.push_back(row);
          node.x.push_back(i);
          node.y.push_back(j);
        }
      }
      node.block.size.pixels = static_cast<int64_t>(node.rows.size());
      if (!node.rows.empty()) nodes.push_back(std::move(node));
    }
  }
  return nodes;
}

std::vector<Node> Quarters(const Node& node, double share) {
  const int half = node.block.side / 2;
  std::vector<Node> quarters;
  for (int q = 0; q < 4; ++q) {
    Node quarter;
    quarter.block = {
        .x = node.block.x + q % 2 * half, .y = node.block.y + q / 2 * half, .side = half};
    std::vector<int64_t> which;
    for (size_t i = 0; i < node.rows.size(); ++i) {
      const int column = (node.x[i] - node.block.x) / half,
                line = (node.y[i] - node.block.y) / half;
      if (2 * line + column != q) continue;
      which.push_back(static_cast<int64_t>(i));
      quarter.rows.push_back(node.rows[i]);
      quarter.x.push_back(node.x[i]);
      quarter.y.push_back(node.y[i]);
    }
    if (which.empty()) continue;
    quarter.compact = PartOf(node.compact, which);
    quarter.block.size = {static_cast<int64_t>(which.size()), TermsNeeded(quarter.compact, share)};
    quarters.push_back(std::move(quarter));
  }
  return quarters;
}

struct Leaves {
  std::vector<Node> nodes;
  double cost = 0;
};

class Quadtree {
 public:
  explicit Quadtree(const QuadtreeOptions& options) : options_(options) {}

  Leaves Divide(Node node) const {
    const double global = options_.blocks.global_terms;
    const double cost = CostOf({&node.block.size, 1}, global).Total();
    Leaves whole{{}, cost};
    if (node.block.side / 2 < std::max(1, options_.smallest)) {
      whole.nodes.push_back(std::move(node));
      return whole;
    }
    node.compact = CompactedRows(node.compact.coordinates.View(), std::move(node.compact.energies),
                                 (1 - options_.blocks.energy_share) / 1024);
    std::vector<Node> quarters = Quarters(node, options_.blocks.energy_share);
    Leaves parts;
    for (Node& quarter : quarters) {
      parts.cost += CostOf({&quarter.block.size, 1}, global).Total();
    }
    if (options_.rule == QuadtreeRule::kWhilePaying && parts.cost >= cost) {
      whole.nodes.push_back(std::move(node));
      return whole;
    }
    parts.cost = 0;
    for (Node& quarter : quarters) {
      Leaves leaves = Divide(std::move(quarter));
      parts.cost += leaves.cost;
      for (Node& leaf : leaves.nodes) parts.nodes.push_back(std::move(leaf));
    }
    if (parts.cost < cost) return parts;
    whole.nodes.push_back(std::move(node));
    return whole;
  }

 private:
  const QuadtreeOptions& options_;
};

BlockDivision DivisionOf(const std::vector<Node>& nodes, int64_t rows, double global_terms) {
  BlockDivision result;
  result.clustering.cluster.assign(static_cast<size_t>(rows), -1);
  std::vector<PatchSize> sizes;
  for (const Node& node : nodes) {
    for (const int64_t row : node.rows) {
      result.clustering.cluster[row] = static_cast<int>(result.blocks.size());
    }
    result.blocks.push_back(node.block);
    sizes.push_back(node.block.size);
  }
  result.clustering.clusters = static_cast<int>(nodes.size());
  bool rest = false;
  for (int& cluster : result.clustering.cluster) {
    if (cluster >= 0) continue;
    cluster = static_cast<int>(nodes.size());
    rest = true;
  }
  result.clustering.clusters += rest ? 1 : 0;
  result.cost = CostOf(sizes, global_terms);
  return result;
}

}  // namespace

RowsOfPicture OccupiedPixels(RowsView rows, int width, int height) {
  if (width < 0 || height < 0 || int64_t{width} * height != rows.rows) {
    throw Error("block PCA: the picture does not fit the rows");
  }
  const std::vector<double> energies = RowEnergies(rows);
  RowsOfPicture picture{width, height, std::vector<int64_t>(energies.size(), -1)};
  for (int64_t row = 0; row < rows.rows; ++row) {
    if (!(energies[row] <= 0)) picture.row[row] = row;
  }
  return picture;
}

BlockDivision FixedBlocks(RowsView rows, const RowsOfPicture& picture, int side,
                          const BlockOptions& options) {
  Check(rows, picture, options);
  if (side < 1) throw Error("block PCA: blocks need a pixel at least");
  std::vector<Node> nodes = Grid(picture, side);
  ParallelFor(0, static_cast<int64_t>(nodes.size()), [&](int64_t i) {
    nodes[i].block.size.terms =
        TermsNeeded(GatherRows(rows, nodes[i].rows).View(), options.energy_share);
  });
  return DivisionOf(nodes, rows.rows, options.global_terms);
}

BlockDivision DivideBlocks(RowsView rows, const RowsOfPicture& picture,
                           const QuadtreeOptions& options) {
  Check(rows, picture, options.blocks);
  const int side = options.largest;
  if (side < 1 || (side & (side - 1)) != 0 || options.smallest < 1) {
    throw Error("block PCA: the largest block's side must be a power of two, the smallest 1");
  }
  std::vector<Node> first = Grid(picture, side);
  std::vector<Leaves> leaves(first.size());
  ParallelFor(0, static_cast<int64_t>(first.size()), [&](int64_t i) {
    Node node = std::move(first[i]);
    const FunctionRows own = GatherRows(rows, node.rows);
    const double share = options.blocks.energy_share;
    node.compact = CompactedRows(own.View(), RowEnergies(own.View()), (1 - share) / 1024);
    node.block.size.terms = TermsNeeded(node.compact, share);
    leaves[i] = Quadtree(options).Divide(std::move(node));
  });
  std::vector<Node> nodes;
  for (Leaves& part : leaves) {
    for (Node& node : part.nodes) nodes.push_back(std::move(node));
  }
  return DivisionOf(nodes, rows.rows, options.blocks.global_terms);
}

}  // namespace lfm
