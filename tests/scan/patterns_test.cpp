// SPDX-License-Identifier: BSD-3-Clause
#include "scan/patterns.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

/// The Gray code word that the patterns show at a column, most significant bit first.
unsigned ShownWord(const PatternSequence& sequence, PatternAxis axis, int x) {
  unsigned word = 0;
  for (int bit = 0; bit < GrayBits(sequence, axis); ++bit) {
    const Pattern pattern{PatternKind::kGray, axis, bit};
    const double value = axis == PatternAxis::kColumn ? PatternValue(sequence, pattern, x, 3)
                                                      : PatternValue(sequence, pattern, 3, x);
    word = word * 2 + (value > 0.5 ? 1 : 0);
  }
  return word;
}

TEST(Patterns, NeighbouringColumnsDifferInOneBitAndDecodeToTheirNumber) {
  const PatternSequence sequence = MakePatternSequence(1000, 768, PatternRows::kWith);
  for (PatternAxis axis : {PatternAxis::kColumn, PatternAxis::kRow}) {
    const int size = axis == PatternAxis::kColumn ? 1000 : 768;
    for (int x = 0; x < size; ++x) {
      const unsigned word = ShownWord(sequence, axis, x);
      unsigned binary = word;
      for (int shift = 1; shift < 16; shift *= 2) binary ^= binary >> shift;
      EXPECT_EQ(binary, static_cast<unsigned>(x));
      if (x > 0) {
        EXPECT_EQ(std::popcount(word ^ ShownWord(sequence, axis, x - 1)), 1);
      }
    }
  }
}

TEST(Patterns, InverseAndGrayAddUpToWhite) {
  const PatternSequence sequence = MakePatternSequence(64, 32, PatternRows::kWithout);
  for (int bit = 0; bit < 6; ++bit) {
    for (int x = 0; x < 64; ++x) {
      EXPECT_EQ(
          PatternValue(sequence, {PatternKind::kGray, PatternAxis::kColumn, bit}, x, 0) +
              PatternValue(sequence, {PatternKind::kGrayInverse, PatternAxis::kColumn, bit}, x, 0),
          1);
    }
  }
}

TEST(Patterns, BitsAreAsManyAsTheLargestNumberNeeds) {
  EXPECT_EQ(GrayBits(MakePatternSequence(1024, 768, PatternRows::kWith), PatternAxis::kColumn), 10);
  EXPECT_EQ(GrayBits(MakePatternSequence(1024, 768, PatternRows::kWith), PatternAxis::kRow), 10);
  EXPECT_EQ(GrayBits(MakePatternSequence(1025, 2, PatternRows::kWith), PatternAxis::kColumn), 11);
  EXPECT_EQ(GrayBits(MakePatternSequence(1025, 2, PatternRows::kWith), PatternAxis::kRow), 1);
  EXPECT_EQ(GrayBits(MakePatternSequence(1, 1, PatternRows::kWith), PatternAxis::kColumn), 0);
}

TEST(Patterns, PhaseFollowsTheDocumentedCosineOnProjectorPixels) {
  const PatternSequence sequence = MakePatternSequence(128, 16, PatternRows::kWithout);
  for (int step = 0; step < sequence.phase_steps; ++step) {
    const Pattern pattern{PatternKind::kPhase, PatternAxis::kColumn, step};
    for (int x = 0; x < 128; ++x) {
      const double expected =
          0.5 + 0.5 * std::cos(2 * std::numbers::pi *
                               (x / 16.0 - static_cast<double>(step) / sequence.phase_steps));
      for (double inside : {-0.49, 0.0, 0.49}) {
        EXPECT_NEAR(PatternValue(sequence, pattern, x + inside, 2), expected, 1e-12);
      }
    }
  }
}

PatternOptions OptionsFor(PatternScheme scheme) {
  PatternOptions options;
  options.scheme = scheme;
  return options;
}

TEST(Patterns, PhasesOfStatedPeriodFollowTheSameCosine) {
  const PatternSequence sequence =
      MakePatternSequence(300, 100, PatternRows::kWith, OptionsFor(PatternScheme::kMultiPhase));
  int checked = 0;
  for (const Pattern& pattern : sequence.patterns) {
    if (pattern.kind != PatternKind::kPhase) continue;
    const bool column = pattern.axis == PatternAxis::kColumn;
    for (int x = 0; x < (column ? 300 : 100); x += 7) {
      const double expected =
          0.5 + 0.5 * std::cos(2 * std::numbers::pi *
                               (static_cast<double>(x) / pattern.period_px - pattern.index / 8.0));
      EXPECT_NEAR(PatternValue(sequence, pattern, column ? x : 31, column ? 31 : x), expected,
                  1e-12);
      ++checked;
    }
  }
  // Periods 16, 64, 256, 1024 along 300 columns; 16, 64, 256 along 100 rows.
  EXPECT_EQ(checked, 4 * 8 * 43 + 3 * 8 * 15);
}

// What a multi-frequency sequence is for: the steps of one period give a phase, each longer period
// says which of the shorter one's turns it is, and the longest is unambiguous over the picture.
TEST(Patterns, SeveralPeriodsTellEveryColumnApart) {
  const int width = 300;
  const PatternSequence sequence = MakePatternSequence(width, 100, PatternRows::kWithout,
                                                       OptionsFor(PatternScheme::kMultiPhase));
  const std::vector<int> periods = PhasePeriods(width, sequence.phase_period_px, 4);
  EXPECT_EQ(periods, (std::vector<int>{16, 64, 256, 1024}));
  for (int x = 0; x < width; ++x) {
    double position = 0;
    for (auto period = periods.rbegin(); period != periods.rend(); ++period) {
      double c = 0, s = 0;
      for (const Pattern& p : sequence.patterns) {
        if (p.kind != PatternKind::kPhase || p.period_px != *period) continue;
        const double angle = 2 * std::numbers::pi * p.index / sequence.phase_steps;
        c += PatternValue(sequence, p, x, 50) * std::cos(angle);
        s += PatternValue(sequence, p, x, 50) * std::sin(angle);
      }
      double fraction = std::atan2(s, c) / (2 * std::numbers::pi);
      if (fraction < -1e-9) fraction += 1;
      const double turns = period == periods.rbegin() ? 0 : position / *period - fraction;
      position = (std::round(turns) + fraction) * *period;
    }
    EXPECT_NEAR(position, x, 1e-6);
  }
}

TEST(Patterns, StripesHaveTheirProfileAndMoveByTheirStep) {
  for (StripeProfile profile : {StripeProfile::kBox, StripeProfile::kGauss}) {
    PatternOptions options = OptionsFor(PatternScheme::kStripe);
    options.stripe = {profile, 7, 3};
    const PatternSequence sequence = MakePatternSequence(50, 20, PatternRows::kWithout, options);
    for (int frame : {0, 1, 9, 20}) {
      const Pattern pattern{PatternKind::kStripe, PatternAxis::kColumn, frame, 0, options.stripe};
      const double center = 3.0 * frame - 7;
      for (int x = 0; x < 50; ++x) {
        const double d = std::abs(x - center);
        // Half of 7 px covers the pixels within 3 of the centre's whole.
        const double expected =
            profile == StripeProfile::kBox ? (d <= 3 ? 1.0 : 0.0) : std::pow(2.0, -4 * d * d / 49);
        EXPECT_NEAR(PatternValue(sequence, pattern, x, 11), expected, 1e-12) << frame << " " << x;
      }
    }
  }
  // An even width covers half of a pixel at either side.
  const StripeShape even{StripeProfile::kBox, 4, 2};
  const PatternSequence picture = MakePatternSequence(32, 8, PatternRows::kWithout);
  const Pattern pattern{PatternKind::kStripe, PatternAxis::kColumn, 7, 0, even};  // centre 10
  for (const auto& [x, value] : {std::pair{7, 0.0}, {8, 0.5}, {9, 1.0}, {11, 1.0}, {12, 0.5}}) {
    EXPECT_NEAR(PatternValue(picture, pattern, x, 0), value, 1e-12) << x;
  }
}

// Temporal analysis (Curless and Levoy 1995): the stripe passes a column at the frame in which its
// centre does; over the whole sweep every column must see it come and go.
TEST(Patterns, TheMeanOverTimeOfAStripeIsTheColumn) {
  for (StripeProfile profile : {StripeProfile::kBox, StripeProfile::kGauss}) {
    PatternOptions options = OptionsFor(PatternScheme::kStripe);
    options.stripe = {profile, 12, 4};
    // A box is as bright anywhere inside: its mean is no finer than half a step.
    const double mean_abs = profile == StripeProfile::kGauss ? 0.05 : 2;
    const PatternSequence sequence = MakePatternSequence(61, 30, PatternRows::kWith, options);
    for (PatternAxis axis : {PatternAxis::kColumn, PatternAxis::kRow}) {
      const int size = axis == PatternAxis::kColumn ? 61 : 30;
      for (int x = 0; x < size; ++x) {
        double sum = 0, moment = 0;
        for (const Pattern& p : sequence.patterns) {
          if (p.kind != PatternKind::kStripe || p.axis != axis) continue;
          const double value = axis == PatternAxis::kColumn ? PatternValue(sequence, p, x, 3)
                                                            : PatternValue(sequence, p, 3, x);
          sum += value;
          moment += value * (4.0 * p.index - 12);
        }
        EXPECT_NEAR(moment / sum, x, mean_abs) << x;
        EXPECT_GT(sum, 2);
      }
    }
  }
}

TEST(Patterns, NothingLeavesOutsideThePicture) {
  const PatternSequence sequence = MakePatternSequence(32, 16, PatternRows::kWithout);
  const Pattern white;
  EXPECT_EQ(PatternValue(sequence, white, -0.5, 0), 1);
  EXPECT_EQ(PatternValue(sequence, white, -0.51, 0), 0);
  EXPECT_EQ(PatternValue(sequence, white, 31.49, 15.49), 1);
  EXPECT_EQ(PatternValue(sequence, white, 31.5, 0), 0);
  EXPECT_EQ(PatternValue(sequence, white, 0, 15.5), 0);
  EXPECT_EQ(PatternValue(sequence, white, std::nan(""), 0), 0);
}

TEST(Patterns, NamesRoundTripThroughASequence) {
  const PatternSequence made = MakePatternSequence(1024, 768, PatternRows::kWith);
  EXPECT_EQ(made.patterns.size(), 58U);
  EXPECT_EQ(MakePatternSequence(1024, 768, PatternRows::kWithout).patterns.size(), 30U);
  std::vector<std::string> names;
  for (const Pattern& p : made.patterns) names.push_back(PatternName(p));
  const PatternSequence read = SequenceFromNames(1024, 768, names);
  ASSERT_EQ(read.patterns.size(), made.patterns.size());
  EXPECT_EQ(read.phase_steps, 8);
  for (size_t i = 0; i < names.size(); ++i) EXPECT_EQ(PatternName(read.patterns[i]), names[i]);
  EXPECT_EQ(names[0], "white");
  EXPECT_EQ(names[3], "column-gray-0-inverse");
}

TEST(Patterns, EverySchemesNamesRoundTrip) {
  for (PatternScheme scheme : {PatternScheme::kGrayPhase, PatternScheme::kGray,
                               PatternScheme::kMultiPhase, PatternScheme::kStripe}) {
    PatternOptions options = OptionsFor(scheme);
    options.phase_steps = 5;
    const PatternSequence made = MakePatternSequence(300, 70, PatternRows::kWith, options);
    std::vector<std::string> names;
    for (const Pattern& p : made.patterns) names.push_back(PatternName(p));
    const PatternSequence read = SequenceFromNames(300, 70, names);
    ASSERT_EQ(read.patterns.size(), made.patterns.size());
    const bool phases = scheme == PatternScheme::kGrayPhase || scheme == PatternScheme::kMultiPhase;
    EXPECT_EQ(read.phase_steps, phases ? 5 : 0);
    for (size_t i = 0; i < names.size(); ++i) {
      for (int x = 0; x < 300; x += 23) {
        EXPECT_EQ(PatternValue(read, read.patterns[i], x, x / 5),
                  PatternValue(made, made.patterns[i], x, x / 5))
            << names[i];
      }
    }
  }
  EXPECT_EQ(PatternName({PatternKind::kPhase, PatternAxis::kRow, 3, 64}), "row-phase-64-3");
  EXPECT_EQ(ParsePatternName("column-phase-16-3").period_px, 16);
  EXPECT_EQ(ParsePatternName("column-phase-3").period_px, 0);
  EXPECT_EQ(ParsePatternName("row-stripe-box-9-2-17").stripe,
            (StripeShape{StripeProfile::kBox, 9, 2}));
}

TEST(Patterns, OptionsOutOfRangeAreErrors) {
  const auto make = [](const PatternOptions& options) {
    MakePatternSequence(64, 48, PatternRows::kWithout, options);
  };
  PatternOptions options = OptionsFor(PatternScheme::kMultiPhase);
  options.period_ratio = 1;
  EXPECT_THROW(make(options), Error);
  options.period_ratio = 2;
  options.phase_steps = 2;
  EXPECT_THROW(make(options), Error);
  options = OptionsFor(PatternScheme::kStripe);
  options.stripe.step_px = 0;
  EXPECT_THROW(make(options), Error);
  options.stripe = {StripeProfile::kBox, 0, 1};
  EXPECT_THROW(make(options), Error);
  EXPECT_THROW(PhasePeriods(0, 16, 4), Error);
}

TEST(Patterns, HostileNamesAreErrors) {
  for (const char* name : {"",
                           "White",
                           "white ",
                           "gray-1",
                           "column-",
                           "column-gray",
                           "column-gray-",
                           "column-gray--1",
                           "column-gray-+1",
                           "column-gray-01",
                           "column-gray-1-inverse-inverse",
                           "column-gray-99999999999999999999",
                           "column-gray-17",
                           "column-phase-256",
                           "column-phase-1-inverse",
                           "row-phase-1x",
                           "column-row-gray-1",
                           "black\n",
                           "column-phase-",
                           "column-phase-16-",
                           "column-phase--3",
                           "column-phase-1-0",
                           "column-phase-016-3",
                           "column-phase-16-256",
                           "column-phase-16-3-1",
                           "column-phase-99999999999-1",
                           "column-stripe-",
                           "column-stripe-12-4-3",
                           "column-stripe-round-12-4-3",
                           "column-stripe-gauss-12-4",
                           "column-stripe-gauss-0-4-3",
                           "column-stripe-gauss-12-0-3",
                           "column-stripe-gauss-12-4--3",
                           "column-stripe-gauss-12-4-03",
                           "column-stripe-box-5000-4-3",
                           "column-stripe-box-12-4-3-",
                           "stripe-box-12-4-3"}) {
    EXPECT_THROW(ParsePatternName(name), Error) << name;
  }
  EXPECT_THROW(ParsePatternName(std::string("white\0", 6)), Error);
}

TEST(Patterns, ImpossibleSequencesAreErrors) {
  const std::vector<std::string> phases = {"column-phase-0", "column-phase-1", "column-phase-2"};
  EXPECT_EQ(SequenceFromNames(64, 64, phases).phase_steps, 3);
  EXPECT_THROW(SequenceFromNames(64, 64, {"white", "white"}), Error);
  EXPECT_THROW(SequenceFromNames(64, 64, {"column-gray-6"}), Error);
  EXPECT_THROW(SequenceFromNames(64, 64, {"column-phase-0", "column-phase-2"}), Error);
  EXPECT_THROW(SequenceFromNames(64, 64, {"column-phase-0", "column-phase-1"}), Error);
  EXPECT_THROW(SequenceFromNames(0, 64, {"white"}), Error);
  EXPECT_THROW(SequenceFromNames(64, 65537, {"white"}), Error);
  std::vector<std::string> uneven = phases;
  for (int i = 0; i < 4; ++i) uneven.push_back("row-phase-" + std::to_string(i));
  EXPECT_THROW(SequenceFromNames(64, 64, uneven), Error);
  std::vector<std::string> periods = phases;
  for (int i = 0; i < 4; ++i) periods.push_back("column-phase-64-" + std::to_string(i));
  EXPECT_THROW(SequenceFromNames(64, 64, periods), Error);
  periods.pop_back();
  EXPECT_EQ(SequenceFromNames(64, 64, periods).phase_steps, 3);
  std::vector<std::string> stripes;
  for (int i = 0; i < 4; ++i) stripes.push_back("row-stripe-box-8-4-" + std::to_string(i));
  EXPECT_EQ(SequenceFromNames(64, 64, stripes).patterns.size(), 4U);
  stripes.back() = "row-stripe-box-8-4-20";  // leaves a gap; and 64 rows have 21 frames
  EXPECT_THROW(SequenceFromNames(64, 64, stripes), Error);
  stripes.back() = "row-stripe-box-8-4-21";
  EXPECT_THROW(SequenceFromNames(64, 64, stripes), Error);
  stripes.back() = "row-stripe-gauss-8-4-3";
  EXPECT_THROW(SequenceFromNames(64, 64, stripes), Error);
}

}  // namespace
}  // namespace lfm
