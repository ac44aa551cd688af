// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/count_search.h"

#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

constexpr double kLongestStep = 8;

}  // namespace

CountSearch::CountSearch(int64_t guess, int64_t all)
    : next_(std::clamp(guess, kFewest, std::max(all / 2, kFewest))),
      done_(all <= kFewest),
      fine_{all, 0} {}

// In the middle where errors do not say where the limit lies. Never so near to either side that
// nothing would be learnt.
int64_t CountSearch::Between(bool middle) const {
  const double gap =
      std::log(static_cast<double>(fine_.count) / static_cast<double>(coarse_.count));
  const double least = 0.5 * std::log(kPrecision);
  double from_coarse = 0.5 * gap;
  if (!middle && coarse_.error > 1 && fine_.error > 0) {
    from_coarse = gap * std::log(coarse_.error) / std::log(coarse_.error / fine_.error);
  }
  from_coarse = std::clamp(from_coarse, least, std::max(gap - least, least));
  return std::llround(static_cast<double>(coarse_.count) * std::exp(from_coarse));
}

// How many times the triangles where only one side of the limit is known: errors are a power of the
// count, the power that the last two tell. Aimed a little beyond the limit, that the other side may
// be known next; twice or half where that keeps failing, or where samples see nothing wrong with a
// mesh that is refused.
double CountSearch::StepBeyond(const CountJudgement& last) const {
  const double aim = std::sqrt(kPrecision);
  const double least = in_a_row_ > 3 || (!last.near_enough && last.error <= 1) ? 2 : kPrecision;
  double power = 1;
  if (in_a_row_ > 1 && before_.error > 0 && last.error > 0) {
    power =
        std::clamp(std::log(before_.error / last.error) /
                       std::log(static_cast<double>(next_) / static_cast<double>(before_.count)),
                   0.5, 2.0);
  }
  if (last.near_enough) {
    return std::clamp(std::pow(last.error, 1 / power) / aim, 1 / kLongestStep, 1 / least);
  }
  return std::clamp(std::pow(last.error, 1 / power) * aim, least, kLongestStep);
}

void CountSearch::Learn(const CountJudgement& judgement) {
  in_a_row_ = judgement.near_enough == last_near_ ? in_a_row_ + 1 : 1;
  last_near_ = judgement.near_enough;
  Tried& side = judgement.near_enough ? fine_ : coarse_;
  before_ = side;
  side = {next_, judgement.error};
  found_ = found_ || judgement.near_enough;
  const int64_t least = std::max(coarse_.count + 1, kFewest);
  const bool settled =
      static_cast<double>(fine_.count) <= kPrecision * static_cast<double>(coarse_.count);
  if (found_ && coarse_.count > 0) {
    next_ = Between(in_a_row_ > 1);
  } else {
    next_ = std::llround(static_cast<double>(next_) * StepBeyond(judgement));
    next_ = std::max(next_, least);
    // Nothing is learnt of what is known to be near enough.
    if (next_ >= fine_.count) next_ = found_ ? fine_.count - 1 : Between(true);
  }
  done_ = settled || next_ < least || next_ >= fine_.count;
}

}  // namespace lfm
