// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace lfm {

/// What is thought of a mesh of so many triangles.
struct CountJudgement {
  bool near_enough = false;
  /// In units of what is allowed, as far as samples tell; expected to fall about as a power of the
  /// count. At most 1 in a mesh that is refused: for other reasons.
  double error = 0;
};

/// Looks for the smallest number of triangles that is near enough, by false position: the
/// logarithms of error and count are taken for a line between what is near enough and what is not.
/// Two attempts in a row on one side are followed by bisection. To within 3 %; ends for any
/// judgements, after about twice the logarithm of `all` to the base 2 at most; sooner where errors
/// are smooth and the guess is fair.
class CountSearch {
 public:
  static constexpr int64_t kFewest = 16;
  static constexpr double kPrecision = 1.03;

  /// The surface itself, of `all` triangles, is near enough and never tried.
  CountSearch(int64_t guess, int64_t all);
  bool Done() const { return done_; }
  /// How many to try now; at least kFewest, less than all.
  int64_t Next() const { return next_; }
  /// About what was tried last. The coarsest that was near enough is the answer.
  void Learn(const CountJudgement& judgement);

 private:
  struct Tried {
    int64_t count = 0;
    double error = 0;
  };
  int64_t Between(bool middle) const;
  double StepBeyond(const CountJudgement& last) const;

  int64_t next_;
  bool done_, found_ = false, last_near_ = false;
  Tried fine_, coarse_;  // near enough; not near enough (count 0: none known)
  Tried before_;         // on the side of the last
  int in_a_row_ = 0;     // attempts on the same side of the limit
};

}  // namespace lfm
