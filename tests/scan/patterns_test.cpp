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

TEST(Patterns, HostileNamesAreErrors) {
  for (const char* name :
       {"", "White", "white ", "gray-1", "column-", "column-gray", "column-gray-", "column-gray--1",
        "column-gray-+1", "column-gray-01", "column-gray-1-inverse-inverse",
        "column-gray-99999999999999999999", "column-gray-17", "column-phase-256",
        "column-phase-1-inverse", "row-phase-1x", "column-row-gray-1", "black\n"}) {
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
}

}  // namespace
}  // namespace lfm
