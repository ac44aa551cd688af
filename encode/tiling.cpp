// SPDX-License-Identifier: BSD-3-Clause
#include "encode/tiling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMaxTerms = 16;
constexpr int64_t kSearchBudget = 20'000'000;  // rectangles set while searching for page widths

constexpr int kBlockSide = 4;

int WholeBlocks(int side) { return (side + kBlockSide - 1) / kBlockSide * kBlockSide; }

// One rectangle: two triangles of equal n and terms, or one.
struct Rectangle {
  int edge_samples = 2;
  int terms = 0;
  int first = 0, second = -1;
  PatchSpacing spacing = PatchSpacing::kNeighbors;
  PatchAlignment alignment = PatchAlignment::kTexels;
  int margin() const { return spacing == PatchSpacing::kNeighbors ? 1 : 0; }
  int diagonal() const { return spacing == PatchSpacing::kNone ? 0 : 1; }
  int width() const {
    const int side = edge_samples + 1 + diagonal() + 2 * margin();
    return alignment == PatchAlignment::kRectangles ? WholeBlocks(side) : side;
  }
  int height() const {
    const int side = edge_samples + diagonal() + 2 * margin();
    return alignment >= PatchAlignment::kShelves ? WholeBlocks(side) : side;
  }
  // The side of a page that ends where this rectangle does.
  int PageSide(int side) const {
    return alignment == PatchAlignment::kTexels ? side : WholeBlocks(side);
  }
  int64_t area() const { return int64_t{width()} * height(); }
};

int DivideUp(int a, int b) { return (a + b - 1) / b; }

std::vector<Rectangle> PairTriangles(std::span<const int> edge_samples, std::span<const int> terms,
                                     PatchSpacing spacing, PatchAlignment alignment) {
  const auto kind = [&](int t) { return std::pair(terms.empty() ? 0 : terms[t], edge_samples[t]); };
  std::vector<int> order(edge_samples.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return kind(a) > kind(b); });
  std::vector<Rectangle> rectangles;
  for (size_t i = 0; i < order.size(); ++i) {
    Rectangle rectangle{
        edge_samples[order[i]], kind(order[i]).first, order[i], -1, spacing, alignment};
    if (i + 1 < order.size() && kind(order[i + 1]) == kind(order[i])) {
      rectangle.second = order[++i];
    }
    rectangles.push_back(rectangle);
  }
  return rectangles;
}

using TermHeights = std::array<int, kMaxTerms + 1>;  // of the page of each term; the last is 0

// Calls `set(rectangle, x, y)` for each rectangle; returns the height of the page, and of what of
// it each term takes. Among equal terms heights descend, so whatever is next fits on the shelf; a
// higher one starts the next.
template <typename Set>
std::pair<int, TermHeights> FillShelves(std::span<const Rectangle> rectangles, int page_width,
                                        const Set& set) {
  int x = 0, y = 0, shelf = 0;
  TermHeights heights{};
  for (const Rectangle& rectangle : rectangles) {
    if (x > 0 && (x + rectangle.width() > page_width || rectangle.height() > shelf)) {
      y += shelf;
      x = shelf = 0;
    }
    shelf = std::max(shelf, rectangle.height());
    if (rectangle.terms > 0) {
      int& height = heights[rectangle.terms - 1];
      height = std::max(height, y + rectangle.height());
    }
    set(rectangle, x, y);
    x += rectangle.width();
  }
  for (int k = kMaxTerms - 1; k >= 0; --k) {
    heights[k] = rectangles.front().PageSide(std::max(heights[k], heights[k + 1]));
  }
  return {rectangles.front().PageSide(y + shelf), heights};
}

std::optional<Eigen::Vector2i> BestPageSize(std::span<const Rectangle> rectangles, int max_size) {
  int64_t area = 0;
  for (const Rectangle& rectangle : rectangles) area += rectangle.area();
  const double side = std::sqrt(static_cast<double>(area));
  int widest = 0;
  for (const Rectangle& rectangle : rectangles) widest = std::max(widest, rectangle.width());
  const int low = std::clamp(static_cast<int>(side / 2), widest, max_size);
  const int high = std::clamp(static_cast<int>(side * 2) + widest, low, max_size);
  const int64_t tries =
      std::max<int64_t>(32, kSearchBudget / static_cast<int64_t>(rectangles.size()));
  const int step = static_cast<int>(std::max<int64_t>(1, (high - low) / tries));
  std::optional<Eigen::Vector2i> best;
  double least = HUGE_VAL;
  for (int width = low; width <= high; width += step) {
    int used = 0;
    const auto [height, term_heights] =
        FillShelves(rectangles, rectangles.front().PageSide(width),
                    [&](const Rectangle& r, int x, int) { used = std::max(used, x + r.width()); });
    used = rectangles.front().PageSide(used);
    if (height > max_size || used > max_size) continue;
    const int64_t rows = std::accumulate(term_heights.begin(), term_heights.end(), int64_t{height});
    // Ties go to the squarer page.
    const double cost = static_cast<double>(used * rows) + 1e-3 * std::abs(used - height);
    if (cost >= least) continue;
    least = cost;
    best = Eigen::Vector2i(used, height);
  }
  return best;
}

// Runs of nearly equal area, one a page.
std::vector<std::span<const Rectangle>> SplitRectangles(std::span<const Rectangle> rectangles,
                                                        int pages) {
  int64_t total = 0;
  for (const Rectangle& rectangle : rectangles) total += rectangle.area();
  std::vector<std::span<const Rectangle>> runs;
  size_t begin = 0;
  int64_t sum = 0;
  for (size_t i = 0; i < rectangles.size(); ++i) {
    sum += rectangles[i].area();
    const int64_t target = total * static_cast<int64_t>(runs.size() + 1) / pages;
    if (sum >= target) {
      runs.push_back(rectangles.subspan(begin, i + 1 - begin));
      begin = i + 1;
    }
  }
  return runs;
}

void SetTriangles(const Rectangle& rectangle, int page, int x, int y, PatchLayout& layout) {
  const int n = rectangle.edge_samples, margin = rectangle.margin(),
            diagonal = rectangle.diagonal();
  layout.placements[rectangle.first] = {page, {x + margin, y + margin}, false, n};
  if (rectangle.second >= 0) {
    layout.placements[rectangle.second] = {
        page, {x + margin + n + diagonal, y + margin + n - 1 + diagonal}, true, n};
  }
}

void SetPage(std::span<const Rectangle> rectangles, const Eigen::Vector2i& size,
             PatchLayout& layout) {
  const int page = static_cast<int>(layout.page_sizes.size());
  const auto [height, term_heights] =
      FillShelves(rectangles, size.x(),
                  [&](const Rectangle& r, int x, int y) { SetTriangles(r, page, x, y, layout); });
  layout.page_sizes.emplace_back(size.x(), height);
  for (size_t k = 0; k < layout.term_page_sizes.size(); ++k) {
    if (term_heights[k] > 0) layout.term_page_sizes[k].emplace_back(size.x(), term_heights[k]);
  }
}

}  // namespace

PatchLayout PlacePatches(std::span<const int> edge_samples, std::span<const int> terms,
                         int max_texture_size, PatchSpacing spacing, PatchAlignment alignment) {
  PatchLayout layout;
  layout.placements.resize(edge_samples.size());
  if (edge_samples.empty()) return layout;
  if (!terms.empty() && terms.size() != edge_samples.size()) {
    throw Error("tiling: one number of terms a triangle is needed", ErrorKind::kSystem);
  }
  for (const int k : terms) {
    if (k < 0 || k > kMaxTerms) throw Error("tiling: terms must lie in [0, 16]");
  }
  const auto [least, most] = std::minmax_element(edge_samples.begin(), edge_samples.end());
  const Rectangle largest{*most, 0, 0, -1, spacing, alignment};
  if (*least < 2 || largest.PageSide(largest.width()) > max_texture_size) {
    throw Error("tiling: patches of " + std::to_string(*most) +
                " samples an edge do not fit a page of " + std::to_string(max_texture_size) +
                " texels; raise --max-texture-size");
  }
  const std::vector<Rectangle> rectangles = PairTriangles(edge_samples, terms, spacing, alignment);
  int64_t area = 0;
  for (const Rectangle& rectangle : rectangles) area += rectangle.area();
  // Fewer pages than this cannot hold them.
  const int64_t least_pages =
      std::max<int64_t>(1, area / (int64_t{max_texture_size} * max_texture_size));
  for (int pages = static_cast<int>(least_pages);; ++pages) {
    layout.page_sizes.clear();
    layout.term_page_sizes.assign(rectangles.front().terms, {});
    const auto runs = SplitRectangles(rectangles, pages);
    for (const auto& run : runs) {
      const auto size = BestPageSize(run, max_texture_size);
      if (!size) break;
      SetPage(run, *size, layout);
    }
    if (layout.page_sizes.size() == runs.size()) return layout;
  }
}

ViewLayout PlaceViews(int tiles, int grid, int max_texture_size) {
  const int side = max_texture_size / grid;
  if (side < 1) {
    throw Error("tiling: a view map of " + std::to_string(grid) +
                " texels a side does not fit a page; raise --max-texture-size");
  }
  ViewLayout layout;
  if (tiles == 0) return layout;
  const int pages = DivideUp(tiles, side * side);
  layout.tiles_per_page = DivideUp(tiles, pages);
  const auto cost = [&](int columns) {
    const int rows = DivideUp(layout.tiles_per_page, columns);
    return rows > side ? 1e18
                       : columns * static_cast<double>(rows) + 1e-3 * std::abs(columns - rows);
  };
  const int root = static_cast<int>(std::sqrt(layout.tiles_per_page));
  layout.tiles_per_row = side;
  for (int columns = std::max(1, root / 2); columns <= std::min(side, 2 * root + 2); ++columns) {
    if (cost(columns) < cost(layout.tiles_per_row)) layout.tiles_per_row = columns;
  }
  layout.page_sizes = ViewPageSizes(layout, tiles, grid);
  return layout;
}

std::vector<Eigen::Vector2i> ViewPageSizes(const ViewLayout& layout, int tiles, int grid) {
  std::vector<Eigen::Vector2i> sizes;
  for (int first = 0; first < tiles; first += layout.tiles_per_page) {
    const int count = std::min(layout.tiles_per_page, tiles - first);
    sizes.emplace_back(std::min(count, layout.tiles_per_row) * grid,
                       DivideUp(count, layout.tiles_per_row) * grid);
  }
  return sizes;
}

}  // namespace lfm
