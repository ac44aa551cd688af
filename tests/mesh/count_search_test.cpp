// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/count_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace lfm {
namespace {

struct Outcome {
  int64_t best = 0;  ///< 0: the surface itself
  int attempts = 0;
};

Outcome Search(int64_t guess, int64_t all, const std::function<CountJudgement(int64_t)>& judge) {
  Outcome outcome;
  for (CountSearch search(guess, all); !search.Done(); ++outcome.attempts) {
    const int64_t count = search.Next();
    EXPECT_GE(count, CountSearch::kFewest);
    EXPECT_LT(count, all);
    if (outcome.attempts > 100) {
      ADD_FAILURE() << "no end in sight at " << count;
      return outcome;
    }
    const CountJudgement judgement = judge(count);
    if (judgement.near_enough) outcome.best = count;
    search.Learn(judgement);
  }
  return outcome;
}

// Errors of a power law meet the limit at `limit` triangles.
CountJudgement PowerLaw(int64_t count, int64_t limit, double power) {
  const double error = std::pow(static_cast<double>(limit) / static_cast<double>(count), power);
  return {error <= 1, error};
}

TEST(CountSearch, FindsTheLimitOfSmoothErrorsInFewAttempts) {
  constexpr int64_t kAll = 200000;
  for (const double power : {0.5, 0.8, 1.0, 1.5, 2.0}) {
    for (const int64_t limit : {20, 333, 5000, 70000, 190000}) {
      for (const int64_t guess : {int64_t{16}, limit / 4, limit, 4 * limit, 10 * kAll}) {
        const Outcome found =
            Search(guess, kAll, [&](int64_t count) { return PowerLaw(count, limit, power); });
        EXPECT_GE(found.best, limit);
        EXPECT_LE(static_cast<double>(found.best),
                  std::max(CountSearch::kPrecision * static_cast<double>(limit),
                           static_cast<double>(limit) + 1));
        EXPECT_LE(found.attempts, 18) << power << " " << limit << " " << guess;
      }
    }
  }
  const Outcome usual =
      Search(3000, kAll, [](int64_t count) { return PowerLaw(count, 12800, 0.75); });
  EXPECT_LE(usual.attempts, 6);
}

TEST(CountSearch, EndsForErrorsThatSayNothing) {
  // What is allowed is missed by a hair whatever is tried, met by a hair, or unknown.
  for (const double error : {1.0001, 1.01, 2.0, 1e300, 0.5}) {
    const Outcome refused = Search(16, 100000, [&](int64_t) {
      return CountJudgement{false, error};
    });
    EXPECT_EQ(refused.best, 0);
    EXPECT_LE(refused.attempts, 35) << error;
  }
  for (const double error : {0.999, 0.99, 0.5, 1e-300, 0.0}) {
    const Outcome near = Search(50000, 100000, [&](int64_t) {
      return CountJudgement{true, error};
    });
    EXPECT_EQ(near.best, CountSearch::kFewest);
    EXPECT_LE(near.attempts, 35) << error;
  }
}

TEST(CountSearch, ARefusalThatSamplesDoNotSeeIsOvercomeByDoubling) {
  const Outcome found = Search(100, 200000, [](int64_t count) {
    return CountJudgement{count >= 50000, 0.99};
  });
  EXPECT_GE(found.best, 50000);
  EXPECT_LE(found.best, 51500);
  EXPECT_LE(found.attempts, 20);
}

TEST(CountSearch, ErrorsThatLeapAreBisected) {
  const Outcome found = Search(100, 200000, [](int64_t count) {
    return CountJudgement{count >= 777, count < 777 ? 1e6 : 1e-6};
  });
  EXPECT_GE(found.best, 777);
  EXPECT_LE(found.best, 801);
}

TEST(CountSearch, SmallSurfaces) {
  for (int64_t all = 1; all < 40; ++all) {
    EXPECT_EQ(Search(1000, all, [](int64_t) { return CountJudgement{false, 3}; }).best, 0);
    const Outcome near = Search(1000, all, [](int64_t) { return CountJudgement{true, 0.1}; });
    EXPECT_EQ(near.best, all > CountSearch::kFewest ? CountSearch::kFewest : 0);
  }
}

}  // namespace
}  // namespace lfm
