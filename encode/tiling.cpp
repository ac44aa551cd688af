// SPDX-License-Identifier: BSD-3-Clause
#include "encode/tiling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int64_t kSearchBudget = 20'000'000;  // rectangles set while searching for page widths

// One rectangle: two triangles of equal n, or one.
struct Rectangle {
  int edge_samples = 2;
  int first = 0, second = -1;
  int width() const { return edge_samples + 4; }
  int height() const { return edge_samples + 3; }
  int64_t area() const { return int64_t{width()} * height(); }
};

std::vector<Rectangle> PairTriangles(std::span<const int> edge_samples) {
  std::vector<int> order(edge_samples.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return edge_samples[a] > edge_samples[b]; });
  std::vector<Rectangle> rectangles;
  for (size_t i = 0; i < order.size(); ++i) {
    Rectangle rectangle{edge_samples[order[i]], order[i]};
    if (i + 1 < order.size() && edge_samples[order[i + 1]] == rectangle.edge_samples) {
      rectangle.second = order[++i];
    }
    rectangles.push_back(rectangle);
  }
  return rectangles;
}

// Calls `set(rectangle, x, y)` for each rectangle; returns the height of the page. Heights descend,
// so whatever is next fits on the shelf.
template <typename Set>
int FillShelves(std::span<const Rectangle> rectangles, int page_width, const Set& set) {
  int x = 0, y = 0, shelf = 0;
  for (const Rectangle& rectangle : rectangles) {
    if (x + rectangle.width() > page_width) {
      y += shelf;
      x = shelf = 0;
    }
    shelf = std::max(shelf, rectangle.height());
    set(rectangle, x, y);
    x += rectangle.width();
  }
  return y + shelf;
}

std::optional<Eigen::Vector2i> BestPageSize(std::span<const Rectangle> rectangles, int max_size) {
  int64_t area = 0;
  for (const Rectangle& rectangle : rectangles) area += rectangle.area();
  const double side = std::sqrt(static_cast<double>(area));
  const int widest = rectangles.front().width();
  const int low = std::clamp(static_cast<int>(side / 2), widest, max_size);
  const int high = std::clamp(static_cast<int>(side * 2) + widest, low, max_size);
  const int64_t tries =
      std::max<int64_t>(32, kSearchBudget / static_cast<int64_t>(rectangles.size()));
  const int step = static_cast<int>(std::max<int64_t>(1, (high - low) / tries));
  std::optional<Eigen::Vector2i> best;
  const auto cost = [&](const Eigen::Vector2i& size) {
    // Ties go to the squarer page.
    return static_cast<double>(size.x()) * size.y() + 1e-3 * std::abs(size.x() - size.y());
  };
  for (int width = low; width <= high; width += step) {
    int used = 0;
    const int height = FillShelves(rectangles, width, [&](const Rectangle& r, int x, int) {
      used = std::max(used, x + r.width());
    });
    if (height > max_size) continue;
    const Eigen::Vector2i size(used, height);
    if (!best || cost(size) < cost(*best)) best = size;
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
  const int n = rectangle.edge_samples;
  layout.placements[rectangle.first] = {page, {x + 1, y + 1}, false, n};
  if (rectangle.second >= 0) {
    layout.placements[rectangle.second] = {page, {x + n + 2, y + n + 1}, true, n};
  }
}

}  // namespace

PatchLayout PlacePatches(std::span<const int> edge_samples, int max_texture_size) {
  PatchLayout layout;
  layout.placements.resize(edge_samples.size());
  if (edge_samples.empty()) return layout;
  const auto [least, most] = std::minmax_element(edge_samples.begin(), edge_samples.end());
  if (*least < 2 || *most + 4 > max_texture_size) {
    throw Error("tiling: patches of " + std::to_string(*most) +
                " samples an edge do not fit a page of " + std::to_string(max_texture_size) +
                " texels; raise --max-texture-size");
  }
  const std::vector<Rectangle> rectangles = PairTriangles(edge_samples);
  for (int pages = 1;; ++pages) {
    layout.page_sizes.clear();
    const auto runs = SplitRectangles(rectangles, pages);
    for (const auto& run : runs) {
      const auto size = BestPageSize(run, max_texture_size);
      if (!size) break;
      FillShelves(run, size->x(), [&](const Rectangle& r, int x, int y) {
        SetTriangles(r, static_cast<int>(layout.page_sizes.size()), x, y, layout);
      });
      layout.page_sizes.push_back(*size);
    }
    if (layout.page_sizes.size() == runs.size()) return layout;
  }
}

ViewLayout PlaceViews(int vertices, int grid, int max_texture_size) {
  const int side = max_texture_size / grid;
  if (side < 1) {
    throw Error("tiling: a view map of " + std::to_string(grid) +
                " texels a side does not fit a page; raise --max-texture-size");
  }
  ViewLayout layout;
  if (vertices == 0) return layout;
  const auto divide_up = [](int a, int b) { return (a + b - 1) / b; };
  const int pages = divide_up(vertices, side * side);
  layout.tiles_per_page = divide_up(vertices, pages);
  const auto cost = [&](int columns) {
    const int rows = divide_up(layout.tiles_per_page, columns);
    return rows > side ? 1e18
                       : columns * static_cast<double>(rows) + 1e-3 * std::abs(columns - rows);
  };
  const int root = static_cast<int>(std::sqrt(layout.tiles_per_page));
  layout.tiles_per_row = side;
  for (int columns = std::max(1, root / 2); columns <= std::min(side, 2 * root + 2); ++columns) {
    if (cost(columns) < cost(layout.tiles_per_row)) layout.tiles_per_row = columns;
  }
  for (int first = 0; first < vertices; first += layout.tiles_per_page) {
    const int tiles = std::min(layout.tiles_per_page, vertices - first);
    layout.page_sizes.emplace_back(std::min(tiles, layout.tiles_per_row) * grid,
                                   divide_up(tiles, layout.tiles_per_row) * grid);
  }
  return layout;
}

}  // namespace lfm
