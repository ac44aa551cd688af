// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/pattern_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lfm {
namespace {

TEST(PatternTable, AddsUpEveryFrameAsThePatternsDefineIt) {
  const PatternSequence sequence = MakePatternSequence(64, 48, PatternRows::kWith);
  const PatternTable table(sequence);
  ASSERT_EQ(table.frames(), static_cast<int>(sequence.patterns.size()));
  std::vector<float> sums(table.frames(), 0.0f);
  table.Accumulate({{37, 0}, {11, 0}, 0.25f}, sums.data());
  table.Accumulate({{5, 0.25f}, {40, 0}, 0.5f}, sums.data());
  for (int slot = 0; slot < table.frames(); ++slot) {
    const Pattern& pattern = sequence.patterns[table.frame_of_slot()[slot]];
    EXPECT_NEAR(sums[slot],
                0.25 * PatternValue(sequence, pattern, 37, 11) +
                    0.375 * PatternValue(sequence, pattern, 5, 40) +
                    0.125 * PatternValue(sequence, pattern, 6, 40),
                1e-6)
        << PatternName(pattern);
  }
}

TEST(ProjectedSpan, CoversItsStretchInsideThePicture) {
  const ProjectedSpan inside = MakeSpan(5.1, 0.4, 10);
  EXPECT_EQ(inside.index, 5);
  EXPECT_EQ(inside.share, 0);
  const ProjectedSpan across = MakeSpan(5.4, 0.4, 10);  // [5.2, 5.6]: a quarter beyond 5.5
  EXPECT_EQ(across.index, 5);
  EXPECT_NEAR(across.share, 0.25, 1e-6);
  EXPECT_EQ(MakeSpan(-0.5, 1, 10).index, 0);
  const ProjectedSpan last = MakeSpan(9.49, 1, 10);
  EXPECT_EQ(last.index, 9 - (last.share > 0));
  EXPECT_EQ(MakeSpan(3, 0, 10).index, 3);
}

// What frame f shows at a column, by the table.
std::vector<double> ShownAt(const PatternSequence& sequence, const ScanTrouble& trouble,
                            double column, double row) {
  const PatternTable table(sequence, trouble);
  std::vector<float> sums(table.frames(), 0.0f);
  table.Accumulate({table.ColumnSpan(column, 1e-3), table.RowSpan(row, 1e-3), 1}, sums.data());
  std::vector<double> shown(table.frames());
  for (int slot = 0; slot < table.frames(); ++slot) {
    shown[table.frame_of_slot()[slot]] = sums[slot];
  }
  return shown;
}

TEST(PatternTable, GammaIsAPower) {
  const PatternSequence sequence = MakePatternSequence(64, 48, PatternRows::kWith);
  ScanTrouble trouble;
  trouble.projector_gamma = 2.2;
  const std::vector<double> shown = ShownAt(sequence, trouble, 21, 9);
  for (size_t f = 0; f < shown.size(); ++f) {
    EXPECT_NEAR(shown[f], std::pow(PatternValue(sequence, sequence.patterns[f], 21, 9), 2.2), 1e-6);
  }
}

TEST(PatternTable, CrosstalkMixesTheThreeFramesOfAColourPicture) {
  const PatternSequence sequence = MakePatternSequence(64, 48, PatternRows::kWith);
  ScanTrouble trouble;
  trouble.crosstalk_percent = 10;
  const std::vector<double> shown = ShownAt(sequence, trouble, 21, 9);
  std::vector<double> own;
  for (const Pattern& p : sequence.patterns) own.push_back(PatternValue(sequence, p, 21, 9));
  EXPECT_EQ(shown[0], 1);  // white and black are the same in all colours
  EXPECT_EQ(shown[1], 0);
  // 12 Gray frames and 8 phase frames along the columns: six pictures and one of two frames.
  for (size_t f = 2; f < 22; ++f) {
    const size_t first = 2 + (f - 2) / 3 * 3, count = std::min<size_t>(3, 22 - first);
    double expected = own[f];
    for (size_t other = first; other < first + count; ++other) {
      expected += 0.1 * (own[other] - own[f]);
    }
    EXPECT_NEAR(shown[f], expected, 1e-6) << f;
  }
  // Rows are pictures of their own.
  EXPECT_NEAR(shown[22], 0.8 * own[22] + 0.1 * (own[23] + own[24]), 1e-6);
}

// A cosine under a Gaussian keeps its phase and loses exp(-2 pi^2 sigma^2 / period^2); the pixel's
// own square costs sinc(1 / period).
TEST(PatternTable, DefocusDampsTheFringesByClosedForm) {
  PatternSequence sequence = MakePatternSequence(256, 48, PatternRows::kWithout);
  ScanTrouble trouble;
  trouble.projector_defocus_px = 2.5;
  constexpr double kPi = std::numbers::pi;
  const double damping =
      std::exp(-2 * kPi * kPi * 2.5 * 2.5 / 256) * std::sin(kPi / 16) / (kPi / 16);
  // Centres of the table's places, four a pixel.
  for (double column : {100.125, 103.375, 107.625, 120.875}) {
    const std::vector<double> shown = ShownAt(sequence, trouble, column, 9);
    for (size_t f = 0; f < shown.size(); ++f) {
      const Pattern& p = sequence.patterns[f];
      if (p.kind != PatternKind::kPhase) continue;
      EXPECT_NEAR(shown[f], 0.5 + 0.5 * damping * std::cos(2 * kPi * (column / 16 - p.index / 8.0)),
                  2e-4);
    }
  }
  // White is full inside, half at the picture's edge, and its light is kept.
  EXPECT_NEAR(ShownAt(sequence, trouble, 128, 9)[0], 1, 1e-6);
  EXPECT_NEAR(ShownAt(sequence, trouble, -0.49, 9)[0], 0.5, 0.03);
}

TEST(PatternTable, DefocusKeepsTheLightOfAStripe) {
  PatternOptions options;
  options.scheme = PatternScheme::kStripe;
  options.stripe = {StripeProfile::kBox, 6, 5};
  const PatternSequence sequence = MakePatternSequence(128, 16, PatternRows::kWithout, options);
  ScanTrouble trouble;
  trouble.projector_defocus_px = 1.7;
  const PatternTable table(sequence, trouble);
  const size_t frame = 2 + 14;  // centre at 64
  double light = 0, moment = 0, spread = 0;
  for (double x = 40; x < 88; x += 0.25) {
    std::vector<float> sums(table.frames(), 0.0f);
    table.Accumulate({table.ColumnSpan(x + 0.125, 0.25), table.RowSpan(0, 0.1), 1}, sums.data());
    light += sums[frame] / 4;
    moment += sums[frame] / 4 * (x + 0.125);
    spread += sums[frame] / 4 * std::pow(x + 0.125 - 64, 2);
  }
  EXPECT_NEAR(light, 6, 1e-3);
  EXPECT_NEAR(moment / light, 64, 1e-3);
  // A box of width 6 (seven pixels, the outer ones half lit) and the blur.
  const double box = (2 * (9 * 0.5 + 4 + 1)) / 6.0 + 1 / 12.0;
  EXPECT_NEAR(spread / light, box + 1.7 * 1.7, 0.02);
}

}  // namespace
}  // namespace lfm
