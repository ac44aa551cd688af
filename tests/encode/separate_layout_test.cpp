// SPDX-License-Identifier: BSD-3-Clause
#include "encode/separate_layout.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "encode/model_layout.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

class SeparateLayout : public ::testing::Test {
 protected:
  SeparateLayout() {
    const SyntheticLightField field = MakeLightField(
        MakeSphere(1), 8, 40, [](int t) { return t % 3 == 0 ? 5 : 9; }, GlossyAppearance);
    apart_ = Encode(field.Source(), {.terms = 2, .transport_db = 0}, SilentProgress()).model;
    joined_ = JoinSurfaceMaps(apart_);
  }
  LightFieldModel apart_, joined_;
};

void ExpectSameMaps(const LightFieldModel& a, const LightFieldModel& b) {
  const VertexRings rings = ComputeVertexRings(a.mesh);
  for (int t = 0; t < static_cast<int>(a.placements.size()); ++t) {
    EXPECT_EQ(ReadMean(a, t), ReadMean(b, t));
  }
  for (int v = 0; v < static_cast<int>(a.vertex_terms.size()); ++v) {
    for (int k = 0; k < a.vertex_terms[v]; ++k) {
      const TermMaps own = ReadVertexTerm(a, rings.Ring(v), v, k);
      const TermMaps their = ReadVertexTerm(b, rings.Ring(v), v, k);
      EXPECT_EQ(own.surface_codes, their.surface_codes);
      EXPECT_EQ(own.view_codes, their.view_codes);
      EXPECT_EQ(own.surface_range.scale, their.surface_range.scale);
    }
  }
}

TEST_F(SeparateLayout, HoldsTheSameMapsInFewerBytes) {
  EXPECT_TRUE(joined_.surface_placements.empty());
  EXPECT_EQ(apart_.surface_placements.size(), 2u);
  EXPECT_TRUE(HasWholeMaps(apart_) && HasWholeMaps(joined_));
  EXPECT_LT(apart_.MapsBytes(), joined_.MapsBytes());
  for (const LightFieldModel& model :
       {joined_, SeparateSurfaceMaps(joined_, 4096),
        SeparateSurfaceMaps(joined_, 256,
                            {PatchSpacing::kCompletions, PatchSpacing::kNone,
                             PatchAlignment::kRectangles, PatchAlignment::kPages})}) {
    EXPECT_NO_THROW(ValidateModel(model, "model"));
    ExpectSameMaps(model, apart_);
    for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
      const Eigen::Vector3d weights(0.2, 0.5, 0.3), to_eye = Eigen::Vector3d(1, 2, 3).normalized();
      EXPECT_EQ(EvaluateModel(model, t, weights, to_eye),
                EvaluateModel(apart_, t, weights, to_eye));
    }
  }
}

// Mean views, which other viewers show, keep gutters all round; equal tables count once.
TEST_F(SeparateLayout, MeanViewsStayAndTablesCountOnce) {
  for (size_t i = 0; i < joined_.mean_pages.size(); ++i) {
    EXPECT_EQ(apart_.mean_pages[i].Bytes(), joined_.mean_pages[i].Bytes());
  }
  EXPECT_EQ(apart_.surface_placements[0], apart_.surface_placements[1]);
  LightFieldModel moved = apart_;
  std::swap(moved.surface_placements[1][0], moved.surface_placements[1][3]);
  EXPECT_EQ(moved.MapsBytes() - apart_.MapsBytes(),
            FindSharedPlacements(moved.surface_placements[1]).Bytes());
}

TEST_F(SeparateLayout, WhatIsSharedOrCoarserIsNotWhole) {
  LightFieldModel shared = apart_;
  shared.surface_placements[1][0] = shared.surface_placements[1][3];
  EXPECT_FALSE(HasWholeMaps(shared));
  EXPECT_THROW(JoinSurfaceMaps(shared), Error);
  LightFieldModel coarser = apart_;
  coarser.surface_placements[0][1].edge_samples = 5;
  EXPECT_FALSE(HasWholeMaps(coarser));
  LightFieldModel one_tile = apart_;
  one_tile.view_codes[1][0] = one_tile.view_codes[1][1];
  EXPECT_FALSE(HasWholeMaps(one_tile));
}

TEST_F(SeparateLayout, NoTermsNothingToPart) {
  LightFieldModel mean = joined_;
  mean.terms = 0;
  mean.vertex_terms.assign(mean.vertex_terms.size(), 0);
  mean.view_slots = RankByTerms(mean.vertex_terms);
  mean.surface_pages.clear();
  mean.view_pages.clear();
  mean.surface_ranges.clear();
  mean.view_ranges.clear();
  EXPECT_TRUE(SeparateSurfaceMaps(mean, 4096).surface_placements.empty());
  EXPECT_TRUE(HasWholeMaps(mean));
}

}  // namespace
}  // namespace lfm::testing
