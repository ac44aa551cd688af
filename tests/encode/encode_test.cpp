// SPDX-License-Identifier: BSD-3-Clause
#include "encode/encode.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/model_evaluation.h"
#include "encode/tiling.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

SyntheticLightField Glossy(int edge_samples = 9) {
  return MakeLightField(
      MakeSphere(1), 12, 120, [=](int) { return edge_samples; }, GlossyAppearance);
}

// RMS of the shown colours against the appearance itself, in levels, seen from the front.
double ErrorInLevels(const LightFieldModel& model, const Appearance& appearance, int terms) {
  double sum = 0;
  int count = 0;
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    const Eigen::Vector3d normal = TriangleNormal(model.mesh, t);
    for (const Eigen::Vector3d& w : {Eigen::Vector3d(0.3, 0.3, 0.4), Eigen::Vector3d(0.8, 0.1, 0.1),
                                     Eigen::Vector3d(0.1, 0.5, 0.4)}) {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      for (int c = 0; c < 3; ++c) p += w[c] * model.mesh.vertices[model.mesh.triangles[t][c]];
      for (const Eigen::Vector3d& tilt :
           {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0, 0.3, 0.2)}) {
        const Eigen::Vector3d to_eye = (normal + tilt).normalized();
        const Eigen::Vector3f shown = EvaluateModel(model, t, w, to_eye, {terms});
        sum += (shown.cast<double>() - appearance(p, to_eye)).squaredNorm();
        count += 3;
      }
    }
  }
  return 255 * std::sqrt(sum / count);
}

TEST(Encode, TermsBringTheHighlightsBack) {
  const SyntheticLightField field = Glossy();
  const EncodeResult result = Encode(field.Source(), {.terms = 4}, SilentProgress());
  const double mean_only = ErrorInLevels(result.model, GlossyAppearance, 0);
  const double all = ErrorInLevels(result.model, GlossyAppearance, 4);
  EXPECT_LT(all, 0.6 * mean_only);
  EXPECT_GT(result.matrix_psnr_db, result.matrix_psnr_mean_only_db + 6);
  EXPECT_GT(result.matrix_psnr_db, 38);
  ASSERT_EQ(result.singular_value_share.size(), 4u);
  double total = 0;
  for (const double share : result.singular_value_share) total += share;
  EXPECT_GT(result.singular_value_share[0], result.singular_value_share[1]);
  EXPECT_GT(total, 0.8);
  EXPECT_LE(total, 1.001);
}

TEST(Encode, SaysWhatFewerTermsWouldReach) {
  const SyntheticLightField field = Glossy();
  const EncodeResult three = Encode(field.Source(), {.terms = 3}, SilentProgress());
  const EncodeResult two = Encode(field.Source(), {.terms = 2}, SilentProgress());
  ASSERT_EQ(three.matrix_psnr_by_terms_db.size(), 4u);
  EXPECT_DOUBLE_EQ(three.matrix_psnr_by_terms_db[0], three.matrix_psnr_mean_only_db);
  EXPECT_NEAR(three.matrix_psnr_by_terms_db[2], two.matrix_psnr_db, 1e-4);
  EXPECT_DOUBLE_EQ(three.matrix_psnr_by_terms_db[3], three.matrix_psnr_db);
}

TEST(Encode, CountsItsBytes) {
  const SyntheticLightField field = Glossy();
  const EncodeResult result = Encode(field.Source(), {.terms = 2}, SilentProgress());
  const LightFieldModel& model = result.model;
  const auto bytes = [](const std::vector<Image>& pages) {
    int64_t texels = 0;
    for (const Image& page : pages) texels += int64_t{page.width()} * page.height();
    return 3 * texels;
  };
  int64_t pages = bytes(model.mean_pages);
  for (int k = 0; k < 2; ++k) pages += bytes(model.surface_pages[k]) + bytes(model.view_pages[k]);
  const auto vertices = static_cast<int64_t>(model.vertex_frames.size());
  const auto triangles = static_cast<int64_t>(model.placements.size());
  // Where surface maps lie and which tile a vertex has, the same for both terms: 8 bytes and an
  // index of 2 a triangle, 2 a vertex.
  EXPECT_EQ(result.maps_bytes, pages + (8 + 2) * triangles + 2 * vertices +
                                   2 * 2 * vertices * static_cast<int64_t>(sizeof(MapRange)));
  const double dense = 3.0 * 45 * static_cast<double>(model.placements.size()) * 144;
  EXPECT_NEAR(result.compression_ratio, dense / static_cast<double>(result.maps_bytes), 1e-9);
  EXPECT_EQ(result.terms_max, 2);
}

TEST(Encode, GivesTheSameBytesForAnyNumberOfThreads) {
  const SyntheticLightField field = Glossy(6);
  SetThreadCount(1);
  const EncodeResult one = Encode(field.Source(), {.terms = 2}, SilentProgress());
  SetThreadCount(4);
  const EncodeResult four = Encode(field.Source(), {.terms = 2}, SilentProgress());
  SetThreadCount(0);
  ASSERT_EQ(one.model.surface_pages.size(), four.model.surface_pages.size());
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(one.model.surface_pages[k][0].Bytes(), four.model.surface_pages[k][0].Bytes());
    EXPECT_EQ(one.model.view_pages[k][0].Bytes(), four.model.view_pages[k][0].Bytes());
  }
  EXPECT_EQ(one.model.mean_pages[0].Bytes(), four.model.mean_pages[0].Bytes());
  EXPECT_EQ(one.matrix_psnr_db, four.matrix_psnr_db);
}

TEST(Encode, WithoutTermsShowsTheMeanView) {
  const SyntheticLightField field = Glossy();
  const EncodeResult result = Encode(field.Source(), {.terms = 0}, SilentProgress());
  EXPECT_TRUE(result.model.surface_pages.empty());
  EXPECT_TRUE(result.model.view_pages.empty());
  EXPECT_EQ(result.terms_mean, 0);
  EXPECT_DOUBLE_EQ(result.matrix_psnr_db, result.matrix_psnr_mean_only_db);
  const EncodeResult with = Encode(field.Source(), {.terms = 2}, SilentProgress());
  EXPECT_EQ(result.model.mean_pages[0].Bytes(), with.model.mean_pages[0].Bytes());
  const Eigen::Vector3f color = EvaluateModel(result.model, 3, {0.2, 0.3, 0.5}, {0, 0, 1});
  EXPECT_EQ(color, EvaluateModel(with.model, 3, {0.2, 0.3, 0.5}, {0, 0, 1}, {0}));
}

TEST(Encode, FillsTrianglesThatNobodySaw) {
  SyntheticLightField field = MakeLightField(
      MakeSphere(2), 6, 60, [](int t) { return t % 2 == 0 ? 5 : 9; },
      [](const Eigen::Vector3d&, const Eigen::Vector3d&) -> Eigen::Vector3d {
        return {0.8, 0.5, 0.3};
      });
  const VertexRings rings = ComputeVertexRings(field.mesh);
  int blind = 0;
  for (int e = rings.offsets[7]; e < rings.offsets[8]; ++e, ++blind) {  // a whole ring
    field.triangles[rings.triangles[e]].photos.clear();
    field.triangles[rings.triangles[e]].values.clear();
    field.triangles[rings.triangles[e]].weights = {};
  }
  const EncodeResult result = Encode(field.Source(), {.terms = 3}, SilentProgress());
  EXPECT_EQ(result.unseen_triangles, blind);
  for (int e = rings.offsets[7]; e < rings.offsets[8]; ++e) {
    const Eigen::Vector3f color =
        EvaluateModel(result.model, rings.triangles[e], {0.3, 0.3, 0.4}, {0, 0, 1});
    EXPECT_LE((color - Eigen::Vector3f(0.8f, 0.5f, 0.3f)).cwiseAbs().maxCoeff(), 1.0 / 255);
  }
}

TEST(Encode, TrianglesThatNobodySawDoNotFlatterTheFigures) {
  SyntheticLightField field = Glossy(6);
  const double all_seen = Encode(field.Source(), {.terms = 0}, SilentProgress()).matrix_psnr_db;
  for (size_t t = 0; t < field.triangles.size(); t += 2) {
    field.triangles[t].photos.clear();
    field.triangles[t].values.clear();
    field.triangles[t].weights = {};
  }
  const EncodeResult result = Encode(field.Source(), {.terms = 0}, SilentProgress());
  ASSERT_GT(result.unseen_triangles, static_cast<int>(field.triangles.size()) / 4);
  EXPECT_NEAR(result.matrix_psnr_db, all_seen, 1.0);
}

TEST(Encode, AllBlackStaysBlack) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 6, 60, [](int) { return 4; },
      [](const Eigen::Vector3d&, const Eigen::Vector3d&) -> Eigen::Vector3d {
        return Eigen::Vector3d::Zero();
      });
  const EncodeResult result = Encode(field.Source(), {.terms = 3}, SilentProgress());
  EXPECT_EQ(result.terms_max, 0);
  EXPECT_EQ(result.model.terms, 0) << "terms that no vertex has";
  EXPECT_TRUE(result.model.surface_pages.empty() && result.model.view_pages.empty());
  EXPECT_EQ(result.matrix_psnr_db, 99);
  EXPECT_EQ(EvaluateModel(result.model, 0, {0.3, 0.3, 0.4}, {0, 0, 1}), Eigen::Vector3f::Zero());
}

TEST(Encode, RefusesALightFieldThatNobodySaw) {
  SyntheticLightField field = Glossy(4);
  for (auto& triangle : field.triangles) {
    triangle.photos.clear();
    triangle.values.clear();
    triangle.weights = {};
  }
  EXPECT_THROW(Encode(field.Source(), {}, SilentProgress()), Error);
}

TEST(Encode, RefusesInconsistentSources) {
  const auto expect_refused = [](const std::function<void(SyntheticLightField&)>& damage) {
    SyntheticLightField field = Glossy(4);
    damage(field);
    EXPECT_THROW(Encode(field.Source(), {}, SilentProgress()), Error);
  };
  expect_refused([](auto& f) { f.triangles[3].values.pop_back(); });
  expect_refused([](auto& f) { f.triangles[3].weights[1].view[5] = 60000; });
  expect_refused([](auto& f) { f.triangles[3].weights[1].weight.pop_back(); });
  expect_refused([](auto& f) { f.triangles[3].weights[1].weight[0] = NAN; });
  expect_refused([](auto& f) { f.triangles[3].weights[1].weight[0] += 1; });
  expect_refused([](auto& f) { f.triangles[3].weights[2].seen.clear(); });
  expect_refused([](auto& f) { f.triangles[3].edge_samples = 1; });
  expect_refused([](auto& f) { f.frames.pop_back(); });
  expect_refused([](auto& f) { f.grid = 1; });
  expect_refused([](auto& f) { f.mesh.triangles[2][1] = 4711; });
}

TEST(Encode, EverySolverGivesTheSameModelBarRounding) {
  const SyntheticLightField field = Glossy(4);
  const auto encode = [&](PcaSolver solver) {
    return Encode(field.Source(), {.terms = 2, .solver = solver}, SilentProgress());
  };
  const EncodeResult dense = encode(PcaSolver::kDense);
  for (const PcaSolver solver : {PcaSolver::kFactored, PcaSolver::kPaper}) {
    const EncodeResult result = encode(solver);
    EXPECT_EQ(result.model.terms, dense.model.terms);
    EXPECT_NEAR(result.matrix_psnr_db, dense.matrix_psnr_db, 0.1) << static_cast<int>(solver);
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(result.singular_value_share[k], dense.singular_value_share[k], 1e-4) << k;
    }
  }
}

TEST(Encode, DoublePrecisionGivesTheSameModelBarRounding) {
  const SyntheticLightField field = Glossy(4);
  const EncodeOptions precise = {.terms = 2, .precision = Precision::kDouble};
  const EncodeResult a = Encode(field.Source(), precise, SilentProgress());
  const EncodeResult b = Encode(field.Source(), {.terms = 2}, SilentProgress());
  EXPECT_NEAR(a.matrix_psnr_db, b.matrix_psnr_db, 0.1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(a.singular_value_share[k], b.singular_value_share[k], 1e-5) << k;
  }
}

TEST(Encode, RefusesOptionsOutOfRange) {
  const SyntheticLightField field = Glossy(4);
  EXPECT_THROW(
      Encode(field.Source(), {.solver = PcaSolver::kPaper, .precision = Precision::kDouble},
             SilentProgress()),
      Error);
  EXPECT_THROW(Encode(field.Source(), {.terms = 17}, SilentProgress()), Error);
  EXPECT_THROW(Encode(field.Source(), {.guessed_weight = 0}, SilentProgress()), Error);
  EXPECT_THROW(Encode(field.Source(), {.max_texture_size = 100}, SilentProgress()), Error);
}

TEST(Encode, SpreadsOverSeveralPages) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(2), 32, 60, [](int) { return 33; }, GlossyAppearance);
  const EncodeResult result =
      Encode(field.Source(), {.terms = 1, .max_texture_size = 256}, SilentProgress());
  EXPECT_GT(result.model.mean_pages.size(), 1u);
  EXPECT_GT(result.model.view_pages[0].size(), 1u);
  EXPECT_LT(ErrorInLevels(result.model, GlossyAppearance, 1),
            ErrorInLevels(result.model, GlossyAppearance, 0));
}

}  // namespace
}  // namespace lfm::testing
