// SPDX-License-Identifier: BSD-3-Clause
#include "encode/gutters.h"

#include <gtest/gtest.h>

#include "encode/encode.h"
#include "encode/quantization.h"
#include "encode/separate_layout.h"
#include "encode/tiling.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

class Gutters : public ::testing::Test {
 protected:
  Gutters() {
    const SyntheticLightField field = MakeLightField(
        MakeSphere(1), 8, 60, [](int t) { return t % 2 == 0 ? 9 : 5; }, GlossyAppearance);
    model_ = JoinSurfaceMaps(Encode(field.Source(), {.terms = 2}, SilentProgress()).model);
  }
  int Code(const std::vector<Image>& pages, int triangle, int i, int j, int channel) const {
    const PatchPlacement& place = model_.placements[triangle];
    const Eigen::Vector2i texel = TexelOfSample(place, i, j);
    return pages[place.page].At<uint8_t>(texel.x(), texel.y(), channel);
  }
  LightFieldModel model_;
};

TEST_F(Gutters, CompletionsMakeTheHypotenuseLinearWithoutClamping) {
  for (int t = 0; t < static_cast<int>(model_.placements.size()); ++t) {
    const int n = model_.placements[t].edge_samples;
    for (int i = 1; i < n; ++i) {
      for (int c = 0; c < 3; ++c) {
        std::vector<const std::vector<Image>*> lists = {&model_.mean_pages};
        for (int k = 0; k < model_.TriangleTerms(t); ++k) lists.push_back(&model_.surface_pages[k]);
        for (const auto* pages : lists) {
          const int a = Code(*pages, t, i - 1, n - 1 - i, c), b = Code(*pages, t, i, n - 1 - i, c);
          const int c_code = Code(*pages, t, i - 1, n - i, c), d = Code(*pages, t, i, n - i, c);
          ASSERT_EQ(d, b + c_code - a);
        }
      }
    }
  }
}

// Codes left and right of a leg belong to the two sides of one edge: a smooth mean changes slowly.
TEST_F(Gutters, LegsGoOnIntoTheNeighbour) {
  const auto neighbors = ComputeTriangleNeighbors(model_.mesh);
  int compared = 0;
  for (int t = 0; t < static_cast<int>(model_.placements.size()); ++t) {
    const int n = model_.placements[t].edge_samples;
    for (const int edge : {0, 2}) {
      const int other = neighbors[t][edge];
      const int m = model_.placements[other].edge_samples;
      for (int k = 0; k < n; ++k) {
        const int i = edge == 0 ? k : -1, j = edge == 0 ? -1 : k;
        bool found = false;
        for (int y = 0; y < m && !found; ++y) {
          for (int x = 0; x + y < m && !found; ++x) {
            found = true;
            for (int c = 0; c < 3; ++c) {
              found &=
                  Code(model_.mean_pages, other, x, y, c) == Code(model_.mean_pages, t, i, j, c);
            }
          }
        }
        ASSERT_TRUE(found) << "gutter of triangle " << t << " is no sample of " << other;
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(Code(model_.mean_pages, t, i, j, c),
                      Code(model_.mean_pages, t, std::max(i, 0), std::max(j, 0), c), 40);
        }
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 100);
}

TEST_F(Gutters, MapsOfTheFarCornerEndAtZeroBeyondTheLegs) {
  for (int t = 0; t < static_cast<int>(model_.placements.size()); ++t) {
    const int n = model_.placements[t].edge_samples;
    const int far_vertex = model_.mesh.triangles[t][2];  // opposite edge 0
    const MapRange& range = model_.surface_ranges[far_vertex];
    for (int i = 0; i < n; ++i) {
      ASSERT_EQ(Code(model_.surface_pages[0], t, i, -1, 2), ZeroCode(range));
      ASSERT_EQ(Code(model_.surface_pages[0], t, i, 0, 2), ZeroCode(range));
    }
  }
}

TEST(GuttersAtABoundary, RepeatTheEdge) {
  SyntheticLightField field = MakeLightField(
      MakeSphere(0), 4, 40, [](int) { return 4; }, GlossyAppearance);
  field.mesh.triangles.resize(1);
  field.triangles.resize(1);
  const LightFieldModel model = Encode(field.Source(), {.terms = 1}, SilentProgress()).model;
  const PatchPlacement& place = model.placements[0];
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2i below = TexelOfSample(place, k, -1), own = TexelOfSample(place, k, 0);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(model.mean_pages[0].At<uint8_t>(below.x(), below.y(), c),
                model.mean_pages[0].At<uint8_t>(own.x(), own.y(), c));
    }
  }
}

}  // namespace
}  // namespace lfm::testing
