// SPDX-License-Identifier: BSD-3-Clause
#include "scan/patterns.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string_view>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMaxProjectorSize = 65536;
constexpr int kMaxGrayBits = 17;
constexpr int kMaxPhaseSteps = 256;
constexpr int kMinPeriod = 2, kMaxPeriod = 64 * kMaxProjectorSize;
constexpr int kMaxPeriodRatio = 64;
constexpr int kMaxStripe = 4096;
constexpr int kMaxStripeFrames = kMaxProjectorSize + 2 * kMaxStripe + 1;
constexpr std::string_view kInverseEnding = "-inverse";

[[noreturn]] void RejectName(const std::string& name) {
  throw Error("pattern name \"" + name.substr(0, 80) +
              "\" is none of: white, black, {column,row}-gray-BIT[-inverse], "
              "{column,row}-phase-[PERIOD-]STEP, {column,row}-stripe-{box,gauss}-WIDTH-STEP-FRAME; "
              "correct the manifest's roles");
}

std::string_view AxisWord(PatternAxis axis) {
  return axis == PatternAxis::kColumn ? "column-" : "row-";
}

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

int AxisSize(const PatternSequence& sequence, PatternAxis axis) {
  return axis == PatternAxis::kColumn ? sequence.projector_width : sequence.projector_height;
}

void CheckProjectorSize(int width, int height) {
  if (width < 1 || height < 1 || width > kMaxProjectorSize || height > kMaxProjectorSize) {
    throw Error("projector size " + std::to_string(width) + " x " + std::to_string(height) +
                " is outside 1..65536; correct the manifest's scanner");
  }
}

void CheckOption(const char* what, int value, int min, int max) {
  if (value >= min && value <= max) return;
  throw Error(std::string("patterns: ") + what + " is " + std::to_string(value) +
              " but must be between " + std::to_string(min) + " and " + std::to_string(max));
}

void AppendGray(PatternSequence& sequence, PatternAxis axis) {
  const int bits = GrayBits(sequence, axis);
  for (int i = 0; i < bits; ++i) {
    sequence.patterns.push_back({PatternKind::kGray, axis, i});
    sequence.patterns.push_back({PatternKind::kGrayInverse, axis, i});
  }
}

void AppendPhase(PatternSequence& sequence, PatternAxis axis, int period_px) {
  for (int i = 0; i < sequence.phase_steps; ++i) {
    sequence.patterns.push_back({PatternKind::kPhase, axis, i, period_px});
  }
}

void AppendAxis(PatternSequence& sequence, PatternAxis axis, const PatternOptions& options) {
  const int size = AxisSize(sequence, axis);
  switch (options.scheme) {
    case PatternScheme::kGrayPhase:
      AppendGray(sequence, axis);
      AppendPhase(sequence, axis, 0);
      return;
    case PatternScheme::kGray:
      AppendGray(sequence, axis);
      return;
    case PatternScheme::kMultiPhase:
      for (int period : PhasePeriods(size, sequence.phase_period_px, options.period_ratio)) {
        AppendPhase(sequence, axis, period);
      }
      return;
    case PatternScheme::kStripe:
      for (int i = 0; i < StripeFrames(size, options.stripe); ++i) {
        sequence.patterns.push_back({PatternKind::kStripe, axis, i, 0, options.stripe});
      }
      return;
  }
}

/// Number of frames whose indices are `found`; Error unless they are 0, 1, ... and at least three.
int CountWithoutGaps(const std::set<int>& found, const std::string& what) {
  const int count = *found.rbegin() + 1;
  if (count != static_cast<int>(found.size()) || count < 3) {
    throw Error("the " + what +
                " patterns must be numbered 0, 1, ... without gaps, at least three of them");
  }
  return count;
}

/// Steps of every period along an axis; 0 without phase frames.
int CountPhaseSteps(const PatternSequence& sequence, PatternAxis axis) {
  std::map<int, std::set<int>> found;
  for (const Pattern& p : sequence.patterns) {
    if (p.kind == PatternKind::kPhase && p.axis == axis) found[p.period_px].insert(p.index);
  }
  int steps = 0;
  for (const auto& [period, indices] : found) {
    std::string what = std::string(AxisWord(axis)) + "phase";
    if (period != 0) what += "-" + std::to_string(period);
    const int count = CountWithoutGaps(indices, what);
    if (steps != 0 && steps != count) {
      throw Error("the periods of the " + std::string(AxisWord(axis)) + "phase patterns have " +
                  std::to_string(steps) + " and " + std::to_string(count) +
                  " steps; all must have the same number");
    }
    steps = count;
  }
  return steps;
}

void CheckStripes(const PatternSequence& sequence, PatternAxis axis) {
  std::set<int> found;
  const StripeShape* shape = nullptr;
  for (const Pattern& p : sequence.patterns) {
    if (p.kind != PatternKind::kStripe || p.axis != axis) continue;
    if (shape != nullptr && !(*shape == p.stripe)) {
      throw Error("the " + std::string(AxisWord(axis)) +
                  "stripe patterns have different profiles, widths or steps; one sequence moves "
                  "one stripe");
    }
    shape = &p.stripe;
    found.insert(p.index);
  }
  if (shape != nullptr) CountWithoutGaps(found, std::string(AxisWord(axis)) + "stripe");
}

/// Takes a decimal number of [min, max] and, unless it ends the text, the '-' behind it.
bool TakeNumber(std::string_view& text, int min, int max, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || value < min || value > max) return false;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  if (text.empty()) return true;
  return TakePrefix(text, "-") && !text.empty();
}

bool ParseGray(std::string_view text, Pattern& pattern) {
  pattern.kind = PatternKind::kGray;
  if (text.ends_with(kInverseEnding)) {
    pattern.kind = PatternKind::kGrayInverse;
    text.remove_suffix(kInverseEnding.size());
  }
  return TakeNumber(text, 0, kMaxGrayBits - 1, pattern.index) && text.empty();
}

bool ParsePhase(std::string_view text, Pattern& pattern) {
  pattern.kind = PatternKind::kPhase;
  if (text.find('-') != std::string_view::npos &&
      !TakeNumber(text, kMinPeriod, kMaxPeriod, pattern.period_px)) {
    return false;
  }
  return TakeNumber(text, 0, kMaxPhaseSteps - 1, pattern.index) && text.empty();
}

bool ParseStripe(std::string_view text, Pattern& pattern) {
  pattern.kind = PatternKind::kStripe;
  if (TakePrefix(text, "box-")) {
    pattern.stripe.profile = StripeProfile::kBox;
  } else if (TakePrefix(text, "gauss-")) {
    pattern.stripe.profile = StripeProfile::kGauss;
  } else {
    return false;
  }
  return TakeNumber(text, 1, kMaxStripe, pattern.stripe.width_px) &&
         TakeNumber(text, 1, kMaxStripe, pattern.stripe.step_px) &&
         TakeNumber(text, 0, kMaxStripeFrames - 1, pattern.index) && text.empty();
}

double StripeValue(const StripeShape& stripe, int index, int x) {
  const double center = static_cast<double>(index) * stripe.step_px - stripe.width_px;
  const double half = 0.5 * stripe.width_px;
  if (stripe.profile == StripeProfile::kBox) {
    const double low = std::max(x - 0.5, center - half), high = std::min(x + 0.5, center + half);
    return std::max(0.0, high - low);
  }
  const double offset = (x - center) / stripe.width_px;
  return std::exp(-4 * std::numbers::ln2 * offset * offset);
}

}  // namespace

std::string PatternName(const Pattern& pattern) {
  const std::string axis(AxisWord(pattern.axis));
  switch (pattern.kind) {
    case PatternKind::kWhite:
      return "white";
    case PatternKind::kBlack:
      return "black";
    case PatternKind::kGray:
      return axis + "gray-" + std::to_string(pattern.index);
    case PatternKind::kGrayInverse:
      return axis + "gray-" + std::to_string(pattern.index) + std::string(kInverseEnding);
    case PatternKind::kPhase:
      return axis + "phase-" +
             (pattern.period_px == 0 ? "" : std::to_string(pattern.period_px) + "-") +
             std::to_string(pattern.index);
    case PatternKind::kStripe:
      return axis + "stripe-" +
             (pattern.stripe.profile == StripeProfile::kBox ? "box-" : "gauss-") +
             std::to_string(pattern.stripe.width_px) + "-" +
             std::to_string(pattern.stripe.step_px) + "-" + std::to_string(pattern.index);
  }
  throw Error("unknown kind of pattern", ErrorKind::kSystem);
}

Pattern ParsePatternName(const std::string& name) {
  if (name == "white") return {PatternKind::kWhite, PatternAxis::kColumn, 0};
  if (name == "black") return {PatternKind::kBlack, PatternAxis::kColumn, 0};
  Pattern pattern;
  std::string_view rest = name;
  if (TakePrefix(rest, "column-")) {
    pattern.axis = PatternAxis::kColumn;
  } else if (TakePrefix(rest, "row-")) {
    pattern.axis = PatternAxis::kRow;
  } else {
    RejectName(name);
  }
  bool known = false;
  if (TakePrefix(rest, "gray-")) {
    known = ParseGray(rest, pattern);
  } else if (TakePrefix(rest, "phase-")) {
    known = ParsePhase(rest, pattern);
  } else if (TakePrefix(rest, "stripe-")) {
    known = ParseStripe(rest, pattern);
  }
  // Writing the name again catches leading zeros.
  if (!known || PatternName(pattern) != name) RejectName(name);
  return pattern;
}

int GrayBits(const PatternSequence& sequence, PatternAxis axis) {
  const int size = AxisSize(sequence, axis);
  return size < 1 ? 0 : static_cast<int>(std::bit_width(static_cast<unsigned>(size - 1)));
}

std::vector<int> PhasePeriods(int size, int finest_px, int ratio) {
  CheckOption("the projector's side", size, 1, kMaxProjectorSize);
  CheckOption("the shortest period", finest_px, kMinPeriod, kMaxProjectorSize);
  CheckOption("the ratio of periods", ratio, 2, kMaxPeriodRatio);
  std::vector<int> periods = {finest_px};
  while (periods.back() < size) periods.push_back(periods.back() * ratio);
  return periods;
}

int StripeFrames(int size, const StripeShape& stripe) {
  CheckOption("the projector's side", size, 1, kMaxProjectorSize);
  CheckOption("the stripe's width", stripe.width_px, 1, kMaxStripe);
  CheckOption("the stripe's step", stripe.step_px, 1, kMaxStripe);
  const int way = size - 1 + 2 * stripe.width_px;
  return (way + stripe.step_px - 1) / stripe.step_px + 1;
}

PatternSequence MakePatternSequence(int projector_width, int projector_height, PatternRows rows,
                                    const PatternOptions& options) {
  CheckProjectorSize(projector_width, projector_height);
  CheckOption("the number of phase steps", options.phase_steps, 3, kMaxPhaseSteps);
  PatternSequence sequence;
  sequence.projector_width = projector_width;
  sequence.projector_height = projector_height;
  sequence.phase_steps = options.phase_steps;
  sequence.patterns.push_back({PatternKind::kWhite, PatternAxis::kColumn, 0});
  sequence.patterns.push_back({PatternKind::kBlack, PatternAxis::kColumn, 0});
  AppendAxis(sequence, PatternAxis::kColumn, options);
  if (rows == PatternRows::kWith) AppendAxis(sequence, PatternAxis::kRow, options);
  return sequence;
}

PatternSequence SequenceFromNames(int projector_width, int projector_height,
                                  const std::vector<std::string>& names) {
  CheckProjectorSize(projector_width, projector_height);
  PatternSequence sequence;
  sequence.projector_width = projector_width;
  sequence.projector_height = projector_height;
  std::set<std::string> seen;
  for (const std::string& name : names) {
    const Pattern pattern = ParsePatternName(name);
    if (!seen.insert(name).second) {
      throw Error("pattern \"" + name + "\" is listed twice; each role may occur once");
    }
    const bool gray =
        pattern.kind == PatternKind::kGray || pattern.kind == PatternKind::kGrayInverse;
    const int size = AxisSize(sequence, pattern.axis);
    if ((gray && pattern.index >= GrayBits(sequence, pattern.axis)) ||
        (pattern.kind == PatternKind::kStripe &&
         pattern.index >= StripeFrames(size, pattern.stripe))) {
      throw Error("pattern \"" + name + "\" is a frame that a projector of " +
                  std::to_string(projector_width) + " x " + std::to_string(projector_height) +
                  " pixels does not have");
    }
    sequence.patterns.push_back(pattern);
  }
  const int columns = CountPhaseSteps(sequence, PatternAxis::kColumn);
  const int rows = CountPhaseSteps(sequence, PatternAxis::kRow);
  if (columns != 0 && rows != 0 && columns != rows) {
    throw Error("columns have " + std::to_string(columns) + " phase steps and rows " +
                std::to_string(rows) + "; both must have the same number");
  }
  sequence.phase_steps = std::max(columns, rows);
  CheckStripes(sequence, PatternAxis::kColumn);
  CheckStripes(sequence, PatternAxis::kRow);
  return sequence;
}

double PatternValue(const PatternSequence& sequence, const Pattern& pattern, double column,
                    double row) {
  const double x = std::floor(column + 0.5), y = std::floor(row + 0.5);
  const bool inside =
      x >= 0 && y >= 0 && x < sequence.projector_width && y < sequence.projector_height;
  if (!inside) return 0;
  const int number = static_cast<int>(pattern.axis == PatternAxis::kColumn ? x : y);
  switch (pattern.kind) {
    case PatternKind::kWhite:
      return 1;
    case PatternKind::kBlack:
      return 0;
    case PatternKind::kGray:
    case PatternKind::kGrayInverse: {
      const int shift = GrayBits(sequence, pattern.axis) - 1 - pattern.index;
      if (shift < 0) return 0;
      const int bit = ((number ^ (number >> 1)) >> shift) & 1;
      return pattern.kind == PatternKind::kGray ? bit : 1 - bit;
    }
    case PatternKind::kPhase: {
      const int period = pattern.period_px > 0 ? pattern.period_px : sequence.phase_period_px;
      const double turns = static_cast<double>(number) / period -
                           static_cast<double>(pattern.index) / sequence.phase_steps;
      return 0.5 + 0.5 * std::cos(2 * std::numbers::pi * turns);
    }
    case PatternKind::kStripe:
      return StripeValue(pattern.stripe, pattern.index, number);
  }
  return 0;
}

}  // namespace lfm
