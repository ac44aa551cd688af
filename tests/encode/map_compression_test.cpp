// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_compression.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/encode.h"
#include "encode/model_error.h"
#include "encode/model_evaluation.h"
#include "encode/patch_resolution.h"
#include "encode/separate_layout.h"
#include "encode/view_refit.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/model_oracle.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr int kTerms = 2;

class MapCompression : public ::testing::Test {
 protected:
  MapCompression()
      : field_(MakeLightField(
            MakeSphere(2), 8, 40, [](int t) { return t % 3 == 0 ? 5 : 9; }, GlossyAppearance)),
        source_(field_.Source()),
        plain_(Encode(source_, {.terms = kTerms, .transport_db = 0}, SilentProgress()).model) {}
  LightFieldModel Compressed(const MapCompressionOptions& options) const {
    return CompressMaps(source_, plain_, options, {}, SilentProgress());
  }
  double MatrixPsnr(const LightFieldModel& model) const {
    return CompareWithLightField(source_, model).psnr_db();
  }
  SyntheticLightField field_;
  LightFieldSource source_;
  LightFieldModel plain_;
};

void ExpectEqualModels(const LightFieldModel& a, const LightFieldModel& b) {
  ASSERT_EQ(a.mean_pages.size(), b.mean_pages.size());
  for (size_t i = 0; i < a.mean_pages.size(); ++i) {
    EXPECT_EQ(a.mean_pages[i].Bytes(), b.mean_pages[i].Bytes());
  }
  for (int k = 0; k < a.terms; ++k) {
    EXPECT_EQ(a.surface_pages[k].front().Bytes(), b.surface_pages[k].front().Bytes());
    EXPECT_EQ(a.view_pages[k].front().Bytes(), b.view_pages[k].front().Bytes());
  }
  EXPECT_EQ(a.view_codes, b.view_codes);
  for (size_t i = 0; i < a.view_ranges.size(); ++i) {
    EXPECT_EQ(a.view_ranges[i].scale, b.view_ranges[i].scale);
    EXPECT_EQ(a.view_ranges[i].bias, b.view_ranges[i].bias);
    EXPECT_EQ(a.surface_ranges[i].scale, b.surface_ranges[i].scale);
  }
}

std::vector<MapCompressionOptions> AllKinds() {
  return {{.vq_ratio = 4},
          {.vq_db = 40},
          {.blocks = PageBlocks::kBc1},
          {.blocks = PageBlocks::kBc4},
          {.vq_ratio = 3, .blocks = PageBlocks::kBc1},
          {.vq_ratio = 3, .vq_start = CodebookStart::kPairwise, .blocks = PageBlocks::kBc4}};
}

// Every kind of model means what docs/formats.md says.
TEST_F(MapCompression, ModelsAreValidAndMeanWhatTheirTablesSay) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  for (const MapCompressionOptions& options : AllKinds()) {
    const LightFieldModel model = Compressed(options);
    EXPECT_NO_THROW(ValidateModel(model, "model"));
    EXPECT_LT(model.MapsBytes(), plain_.MapsBytes());
    EXPECT_EQ(HasWholeMaps(model), !options.WantsCodebooks());
    EXPECT_EQ(model.blocks.empty(), options.blocks == PageBlocks::kNone);
    for (int i = 0; i < 300; ++i) {
      const int t = static_cast<int>(random() % model.placements.size());
      Eigen::Vector3d weights(uniform(random), uniform(random), uniform(random));
      weights /= weights.sum();
      const Eigen::Vector3d to_eye =
          Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      const Eigen::Vector3d expected = SlowEvaluate(model, t, weights, to_eye, kTerms);
      const Eigen::Vector3f shown = EvaluateModel(model, t, weights, to_eye);
      EXPECT_LE((expected - shown.cast<double>()).norm(), 1e-5);
    }
  }
}

TEST_F(MapCompression, PagesAreWhatTheirBlocksSay) {
  const LightFieldModel model = Compressed({.blocks = PageBlocks::kBc4});
  EXPECT_EQ(model.SurfacePlanes(), 3);
  for (size_t i = 0; i < model.mean_pages.size(); ++i) {
    EXPECT_EQ(DecodePage(model.blocks.mean[i]).Bytes(), model.mean_pages[i].Bytes());
  }
  for (int k = 0; k < kTerms; ++k) {
    EXPECT_EQ(DecodePage(model.blocks.surface[k][0]).Bytes(), model.surface_pages[k][0].Bytes());
    EXPECT_EQ(DecodePage(model.blocks.view[k][0]).Bytes(), model.view_pages[k][0].Bytes());
  }
  // BC1: a sixth of the page, BC4: half.
  EXPECT_EQ(model.blocks.mean[0].blocks.size() * 6, model.mean_pages[0].Bytes().size());
  EXPECT_EQ(model.blocks.surface[0][0].blocks.size() * 2, model.surface_pages[0][0].Bytes().size());
}

// No block holds texels of two rectangles of the mean view.
TEST_F(MapCompression, RectanglesOfMeanViewsAreWholeBlocks) {
  for (const double ratio : {1.0, 3.0}) {
    const LightFieldModel model = Compressed({.vq_ratio = ratio, .blocks = PageBlocks::kBc1});
    std::map<std::array<int, 3>, std::set<std::array<int, 3>>> users;  // block -> rectangles
    for (const PatchPlacement& p : model.placements) {
      const int n = p.edge_samples, sign = p.flipped ? -1 : 1;
      // Two patches that share a rectangle have the same middle.
      const std::array<int, 3> rectangle = {p.page, p.flipped ? p.origin.x() - n - 1 : p.origin.x(),
                                            p.flipped ? p.origin.y() - n : p.origin.y()};
      EXPECT_EQ(rectangle[1] % 4, 0);
      EXPECT_EQ(rectangle[2] % 4, 0);
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i + j < n; ++i) {
          users[{p.page, (p.origin.x() + sign * i) / 4, (p.origin.y() + sign * j) / 4}].insert(
              rectangle);
        }
      }
    }
    for (const auto& [block, rectangles] : users) EXPECT_EQ(rectangles.size(), 1u);
  }
}

// The more is asked for, the more is lost; nothing is lost without need.
TEST_F(MapCompression, RatesAndDistortionsGoTogether) {
  const double plain = MatrixPsnr(plain_);
  EXPECT_GT(MatrixPsnr(Compressed({.vq_ratio = 1.001})), plain - 1.5);
  double before = plain + 1;
  int64_t bytes_before = plain_.MapsBytes();
  for (const double ratio : {1.5, 3.0, 8.0, 30.0}) {
    const LightFieldModel model = Compressed({.vq_ratio = ratio});
    const double psnr = MatrixPsnr(model);
    EXPECT_LT(psnr, before);
    EXPECT_LT(model.MapsBytes(), bytes_before);
    before = psnr;
    bytes_before = model.MapsBytes();
  }
  EXPECT_GT(MatrixPsnr(Compressed({.blocks = PageBlocks::kBc4})),
            MatrixPsnr(Compressed({.blocks = PageBlocks::kBc1})));
}

TEST_F(MapCompression, DistortionThatIsAskedForIsKept) {
  int64_t bytes_before = 0;
  for (const double db : {30.0, 36.0, 42.0}) {
    const LightFieldModel model = Compressed({.vq_db = db});
    // What the codebooks change, over all samples and grid directions.
    double sum = 0;
    int count = 0;
    for (int t = 0; t < static_cast<int>(model.placements.size()); t += 5) {
      for (int i = 0; i < 20; ++i) {
        const Eigen::Vector3d weights(0.5 - 0.02 * i, 0.3, 0.2 + 0.02 * i);
        const Eigen::Vector3d to_eye =
            (TriangleNormal(model.mesh, t) + 0.8 * Eigen::Vector3d(std::cos(i), std::sin(i), 0.3))
                .normalized();
        sum +=
            (EvaluateModel(model, t, weights, to_eye) - EvaluateModel(plain_, t, weights, to_eye))
                .squaredNorm();
        count += 3;
      }
    }
    EXPECT_GT(-10 * std::log10(sum / count), db - 4) << db;
    EXPECT_GT(model.MapsBytes(), bytes_before);
    bytes_before = model.MapsBytes();
  }
}

// The closed loop: view maps fitted to what surface maps have become lose less.
TEST_F(MapCompression, ViewMapsMakeUpForWhatSurfaceMapsLost) {
  const LightFieldModel model = Compressed({.vq_ratio = 6});
  LightFieldModel open = model;  // the same surface maps with the first view maps
  open.view_codes.assign(kTerms, plain_.view_slots);
  open.view_pages = plain_.view_pages;
  open.view_ranges = plain_.view_ranges;
  open.view_tiles_per_page = plain_.view_tiles_per_page;
  open.view_tiles_per_row = plain_.view_tiles_per_row;
  const std::vector<FittedViews> fitted = RefitViews(source_, open, 0.2);
  const double before = MatrixPsnr(open);
  // No step away from the fit lowers its error (the fit keeps 0.1 % of the first maps).
  const auto with_views = [&](double share) {
    LightFieldModel moved = open;
    std::vector<FittedViews> views = fitted;
    for (size_t v = 0; v < views.size(); ++v) {
      for (int k = 0; k < moved.vertex_terms[v]; ++k) {
        const auto tile = moved.ViewTile(k, static_cast<int>(v));
        const MapRange& range = plain_.view_ranges[k * views.size() + v];
        float low = HUGE_VALF, high = -HUGE_VALF;
        for (int q = 0; q < 64; ++q) {
          for (int c = 0; c < 3; ++c) {
            float& value = views[v].views[k][3 * q + c];
            const int code =
                plain_.view_pages[k][tile.page].At<uint8_t>(tile.x + q % 8, tile.y + q / 8, c);
            const float first = range.scale * static_cast<float>(code) / 255 + range.bias;
            value = static_cast<float>(share) * value + static_cast<float>(1 - share) * first;
            low = std::min(low, value);
            high = std::max(high, value);
          }
        }
        moved.view_ranges[k * views.size() + v] = {high - low, low};
        for (int q = 0; q < 64; ++q) {
          for (int c = 0; c < 3; ++c) {
            const float share_of =
                (views[v].views[k][3 * q + c] - low) / std::max(high - low, 1e-9f);
            moved.view_pages[k][tile.page].At<uint8_t>(tile.x + q % 8, tile.y + q / 8, c) =
                static_cast<uint8_t>(std::lround(255 * share_of));
          }
        }
      }
    }
    return MatrixPsnr(moved);
  };
  EXPECT_GT(with_views(1), before + 0.1);
  EXPECT_GT(with_views(1), with_views(0.7));
  EXPECT_GT(with_views(1), with_views(1.3));
}

// What is shared or in blocks is not continuous any more: by how much is measured, and bounded.
TEST_F(MapCompression, JumpsAcrossEdgesStayBounded) {
  const EdgeJumps plain = JumpsAcrossEdges(plain_);
  EXPECT_LE(plain.largest, 2.0);
  EXPECT_LE(plain.rms, 0.3);
  struct Case {
    MapCompressionOptions options;
    double largest, rms;  // levels of 255
    double share;         // of the RMS of jumps where each side is coded by itself
    double loss_db;       // against that
  };
  const Case cases[] = {{{.blocks = PageBlocks::kBc4}, 18, 3.0, 0.65, 0.6},
                        {{.blocks = PageBlocks::kBc1}, 24, 3.4, 0.65, 0.9},
                        {{.vq_ratio = 4}, 10, 0.8, 0.5, 0.3},
                        {{.vq_ratio = 4, .blocks = PageBlocks::kBc1}, 34, 5.7, 0.7, 1.0}};
  for (const Case& one : cases) {
    MapCompressionOptions apart = one.options;
    apart.edge_weight = 0;
    const LightFieldModel alone = Compressed(apart), model = Compressed(one.options);
    const EdgeJumps before = JumpsAcrossEdges(alone), jumps = JumpsAcrossEdges(model);
    const double loss_db = MatrixPsnr(alone) - MatrixPsnr(model);
    std::printf("largest %.1f, rms %.2f levels; before %.1f, %.2f; %.2f dB\n", jumps.largest,
                jumps.rms, before.largest, before.rms, loss_db);
    EXPECT_GE(jumps.rms, plain.rms);
    EXPECT_LE(jumps.largest, one.largest);
    EXPECT_LE(jumps.rms, one.rms);
    EXPECT_LE(jumps.rms, one.share * before.rms);
    EXPECT_LE(loss_db, one.loss_db);
    EXPECT_EQ(alone.MapsBytes(), model.MapsBytes());
  }
}

// Half a patch's resolution, and back: linear functions stay, on the hypotenuse too.
TEST(PatchResolution, LinearFunctionsComeBack) {
  for (const int n : {5, 9, 25}) {
    std::vector<float> values(PatchSampleCount(n));
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        values[PatchSampleIndex(n, i, j)] =
            3.f + 2.f * static_cast<float>(i) - static_cast<float>(j);
      }
    }
    const std::vector<float> half = SubsamplePatch(std::span<const float>(values), n, (n + 1) / 2);
    ASSERT_EQ(static_cast<int>(half.size()), PatchSampleCount((n + 1) / 2));
    const std::vector<float> back = InterpolatePatch(half, (n + 1) / 2, n);
    for (size_t s = 0; s < values.size(); ++s) EXPECT_NEAR(back[s], values[s], 1e-4);
    EXPECT_EQ(InterpolatePatch(values, n, n), values);
  }
}

// A smooth surface does not need all its samples when bytes are short; with all the bytes it keeps
// them.
TEST_F(MapCompression, SmoothPatchesAreStoredAtALowerResolution) {
  const auto smaller = [&](const LightFieldModel& model) {
    int count = 0;
    for (size_t t = 0; t < model.placements.size(); ++t) {
      count += model.placements[t].edge_samples < plain_.placements[t].edge_samples;
      for (int k = 0; k < model.TriangleTerms(static_cast<int>(t)); ++k) {
        count += model.surface_placements[k][t].edge_samples < plain_.placements[t].edge_samples;
      }
    }
    return count;
  };
  EXPECT_EQ(smaller(Compressed({.vq_ratio = 1.001})), 0);
  EXPECT_GT(smaller(Compressed({.vq_ratio = 8})), 100);
}

TEST_F(MapCompression, DoesNotDependOnThreads) {
  const MapCompressionOptions options{.vq_ratio = 5, .blocks = PageBlocks::kBc1};
  SetThreadCount(1);
  const LightFieldModel one = Compressed(options);
  SetThreadCount(0);
  ExpectEqualModels(one, Compressed(options));
}

TEST_F(MapCompression, Extremes) {
  // No terms: the mean view alone is shared and coded.
  const LightFieldModel mean =
      Encode(source_, {.terms = 0, .transport_db = 0}, SilentProgress()).model;
  const MapCompressionOptions both{.vq_ratio = 4, .blocks = PageBlocks::kBc1};
  const LightFieldModel shared = CompressMaps(source_, mean, both, {}, SilentProgress());
  EXPECT_LT(shared.MapsBytes(), mean.MapsBytes() / 12);
  // More than there is to gain: one code a group.
  const LightFieldModel least = Compressed({.vq_ratio = 1000});
  std::set<std::array<int, 3>> places;
  for (const PatchPlacement& p : least.placements) {
    places.insert({p.page, p.origin.x(), p.origin.y()});
  }
  EXPECT_EQ(places.size(), 2u);  // two patch sizes
  // Nonnegative terms hold the mean view and stay nonnegative.
  const LightFieldModel nmf =
      Encode(source_, {.factorization = Factorization::kNmf, .terms = 2, .transport_db = 0},
             SilentProgress())
          .model;
  const LightFieldModel nmf_shared = CompressMaps(source_, nmf, both, {}, SilentProgress());
  EXPECT_TRUE(nmf_shared.mean_in_terms);
  EXPECT_GT(MatrixPsnr(nmf_shared), 15);
  // A black light field has no terms and one mean view.
  const SyntheticLightField black = MakeLightField(
      MakeSphere(1), 8, 20, [](int) { return 5; },
      [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0, 0); });
  const EncodeResult dark = Encode(
      black.Source(), {.terms = 2, .transport_db = 0, .compression = both}, SilentProgress());
  EXPECT_EQ(dark.matrix_psnr_db, 99);
}

TEST_F(MapCompression, RefusesWhatItCannotDo) {
  EXPECT_THROW(Compressed({.vq_ratio = 2, .vq_db = 40}), Error);
  const SyntheticLightField odd = MakeLightField(
      MakeSphere(1), 6, 20, [](int) { return 5; }, GlossyAppearance);
  const EncodeOptions options{
      .terms = 1, .transport_db = 0, .compression = {.blocks = PageBlocks::kBc1}};
  EXPECT_THROW(Encode(odd.Source(), options, SilentProgress()), Error);
}

TEST_F(MapCompression, EncodeReportsWhatItMade) {
  const EncodeResult result =
      Encode(source_, {.terms = kTerms, .transport_db = 0, .compression = {.vq_ratio = 4}},
             SilentProgress());
  EXPECT_EQ(result.maps_bytes, result.model.MapsBytes());
  EXPECT_DOUBLE_EQ(result.matrix_psnr_db, MatrixPsnr(result.model));
  ExpectEqualModels(result.model, Compressed({.vq_ratio = 4}));
}

}  // namespace
}  // namespace lfm::testing
