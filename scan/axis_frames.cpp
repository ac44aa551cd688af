// SPDX-License-Identifier: BSD-3-Clause
#include "scan/axis_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

[[noreturn]] void RejectMissing(const Pattern& pattern) {
  throw Error("the pattern sequence has no \"" + PatternName(pattern) +
              "\" frame; decoding needs it: add it to the roles and the capture");
}

AxisFrames CollectAxis(const PatternSequence& sequence, PatternAxis axis) {
  AxisFrames frames;
  frames.size = axis == PatternAxis::kColumn ? sequence.projector_width : sequence.projector_height;
  frames.bits = GrayBits(sequence, axis);
  std::map<int, int> gray, inverse, stripes;
  std::map<int, std::map<int, int>> phases;
  for (size_t i = 0; i < sequence.patterns.size(); ++i) {
    const Pattern& p = sequence.patterns[i];
    const int frame = static_cast<int>(i);
    if (p.axis != axis) continue;
    if (p.kind == PatternKind::kGray) gray.emplace(p.index, frame);
    if (p.kind == PatternKind::kGrayInverse) inverse.emplace(p.index, frame);
    if (p.kind == PatternKind::kPhase) {
      phases[p.period_px > 0 ? p.period_px : sequence.phase_period_px].emplace(p.index, frame);
    }
    if (p.kind == PatternKind::kStripe) {
      stripes.emplace(p.index, frame);
      frames.stripe = p.stripe;
    }
  }
  // An inverse says as much as the pattern itself.
  std::map<int, int> present = gray;
  present.insert(inverse.begin(), inverse.end());
  for (int bit = 0; !present.empty() && bit <= present.rbegin()->first; ++bit) {
    if (!present.contains(bit)) RejectMissing({PatternKind::kGray, axis, bit});
    frames.gray.push_back(gray.contains(bit) ? gray[bit] : -1);
    frames.inverse.push_back(inverse.contains(bit) ? inverse[bit] : -1);
  }
  for (const auto& [period, steps] : phases) {
    PeriodFrames& out = frames.phases.emplace_back();
    out.period_px = period;
    for (int step = 0; step < sequence.phase_steps; ++step) {
      if (!steps.contains(step)) RejectMissing({PatternKind::kPhase, axis, step, period});
      out.steps.push_back(steps.at(step));
    }
  }
  for (const auto& [index, frame] : stripes) frames.stripes.push_back(frame);
  return frames;
}

/// Least difference, over all ways to be wrong by whole shortest periods, that the longer periods
/// see: the largest of their phase differences, as a share of a turn.
double LeastPhaseDifference(const AxisFrames& frames, int reach) {
  const int shortest = frames.phases.front().period_px;
  double least = 1;
  for (int k = 1; k * shortest < reach; ++k) {
    double seen = 0;
    for (const PeriodFrames& p : frames.phases) {
      seen = std::max(seen, std::abs(std::remainder(1.0 * k * shortest / p.period_px, 1.0)));
    }
    least = std::min(least, seen);
  }
  return least;
}

void RequireUnambiguous(const AxisFrames& frames, const char* axis) {
  if (frames.phases.empty()) return;
  constexpr double kLeastTurn = 1.0 / 256;
  // A Gray code tells apart what lies more than a cell apart.
  const int reach = frames.gray.empty() ? frames.size : std::min(frames.size, frames.CellPx());
  if (LeastPhaseDifference(frames, reach) >= kLeastTurn) return;
  throw Error(std::string("the ") + axis + " phase patterns repeat before " +
              std::to_string(reach) +
              " pixels, and no other pattern tells the repetitions apart: "
              "add Gray code of all bits, or a period at least as long as the picture");
}

}  // namespace

bool AxisFrames::HasAllInverses() const {
  const auto absent = [](int frame) { return frame < 0; };
  return std::none_of(gray.begin(), gray.end(), absent) &&
         std::none_of(inverse.begin(), inverse.end(), absent);
}

SortedFrames SortFrames(const PatternSequence& sequence) {
  SortedFrames sorted;
  for (size_t i = 0; i < sequence.patterns.size(); ++i) {
    if (sequence.patterns[i].kind == PatternKind::kWhite) sorted.white = static_cast<int>(i);
    if (sequence.patterns[i].kind == PatternKind::kBlack) sorted.black = static_cast<int>(i);
  }
  sorted.column = CollectAxis(sequence, PatternAxis::kColumn);
  sorted.row = CollectAxis(sequence, PatternAxis::kRow);
  RequireUnambiguous(sorted.column, "column");
  RequireUnambiguous(sorted.row, "row");
  bool self_contained = false;
  for (const AxisFrames* axis : {&sorted.column, &sorted.row}) {
    self_contained |= !axis->phases.empty() || !axis->stripes.empty() ||
                      (!axis->gray.empty() && axis->HasAllInverses());
  }
  // Frames of phase, stripe or inverses show each pixel both lit and unlit.
  if (!self_contained && sorted.white < 0) RejectMissing({PatternKind::kWhite});
  if (!self_contained && sorted.black < 0) RejectMissing({PatternKind::kBlack});
  return sorted;
}

}  // namespace lfm
