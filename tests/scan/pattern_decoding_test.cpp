// SPDX-License-Identifier: BSD-3-Clause
// Every kind of pattern, from frames of a slanted wall whose columns have a closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "scan/decode.h"
#include "tests/scan/seen_frames.h"

namespace lfm {
namespace {

using testing::ColumnErrors;
using testing::CompareColumns;
using testing::SeenFrames;
using testing::View;

enum class Scheme {
  kGray,
  kGrayWithoutInverses,
  kGrayPhase,
  kMultiPhase,
  kStripeGauss,
  kStripeBox
};
constexpr Scheme kSchemes[] = {Scheme::kGray,        Scheme::kGrayWithoutInverses,
                               Scheme::kGrayPhase,   Scheme::kMultiPhase,
                               Scheme::kStripeGauss, Scheme::kStripeBox};

const char* Name(Scheme scheme) {
  constexpr const char* kNames[] = {"Gray code",         "Gray code without inverses",
                                    "Gray code + phase", "phase of several periods",
                                    "stripe (Gauss)",    "stripe (box)"};
  return kNames[static_cast<int>(scheme)];
}

PatternSequence MakeSequence(Scheme scheme, int width = 256, int steps = 8) {
  PatternOptions options;
  options.phase_steps = steps;
  if (scheme == Scheme::kGray || scheme == Scheme::kGrayWithoutInverses) {
    options.scheme = PatternScheme::kGray;
  }
  if (scheme == Scheme::kMultiPhase) options.scheme = PatternScheme::kMultiPhase;
  if (scheme == Scheme::kStripeGauss || scheme == Scheme::kStripeBox) {
    options.scheme = PatternScheme::kStripe;
  }
  if (scheme == Scheme::kStripeBox) options.stripe.profile = StripeProfile::kBox;
  PatternSequence sequence = MakePatternSequence(width, 8, PatternRows::kWithout, options);
  if (scheme == Scheme::kGrayWithoutInverses) {
    std::erase_if(sequence.patterns,
                  [](const Pattern& p) { return p.kind == PatternKind::kGrayInverse; });
  }
  return sequence;
}

ColumnErrors Errors(const PatternSequence& sequence, const View& view) {
  return CompareColumns(Decode(sequence, SeenFrames(sequence, view), DecodeOptions{}), view);
}

void ExpectNothing(const DecodedPixels& decoded) {
  for (size_t p = 0; p < decoded.column.confidence.size(); ++p) {
    ASSERT_EQ(decoded.column.confidence[p], 0) << p;
    ASSERT_EQ(decoded.column.position[p], 0) << p;
  }
}

TEST(PatternDecoding, EveryPatternIsSubPixelAndItsSigmaIsTheError) {
  for (const Scheme scheme : kSchemes) {
    const ColumnErrors errors = Errors(MakeSequence(scheme), {});
    std::printf("%-28s %.4f px RMS, chi2 %.2f, %.1f %% decoded\n", Name(scheme), errors.rms,
                errors.normalized, 100 * errors.coverage);
    // A box of three steps' width often has no frame on its edge.
    EXPECT_LT(errors.rms, scheme == Scheme::kStripeBox ? 0.1 : 0.05) << Name(scheme);
    EXPECT_GT(errors.coverage, 0.98) << Name(scheme);
    EXPECT_EQ(errors.wrong, 0) << Name(scheme);
    EXPECT_GT(errors.normalized, 0.6) << Name(scheme);
    EXPECT_LT(errors.normalized, 1.6) << Name(scheme);
  }
}

TEST(PatternDecoding, SigmaFollowsTheNoise) {
  for (const Scheme scheme : kSchemes) {
    View view;
    view.full_well = 1500;
    view.read_noise = 15;
    const ColumnErrors errors = Errors(MakeSequence(scheme), view);
    EXPECT_GT(errors.normalized, 0.6) << Name(scheme);
    EXPECT_LT(errors.normalized, 1.6) << Name(scheme);
    EXPECT_LT(errors.wrong, 0.005) << Name(scheme);
  }
}

TEST(PatternDecoding, StripesWiderThanAPixelAreReadBetweenTheirEdges) {
  for (const double slope : {0.2, 0.35, 0.6}) {
    View view;
    view.slope = slope;
    view.shear = 0.09;
    view.blur_px = 0.1;
    for (const Scheme scheme : {Scheme::kGray, Scheme::kGrayWithoutInverses}) {
      const ColumnErrors errors = Errors(MakeSequence(scheme), view);
      EXPECT_LT(errors.rms, 0.09) << Name(scheme) << " slope " << slope;  // a whole pixel: 0.29
      EXPECT_GT(errors.coverage, 0.98);
      EXPECT_GT(errors.normalized, 0.2) << Name(scheme) << " slope " << slope;
      EXPECT_LT(errors.normalized, 2.0) << Name(scheme) << " slope " << slope;
    }
  }
}

TEST(PatternDecoding, TroubleCostsPrecisionNotCorrectness) {
  View gamma, defocus, ambient, crosstalk, dim;
  gamma.gamma = 2.2;
  defocus.blur_px = 2;
  ambient.ambient = 0.3;
  crosstalk.crosstalk = 0.03;
  dim.light = 0.06;
  const std::pair<const char*, View> troubles[] = {{"none", {}},
                                                   {"gamma 2.2", gamma},
                                                   {"blur 2 px", defocus},
                                                   {"ambient 0.3", ambient},
                                                   {"crosstalk 3 %", crosstalk},
                                                   {"a tenth of the light", dim}};
  for (const auto& [trouble, view] : troubles) {
    for (const Scheme scheme : kSchemes) {
      const ColumnErrors errors = Errors(MakeSequence(scheme), view);
      std::printf("%-22s %-28s %.4f px RMS, %.1f %% decoded, %.2f %% wrong\n", trouble,
                  Name(scheme), errors.rms, 100 * errors.coverage, 100 * errors.wrong);
      EXPECT_GT(errors.coverage, 0.9) << trouble << ", " << Name(scheme);
      EXPECT_LT(errors.wrong, 0.01) << trouble << ", " << Name(scheme);
      EXPECT_LT(errors.rms, 0.35) << trouble << ", " << Name(scheme);
    }
  }
}

TEST(PatternDecoding, ThreeStepsOfACurvedProjectorAreCorrected) {
  View view;
  view.gamma = 1.8;
  const ColumnErrors errors = Errors(MakeSequence(Scheme::kGrayPhase, 256, 3), view);
  EXPECT_LT(errors.rms, 0.12);  // 0.24 uncorrected
  EXPECT_EQ(errors.wrong, 0);
}

TEST(PatternDecoding, LightThatWandersNeverMisplacesAPixel) {
  for (const Scheme scheme : kSchemes) {
    for (const double bounced : {0.3, 1.0}) {
      View view;
      view.light = 0.3;
      view.bounced = bounced;
      const ColumnErrors errors = Errors(MakeSequence(scheme), view);
      EXPECT_LT(errors.wrong, 0.002) << Name(scheme) << " " << bounced;
      EXPECT_GT(errors.coverage, bounced < 0.5 ? 0.9 : -1.0) << Name(scheme);
    }
    // Nine tenths of the light came another way: nothing can be believed.
    View mostly;
    mostly.light = 0.08;
    mostly.bounced = 9;
    const ColumnErrors errors = Errors(MakeSequence(scheme), mostly);
    EXPECT_EQ(errors.coverage, 0) << Name(scheme);
  }
}

TEST(PatternDecoding, FringesAreReadWhereAFifthOfTheLightCameStraight) {
  View view;  // as on a surface that light grazes, with bright ones about it
  view.light = 0.12;
  view.bounced = 4;
  for (const Scheme scheme : {Scheme::kGrayPhase, Scheme::kMultiPhase}) {
    const ColumnErrors errors = Errors(MakeSequence(scheme), view);
    EXPECT_GT(errors.coverage, 0.9) << Name(scheme);
    EXPECT_EQ(errors.wrong, 0) << Name(scheme);
    EXPECT_LT(errors.rms, 0.3) << Name(scheme);
    EXPECT_LT(errors.normalized, 2) << Name(scheme);
  }
}

TEST(PatternDecoding, StepsFromThreeToSixteenAndPeriodsThatDoNotDivideTheWidth) {
  for (const int steps : {3, 4, 5, 16}) {
    for (const int width : {250, 1000}) {
      for (const Scheme scheme : {Scheme::kGrayPhase, Scheme::kMultiPhase}) {
        View view;
        view.first = width - 165;
        const ColumnErrors errors = Errors(MakeSequence(scheme, width, steps), view);
        EXPECT_EQ(errors.wrong, 0) << Name(scheme) << " " << steps << " steps of " << width;
        EXPECT_GT(errors.coverage, 0.98) << Name(scheme) << " " << steps << " steps of " << width;
        EXPECT_LT(errors.rms, 0.06) << Name(scheme) << " " << steps << " steps of " << width;
      }
    }
  }
}

TEST(PatternDecoding, ThreePeriodsWithoutCommonMeasureNeedNoLongOne) {
  PatternSequence sequence = MakePatternSequence(800, 8, PatternRows::kWithout);
  sequence.patterns.resize(2);
  for (const int period : {11, 13, 17}) {
    for (int i = 0; i < 8; ++i) {
      sequence.patterns.push_back({PatternKind::kPhase, PatternAxis::kColumn, i, period});
    }
  }
  View view;
  view.first = 500;
  const ColumnErrors errors = Errors(sequence, view);
  EXPECT_EQ(errors.wrong, 0);
  EXPECT_GT(errors.coverage, 0.98);
}

TEST(PatternDecoding, WhiteAndBlackMayBeMissingWhereOtherFramesShowThem) {
  for (const Scheme scheme :
       {Scheme::kGray, Scheme::kGrayPhase, Scheme::kMultiPhase, Scheme::kStripeGauss}) {
    PatternSequence sequence = MakeSequence(scheme);
    sequence.patterns.erase(sequence.patterns.begin(), sequence.patterns.begin() + 2);
    const ColumnErrors errors = Errors(sequence, {});
    EXPECT_GT(errors.coverage, 0.98) << Name(scheme);
    EXPECT_EQ(errors.wrong, 0) << Name(scheme);
    EXPECT_LT(errors.rms, 0.08) << Name(scheme);
  }
  PatternSequence bare = MakeSequence(Scheme::kGrayWithoutInverses);
  bare.patterns.erase(bare.patterns.begin());
  EXPECT_THROW(RequireComplete(bare), Error);
}

TEST(PatternDecoding, MissingFineBitsMakeCellsWider) {
  PatternSequence sequence = MakeSequence(Scheme::kGray);
  std::erase_if(sequence.patterns, [](const Pattern& p) { return p.index >= 6; });
  const DecodedPixels decoded = Decode(sequence, SeenFrames(sequence, {}), {});
  const ColumnErrors errors = CompareColumns(decoded, {});
  EXPECT_GT(errors.coverage, 0.95);
  EXPECT_LT(errors.rms, 0.5);  // cells of 4 pixels: 1.15 without looking between edges
}

TEST(PatternDecoding, PeriodsThatRepeatUnnoticedAreRefused) {
  PatternSequence sequence = MakeSequence(Scheme::kGrayPhase);
  std::erase_if(sequence.patterns, [](const Pattern& p) {
    return p.kind == PatternKind::kGray || p.kind == PatternKind::kGrayInverse;
  });
  try {
    RequireComplete(sequence);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("repeat"), std::string::npos);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(PatternDecoding, AScanOfNothingAndOneThatIsSaturatedDecodeToNothing) {
  for (const Scheme scheme : kSchemes) {
    const PatternSequence sequence = MakeSequence(scheme);
    View dark;
    dark.light = 0;
    ExpectNothing(Decode(sequence, SeenFrames(sequence, dark), {}));
    View bright;
    bright.light = 4;
    ExpectNothing(Decode(sequence, SeenFrames(sequence, bright), {}));
  }
}

TEST(PatternDecoding, FramesOfAnotherSizeAndTooFewAreErrors) {
  for (const Scheme scheme : kSchemes) {
    const PatternSequence sequence = MakeSequence(scheme);
    std::vector<Image> frames = SeenFrames(sequence, {});
    frames.back() = Image(3, 3, 1, PixelType::kUint8, ColorEncoding::kSrgb);
    EXPECT_THROW(Decode(sequence, frames, {}), Error) << Name(scheme);
    frames.pop_back();
    EXPECT_THROW(Decode(sequence, frames, {}), Error) << Name(scheme);
  }
}

TEST(PatternDecoding, ValuesThatAreNotFiniteStayWhereTheyAre) {
  for (const Scheme scheme : kSchemes) {
    const PatternSequence sequence = MakeSequence(scheme);
    View view;
    view.full_well = 0;
    std::vector<Image> frames = SeenFrames(sequence, view);
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                         std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()};
    for (size_t f = 0; f < frames.size(); ++f) {
      frames[f].Data<float>()[f * 7 + 5] = bad[f % 3];
      frames[f].Data<float>()[3000] = bad[f % 3];
    }
    const DecodedPixels decoded = Decode(sequence, frames, {});
    EXPECT_EQ(decoded.column.confidence[3000], 0) << Name(scheme);
    for (size_t p = 0; p < decoded.column.position.size(); ++p) {
      ASSERT_TRUE(std::isfinite(decoded.column.position[p])) << Name(scheme);
      ASSERT_TRUE(std::isfinite(decoded.column.sigma[p])) << Name(scheme);
      ASSERT_TRUE(std::isfinite(decoded.column.confidence[p])) << Name(scheme);
    }
    const ColumnErrors errors = CompareColumns(decoded, view);
    EXPECT_LT(errors.wrong, 0.001) << Name(scheme);
    EXPECT_GT(errors.coverage, 0.95) << Name(scheme);
  }
}

TEST(PatternDecoding, OneFlippedBitOfAPixelIsSeen) {
  for (const Scheme scheme : {Scheme::kGray, Scheme::kGrayPhase}) {
    const PatternSequence sequence = MakeSequence(scheme);
    for (int bit = 0; bit < 4; ++bit) {
      std::vector<Image> frames = SeenFrames(sequence, {});
      const size_t frame = static_cast<size_t>(2 + 2 * bit);
      ASSERT_EQ(sequence.patterns[frame].index, bit);
      for (size_t p = 1000; p < 5000; p += 201) {
        std::swap(frames[frame].Data<uint8_t>()[p], frames[frame + 1].Data<uint8_t>()[p]);
      }
      const DecodedPixels decoded = Decode(sequence, frames, {});
      const View view;
      for (size_t p = 0; p < decoded.column.position.size(); ++p) {
        if (decoded.column.confidence[p] <= 0) continue;
        const double truth = view.Column(static_cast<int>(p) % 96, static_cast<int>(p) / 96);
        // What is as near as a neighbour may be cannot be told from a surface.
        EXPECT_NEAR(decoded.column.position[p], truth, 4 + view.slope)
            << Name(scheme) << " bit " << bit;
      }
    }
  }
}

}  // namespace
}  // namespace lfm
