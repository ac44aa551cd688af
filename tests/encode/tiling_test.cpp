// SPDX-License-Identifier: BSD-3-Clause
#include "encode/tiling.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <random>

#include "core/error.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

// Every sample and gutter texel of every patch, once each, inside its page.
void ExpectDisjointAndInside(const PatchLayout& layout, const std::vector<int>& edge_samples,
                             int max_size) {
  std::vector<std::vector<int>> owner;
  for (const auto& size : layout.page_sizes) {
    ASSERT_LE(size.maxCoeff(), max_size);
    owner.emplace_back(static_cast<size_t>(size.x()) * size.y(), -1);
  }
  ASSERT_EQ(layout.placements.size(), edge_samples.size());
  for (size_t t = 0; t < edge_samples.size(); ++t) {
    const PatchPlacement& p = layout.placements[t];
    const int n = edge_samples[t];
    ASSERT_EQ(p.edge_samples, n);
    ASSERT_LT(p.page, static_cast<int>(owner.size()));
    for (int j = -1; j <= n; ++j) {
      for (int i = -1; i <= n; ++i) {
        if (i + j > n) continue;
        const Eigen::Vector2i texel = TexelOfSample(p, i, j);
        const auto& size = layout.page_sizes[p.page];
        ASSERT_GE(texel.minCoeff(), 0);
        ASSERT_LT(texel.x(), size.x());
        ASSERT_LT(texel.y(), size.y());
        int& place = owner[p.page][static_cast<size_t>(texel.y()) * size.x() + texel.x()];
        ASSERT_EQ(place, -1) << "triangles " << place << " and " << t;
        place = static_cast<int>(t);
      }
    }
  }
}

// Whole blocks of 4 x 4 texels: of pages, of rows of rectangles, or of each.
TEST(Tiling, AlignsPagesOrRectanglesToBlocks) {
  std::mt19937 random(6);
  std::vector<int> sizes(333);
  for (int& n : sizes) n = 2 + static_cast<int>(random() % 30);
  for (const int max_size : {4096, 255}) {
    for (const auto alignment :
         {PatchAlignment::kPages, PatchAlignment::kShelves, PatchAlignment::kRectangles}) {
      const PatchLayout layout =
          PlacePatches(sizes, {}, max_size, PatchSpacing::kCompletions, alignment);
      for (const auto& size : layout.page_sizes) {
        EXPECT_EQ(size.x() % 4, 0);
        EXPECT_EQ(size.y() % 4, 0);
        EXPECT_LE(size.maxCoeff(), max_size);
      }
      int unflipped = 0, columns = 0, rows = 0;
      for (const PatchPlacement& p : layout.placements) {
        unflipped += !p.flipped;
        columns += !p.flipped && p.origin.x() % 4 == 0;
        rows += !p.flipped && p.origin.y() % 4 == 0;
      }
      EXPECT_EQ(columns == unflipped, alignment == PatchAlignment::kRectangles);
      EXPECT_EQ(rows == unflipped, alignment != PatchAlignment::kPages);
    }
  }
}

// Two patches of equal n fill their rectangle: pages hold samples and next to nothing else.
TEST(Tiling, NothingStandsBetweenPatchesWithoutSpacing) {
  std::vector<int> sizes(2200, 25);
  for (size_t t = 0; t < 700; ++t) sizes[t] = 13;
  const PatchLayout layout =
      PlacePatches(sizes, {}, 4096, PatchSpacing::kNone, PatchAlignment::kPages);
  ASSERT_EQ(layout.page_sizes.size(), 1u);
  const Eigen::Vector2i size = layout.page_sizes[0];
  std::vector<int> owner(static_cast<size_t>(size.x()) * size.y(), -1);
  int64_t samples = 0;
  for (size_t t = 0; t < sizes.size(); ++t) {
    for (int j = 0; j < sizes[t]; ++j) {
      for (int i = 0; i + j < sizes[t]; ++i, ++samples) {
        const Eigen::Vector2i texel = TexelOfSample(layout.placements[t], i, j);
        ASSERT_TRUE(texel.minCoeff() >= 0 && texel.x() < size.x() && texel.y() < size.y());
        int& place = owner[static_cast<size_t>(texel.y()) * size.x() + texel.x()];
        ASSERT_EQ(place, -1);
        place = static_cast<int>(t);
      }
    }
  }
  EXPECT_LT(static_cast<double>(owner.size()), 1.02 * static_cast<double>(samples));
}

double Waste(const PatchLayout& layout, const std::vector<int>& edge_samples) {
  double pages = 0, used = 0;
  for (const auto& size : layout.page_sizes) pages += static_cast<double>(size.x()) * size.y();
  for (const int n : edge_samples) used += (n + 4) * (n + 3) / 2.0;
  return pages / used - 1;
}

TEST(Tiling, PatchesAreDisjointAndInside) {
  std::mt19937 random(1);
  for (const int count : {1, 2, 3, 50, 777}) {
    std::vector<int> sizes(count);
    for (int& n : sizes) n = 2 + static_cast<int>(random() % 30);
    ExpectDisjointAndInside(PlacePatches(sizes, {}, 4096), sizes, 4096);
    ExpectDisjointAndInside(PlacePatches(sizes, {}, 256), sizes, 256);
  }
}

TEST(Tiling, WastesLittle) {
  std::mt19937 random(2);
  std::vector<int> equal(2200, 25), mixed(5000), few_sizes(3000);
  for (int& n : mixed) n = 9 + static_cast<int>(random() % 17);
  for (int& n : few_sizes) n = random() % 3 == 0 ? 17 : random() % 2 == 0 ? 25 : 33;
  for (const auto& sizes : {equal, mixed, few_sizes}) {
    const PatchLayout layout = PlacePatches(sizes, {}, 4096);
    EXPECT_EQ(layout.page_sizes.size(), 1u);
    EXPECT_LT(Waste(layout, sizes), 0.02);
  }
}

// The paper's mode: 314 samples a triangle, 32 x 32 directions, three terms, twice as many
// triangles as vertices. Reached by 24 and 25 samples an edge in equal shares (312.5).
TEST(Tiling, PaperModeStaysAboveOneHundredToOne) {
  std::vector<int> sizes(2200);
  double dense = 0, texels = 0;
  for (size_t t = 0; t < sizes.size(); ++t) {
    sizes[t] = t % 2 == 0 ? 24 : 25;
    dense += 3.0 * PatchSampleCount(sizes[t]) * 1024;
  }
  for (const auto& size : PlacePatches(sizes, {}, 4096).page_sizes) {
    texels += static_cast<double>(size.x()) * size.y();
  }
  double views = 0;
  const int vertices = 1102;
  for (const auto& size : PlaceViews(vertices, 32, 4096).page_sizes) {
    views += static_cast<double>(size.x()) * size.y();
  }
  const double ranges = 2.0 * 3 * vertices * sizeof(MapRange);
  EXPECT_GE(dense / (12 * texels + 9 * views + ranges), 102);
}

TEST(Tiling, SplitsIntoPagesWhenOneIsTooSmall) {
  const std::vector<int> sizes(1000, 20);
  const PatchLayout layout = PlacePatches(sizes, {}, 256);
  EXPECT_GE(layout.page_sizes.size(), 4u);
  ExpectDisjointAndInside(layout, sizes, 256);
}

TEST(Tiling, RejectsPatchesLargerThanAPage) {
  const std::vector<int> too_large = {10, 300};
  EXPECT_THROW(PlacePatches(too_large, {}, 256), Error);
  const std::vector<int> too_small = {1};
  EXPECT_THROW(PlacePatches(too_small, {}, 256), Error);
  EXPECT_THROW(PlaceViews(5, 300, 256), Error);
  EXPECT_TRUE(PlacePatches({}, {}, 256).page_sizes.empty());
  EXPECT_TRUE(PlaceViews(0, 32, 256).page_sizes.empty());
}

// A term's pages are the top of the pages, hold every triangle that has the term, and little else.
TEST(Tiling, TermsTakeTheTopOfThePages) {
  std::mt19937 random(4);
  std::vector<int> sizes(3000), terms(3000);
  for (int& n : sizes) n = random() % 3 == 0 ? 7 : 13;
  for (int& k : terms) k = static_cast<int>(random() % 5);
  for (const int max_size : {4096, 256}) {
    const PatchLayout layout = PlacePatches(sizes, terms, max_size);
    ExpectDisjointAndInside(layout, sizes, max_size);
    ASSERT_EQ(layout.term_page_sizes.size(), 4u);
    for (int k = 0; k < 4; ++k) {
      const auto& pages = layout.term_page_sizes[k];
      double texels = 0, needed = 0;
      for (size_t page = 0; page < pages.size(); ++page) {
        EXPECT_EQ(pages[page].x(), layout.page_sizes[page].x());
        EXPECT_LE(pages[page].y(), layout.page_sizes[page].y());
        texels += static_cast<double>(pages[page].x()) * pages[page].y();
      }
      for (size_t t = 0; t < sizes.size(); ++t) {
        if (terms[t] <= k) continue;
        const PatchPlacement& p = layout.placements[t];
        const int n = p.edge_samples;
        needed += (n + 4) * (n + 3) / 2.0;
        ASSERT_LT(p.page, static_cast<int>(pages.size()));
        ASSERT_LT(std::max(TexelOfSample(p, -1, -1).y(), TexelOfSample(p, n, n).y()),
                  pages[p.page].y());
      }
      EXPECT_LT(texels / needed, max_size == 256 ? 1.15 : 1.06) << k << ", " << max_size;
    }
  }
  EXPECT_THROW(PlacePatches(sizes, std::vector<int>(2, 0), 256), Error);
}

TEST(Tiling, ViewTilesAreDisjointAndInside) {
  for (const int vertices : {1, 2, 63, 64, 65, 1102, 1103, 5000}) {
    for (const int max_size : {256, 4096}) {
      const ViewLayout layout = PlaceViews(vertices, 32, max_size);
      LightFieldModel model;
      model.grid = 32;
      model.view_slots.resize(vertices);
      std::iota(model.view_slots.begin(), model.view_slots.end(), 0);
      model.view_tiles_per_row = layout.tiles_per_row;
      model.view_tiles_per_page = layout.tiles_per_page;
      std::map<std::tuple<int, int, int>, int> tiles;
      double texels = 0;
      for (const auto& size : layout.page_sizes) {
        ASSERT_LE(size.maxCoeff(), max_size);
        texels += static_cast<double>(size.x()) * size.y();
      }
      for (int v = 0; v < vertices; ++v) {
        const auto tile = model.ViewTile(0, v);
        ASSERT_LT(tile.page, static_cast<int>(layout.page_sizes.size()));
        ASSERT_LE(tile.x + 32, layout.page_sizes[tile.page].x());
        ASSERT_LE(tile.y + 32, layout.page_sizes[tile.page].y());
        ASSERT_TRUE(tiles.insert({{tile.page, tile.x, tile.y}, v}).second);
        ASSERT_EQ(tile.x % 32, 0);
      }
      if (vertices > 1000 && max_size == 4096) {
        EXPECT_LT(texels / (1024.0 * vertices), 1.02) << vertices;
      }
    }
  }
}

}  // namespace
}  // namespace lfm
