// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_coarsening.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/model_error.h"
#include "encode/model_evaluation.h"
#include "encode/model_layout.h"
#include "encode/patch_resolution.h"
#include "encode/separate_layout.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/model_oracle.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

TEST(PatchResolution, CoarserSizesShareSamples) {
  EXPECT_EQ(CoarserEdgeSamples(49), 25);
  EXPECT_EQ(CoarserEdgeSamples(7), 4);
  EXPECT_EQ(CoarserEdgeSamples(4), 2);
  EXPECT_EQ(CoarserEdgeSamples(3), 2);
  EXPECT_EQ(CoarserEdgeSamples(2), 0);
  EXPECT_EQ(CoarserEdgeSamples(6), 0) << "five segments";
  std::vector<float> linear;
  std::vector<uint8_t> codes;
  for (int j = 0; j < 13; ++j) {
    for (int i = 0; i + j < 13; ++i) {
      linear.push_back(static_cast<float>(3 * i - 2 * j + 1));
      codes.push_back(static_cast<uint8_t>(10 * i + j));
    }
  }
  for (const int to : {7, 4, 2}) {
    const std::vector<float> kept = SubsamplePatch(std::span<const float>(linear), 13, to);
    ASSERT_EQ(kept.size(), PatchSampleCount(to));
    const std::vector<float> back = InterpolatePatch(kept, to, 13);
    for (size_t s = 0; s < linear.size(); ++s) EXPECT_NEAR(back[s], linear[s], 1e-4) << to;
    const int step = 12 / (to - 1);
    EXPECT_EQ(SubsamplePatch(std::span<const uint8_t>(codes), 13, to)[PatchSampleIndex(to, 1, 0)],
              10 * step);
  }
}

// Paint varies on one half; the other is plain, and glossy all over.
Eigen::Vector3d HalfPainted(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye) {
  const Eigen::Vector3d paint =
      p.x() < 0 ? Eigen::Vector3d(0.4, 0.4, 0.4)
                : Eigen::Vector3d(0.4 + 0.2 * std::sin(1.3 * p.y()), 0.4, 0.4 + 0.003 * p.z());
  const double highlight = std::pow(std::max(0.0, p.normalized().dot(to_eye)), 8);
  return paint + 0.3 * highlight * Eigen::Vector3d(1, 0.9, 0.8);
}

class MapCoarsening : public ::testing::Test {
 protected:
  EncodeResult With(const EncodeOptions& options) const {
    return Encode(source_, options, SilentProgress());
  }
  SyntheticLightField field_ = MakeLightField(
      MakeSphere(2), 12, 120, [](int t) { return t % 3 == 0 ? 7 : 13; }, HalfPainted);
  LightFieldSource source_ = field_.Source();
};

TEST_F(MapCoarsening, PlainPlacesKeepFewerSamples) {
  const EncodeResult result = With({.transport_db = 0});
  const LightFieldModel& model = result.model;
  int64_t plain = 0, plain_kept = 0, painted = 0, painted_kept = 0;
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    double x = 0;
    for (const int v : model.mesh.triangles[t]) x += model.mesh.vertices[v].x() / 3;
    if (std::abs(x) < 15) continue;
    (x < 0 ? plain : painted) += PatchSampleCount(field_.triangles[t].edge_samples);
    (x < 0 ? plain_kept : painted_kept) += PatchSampleCount(model.placements[t].edge_samples);
  }
  EXPECT_LT(10 * plain_kept, plain);
  EXPECT_GT(2 * painted_kept, painted);
}

TEST_F(MapCoarsening, FewerBytesAtThePsnrAskedFor) {
  for (const double target_db : {40.0, 43.0}) {
    const EncodeResult full = With({.target_db = target_db,
                                    .patch_detail = MapDetail::kFull,
                                    .view_detail = MapDetail::kFull,
                                    .transport_db = 0});
    const EncodeResult coarse = With({.target_db = target_db, .transport_db = 0});
    EXPECT_GE(coarse.matrix_psnr_db, target_db);
    EXPECT_LE(coarse.matrix_psnr_db, target_db + 0.5);
    EXPECT_LT(1.2 * static_cast<double>(coarse.maps_bytes), static_cast<double>(full.maps_bytes));
    EXPECT_NEAR(CompareWithLightField(source_, coarse.model).psnr_db(), coarse.matrix_psnr_db,
                1e-6);
    EXPECT_EQ(coarse.model.MapsBytes(), coarse.maps_bytes);
    ASSERT_EQ(static_cast<int>(coarse.matrix_psnr_by_terms_db.size()), coarse.model.terms + 1);
    for (size_t k = 1; k < coarse.matrix_psnr_by_terms_db.size(); ++k) {
      EXPECT_GT(coarse.matrix_psnr_by_terms_db[k], coarse.matrix_psnr_by_terms_db[k - 1] - 0.01);
    }
  }
  for (const double megabytes : {0.06, 0.1, 0.2}) {
    const EncodeResult budget = With({.target_mb = megabytes, .transport_db = 0});
    EXPECT_LE(static_cast<double>(budget.maps_bytes), 1e6 * megabytes);
    EXPECT_GT(static_cast<double>(budget.maps_bytes), 0.93e6 * megabytes);
  }
}

// The terms of a whole model, as the factorisation gave them.
std::vector<VertexTerms> TermsOf(const LightFieldModel& model) {
  const VertexRings rings = ComputeVertexRings(model.mesh);
  std::vector<VertexTerms> vertices(model.vertex_terms.size());
  for (size_t v = 0; v < vertices.size(); ++v) {
    const auto ring = rings.Ring(v);
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      vertices[v].terms.push_back(ReadVertexTerm(model, ring, static_cast<int>(v), k));
    }
    vertices[v].squared_errors.assign(vertices[v].terms.size() + 1, 0.0);
    vertices[v].entries = 1;
  }
  return vertices;
}

// What the choice goes by, against what comes out: edges lose a little more, view maps that are
// fitted anew win some back.
TEST_F(MapCoarsening, EstimatesWhatItLoses) {
  const EncodeResult whole = With({.terms = 2, .transport_db = 0});
  const int triangles = static_cast<int>(whole.model.placements.size());
  std::vector<int> edge_samples;
  std::vector<std::vector<uint8_t>> mean_codes;
  for (int t = 0; t < triangles; ++t) {
    edge_samples.push_back(field_.triangles[t].edge_samples);
    mean_codes.push_back(ReadMean(whole.model, t));
  }
  const MapCosts costs =
      MeasureMapCosts(source_, edge_samples, mean_codes, TermsOf(whole.model), {});
  const double before = CompareWithLightField(source_, whole.model).squared_error;
  // The mean view alone coarser, each term alone, and all.
  for (const std::vector<uint8_t>& levels :
       {std::vector<uint8_t>{1, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 1}, {2, 2, 2}}) {
    MapSelection maps{whole.model.vertex_terms,
                      std::vector<std::vector<uint8_t>>(triangles, levels),
                      std::vector<std::vector<uint8_t>>(whole.model.vertex_terms.size(), {0, 0})};
    const LightFieldModel coarse = CoarsenMaps(source_, whole.model, maps, 0.2, 4096);
    const double lost = CompareWithLightField(source_, coarse).squared_error - before;
    const double estimate = costs.SquaredError(maps);
    std::printf("levels %d %d %d: lost %.1f, estimated %.1f, error before %.1f\n", levels[0],
                levels[1], levels[2], lost, estimate, before);
    EXPECT_GT(lost, 0.5 * estimate);
    EXPECT_LT(lost, 2 * estimate + 0.02 * before) << "ranges widen where completions need it";
    EXPECT_LT(coarse.MapsBytes(), whole.model.MapsBytes());
    const double bytes = static_cast<double>(coarse.MapsBytes());
    EXPECT_NEAR(static_cast<double>(costs.Bytes(maps)), bytes, 0.1 * bytes);
  }
  const MapSelection same{
      whole.model.vertex_terms, std::vector<std::vector<uint8_t>>(triangles, {0, 0, 0}),
      std::vector<std::vector<uint8_t>>(whole.model.vertex_terms.size(), {0, 0})};
  const LightFieldModel unchanged = CoarsenMaps(source_, whole.model, same, 0.2, 4096);
  EXPECT_NEAR(CompareWithLightField(source_, unchanged).squared_error, before, 0.01 * before);
}

// The same for view maps, of each term alone and all.
TEST_F(MapCoarsening, EstimatesWhatCoarserViewsLose) {
  const EncodeResult whole = With({.terms = 2, .transport_db = 0});
  const size_t triangles = whole.model.placements.size(), vertices = field_.mesh.vertices.size();
  std::vector<int> edge_samples;
  std::vector<std::vector<uint8_t>> mean_codes;
  for (size_t t = 0; t < triangles; ++t) {
    edge_samples.push_back(field_.triangles[t].edge_samples);
    mean_codes.push_back(ReadMean(whole.model, static_cast<int>(t)));
  }
  const MapCosts costs = MeasureMapCosts(source_, edge_samples, mean_codes, TermsOf(whole.model),
                                         {.patches = MapDetail::kFull});
  EXPECT_EQ(costs.view_bytes, (std::vector<int64_t>{432, 108})) << "12 and 6; 3 is too few";
  EXPECT_EQ(costs.patches.front().levels(), 1);
  const double before = CompareWithLightField(source_, whole.model).squared_error;
  for (const std::vector<uint8_t>& grids : {std::vector<uint8_t>{1, 0}, {0, 1}, {1, 1}}) {
    const MapSelection maps{whole.model.vertex_terms,
                            std::vector<std::vector<uint8_t>>(triangles, {0, 0, 0}),
                            std::vector<std::vector<uint8_t>>(vertices, grids)};
    const LightFieldModel coarse = CoarsenMaps(source_, whole.model, maps, 0.2, 4096);
    const double lost = CompareWithLightField(source_, coarse).squared_error - before;
    const double estimate = costs.SquaredError(maps);
    EXPECT_NEAR(lost, estimate, 0.1 * estimate + 0.02 * before);
    EXPECT_GT(estimate, 0.02 * before);
    const double bytes = static_cast<double>(coarse.MapsBytes());
    EXPECT_NEAR(static_cast<double>(costs.Bytes(maps)), bytes, 0.1 * bytes);
    for (int k = 0; k < 2; ++k) EXPECT_EQ(coarse.ViewTile(k, 5).grid, grids[k] == 1 ? 6 : 12);
    EXPECT_FALSE(HasWholeMaps(coarse));
    EXPECT_THROW(JoinSurfaceMaps(coarse), Error);
  }
}

// Every map has texels that no other has, whatever grids they have.
TEST_F(MapCoarsening, ViewMapsShareNoTexels) {
  const EncodeResult whole = With({.terms = 2, .transport_db = 0});
  MapSelection maps{whole.model.vertex_terms,
                    std::vector<std::vector<uint8_t>>(whole.model.placements.size(), {0, 0, 0}),
                    {}};
  for (size_t v = 0; v < field_.mesh.vertices.size(); ++v) {
    maps.view_levels.push_back({static_cast<uint8_t>(v % 3 == 0), static_cast<uint8_t>(v % 2)});
  }
  const LightFieldModel model = LayOutCoarsened(whole.model, maps, 256);
  ValidateModel(model, "model");
  for (int k = 0; k < model.terms; ++k) {
    std::vector<Image> taken = model.view_pages[k];
    int64_t texels = 0, held = 0;
    for (const Image& page : taken) held += int64_t{page.width()} * page.height();
    for (int v = 0; v < static_cast<int>(maps.view_levels.size()); ++v) {
      const LightFieldModel::TilePosition tile = model.ViewTile(k, v);
      EXPECT_EQ(tile.grid, model.grid >> maps.view_levels[v][k]);
      texels += int64_t{tile.grid} * tile.grid;
      for (int y = 0; y < tile.grid; ++y) {
        for (int x = 0; x < tile.grid; ++x) {
          EXPECT_EQ(++taken[tile.page].At<uint8_t>(tile.x + x, tile.y + y), 1);
        }
      }
    }
    EXPECT_LT(held, 1.1 * static_cast<double>(texels));
  }
}

TEST_F(MapCoarsening, IsContinuousAndMeansWhatTheFormatSays) {
  const EncodeResult result = With({.target_db = 43, .transport_db = 0});
  const LightFieldModel& model = result.model;
  ASSERT_GT(model.terms, 0);
  int finer_than_neighbour = 0;
  for (const PatchPlacement& p : model.placements) finer_than_neighbour += p.edge_samples > 2;
  ASSERT_GT(finer_than_neighbour, 0);
  EXPECT_LE(LargestJumpAcrossEdges(model), 1.0);
  for (int t = 0; t < static_cast<int>(model.placements.size()); t += 3) {
    const Eigen::Vector3d to_eye =
        (TriangleNormal(model.mesh, t) + Eigen::Vector3d(0.2, -0.3, 0.1)).normalized();
    for (const Eigen::Vector3d& w :
         std::vector<Eigen::Vector3d>{{0.2, 0.5, 0.3}, {0.02, 0.49, 0.49}, {0, 1, 0}}) {
      const Eigen::Vector3d expected =
          SlowEvaluate(model, t, w, to_eye, model.terms).cwiseMax(0).cwiseMin(1);
      EXPECT_LE((EvaluateModel(model, t, w, to_eye).cast<double>() - expected).norm(), 1e-4) << t;
    }
  }
}

TEST_F(MapCoarsening, ComesBackFromAFile) {
  const EncodeResult result = With({.transport_db = 0, .max_texture_size = 256});
  ASSERT_GT(result.model.terms, 0);
  const std::string file = ::testing::TempDir() + "lfm_coarsened.glb";
  WriteGlb(result.model, file);
  const LightFieldModel back = ReadGlb(file);
  std::remove(file.c_str());
  EXPECT_EQ(back.guessed, result.model.guessed);
  ASSERT_FALSE(result.model.view_tile_counts.empty());
  EXPECT_EQ(back.view_tile_counts, result.model.view_tile_counts);
  EXPECT_EQ(back.view_codes, result.model.view_codes);
  EXPECT_EQ(back.MapsBytes(), result.model.MapsBytes());
  for (int t = 0; t < static_cast<int>(back.placements.size()); t += 5) {
    const Eigen::Vector3d to_eye = TriangleNormal(back.mesh, t), w(0.5, 0.2, 0.3);
    EXPECT_LE(
        (EvaluateModel(back, t, w, to_eye) - EvaluateModel(result.model, t, w, to_eye)).norm(),
        1e-5);
  }
}

TEST_F(MapCoarsening, KeepsEverySampleWhereNothingIsChosen) {
  EXPECT_FALSE(ChoosesDetail({.terms = 3}));
  EXPECT_FALSE(ChoosesDetail({.factorization = Factorization::kNmf}));
  EXPECT_FALSE(ChoosesDetail({.tolerance = 1}));
  EXPECT_FALSE(ChoosesDetail({.compression = {.vq_ratio = 2}}));
  EXPECT_FALSE(ChoosesDetail({.patch_detail = MapDetail::kFull, .view_detail = MapDetail::kFull}));
  EXPECT_TRUE(ChoosesDetail({}));
  EXPECT_TRUE(HasWholeMaps(With({.terms = 2, .transport_db = 0}).model));
  // The transport form holds whole maps either way.
  const EncodeResult coarse = With({.target_db = 42});
  const DecodedModel decoded = DecodeTransport(coarse.transport.bytes, "model.lfz");
  int64_t samples = 0, all = 0;
  for (const PatchPlacement& p : decoded.model.placements)
    samples += PatchSampleCount(p.edge_samples);
  for (const auto& triangle : field_.triangles) all += PatchSampleCount(triangle.edge_samples);
  EXPECT_EQ(samples, all);
  EXPECT_THROW(EncodeTransport(coarse.model, {}), Error);
}

// Black, white, matte, and patches that have nothing coarser.
TEST(MapCoarseningExtremes, Hold) {
  for (const double level : {0.0, 1.0, 0.5}) {
    const SyntheticLightField plain = MakeLightField(
        MakeSphere(1), 8, 60, [](int) { return 13; },
        [level](const Eigen::Vector3d&, const Eigen::Vector3d&) {
          return Eigen::Vector3d::Constant(level);
        });
    const EncodeResult result = Encode(plain.Source(), {.transport_db = 0}, SilentProgress());
    EXPECT_EQ(result.model.terms, 0);
    EXPECT_GT(result.matrix_psnr_db, 54);
    for (const PatchPlacement& p : result.model.placements) EXPECT_EQ(p.edge_samples, 2);
  }
  const SyntheticLightField smallest = MakeLightField(
      MakeSphere(1), 8, 60, [](int) { return 2; }, GlossyAppearance);
  const EncodeResult result = Encode(smallest.Source(), {.transport_db = 0}, SilentProgress());
  EXPECT_GT(result.model.terms, 0);
  TriangleMesh one;
  one.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  one.triangles = {{0, 1, 2}};
  const SyntheticLightField single = MakeLightField(
      one, 8, 60, [](int) { return 7; }, GlossyAppearance);
  EXPECT_GT(Encode(single.Source(), {.target_db = 40, .transport_db = 0}, SilentProgress())
                .matrix_psnr_db,
            40);
}

}  // namespace
}  // namespace lfm::testing
