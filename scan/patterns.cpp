// SPDX-License-Identifier: BSD-3-Clause
#include "scan/patterns.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMaxProjectorSize = 65536;
constexpr int kMaxGrayBits = 17;
constexpr int kMaxPhaseSteps = 256;
constexpr std::string_view kInverseEnding = "-inverse";

[[noreturn]] void RejectName(const std::string& name) {
  throw Error("pattern name \"" + name.substr(0, 80) +
              "\" is none of: white, black, {column,row}-gray-BIT[-inverse], "
              "{column,row}-phase-STEP; correct the manifest's roles");
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

void AppendAxis(PatternSequence& sequence, PatternAxis axis) {
  const int bits = GrayBits(sequence, axis);
  for (int i = 0; i < bits; ++i) {
    sequence.patterns.push_back({PatternKind::kGray, axis, i});
    sequence.patterns.push_back({PatternKind::kGrayInverse, axis, i});
  }
  for (int i = 0; i < sequence.phase_steps; ++i) {
    sequence.patterns.push_back({PatternKind::kPhase, axis, i});
  }
}

/// Largest phase index + 1 along an axis; Error unless all smaller ones are there too.
int CountPhaseSteps(const PatternSequence& sequence, PatternAxis axis) {
  std::set<int> found;
  for (const Pattern& p : sequence.patterns) {
    if (p.kind == PatternKind::kPhase && p.axis == axis) found.insert(p.index);
  }
  if (found.empty()) return 0;
  const int steps = *found.rbegin() + 1;
  if (steps != static_cast<int>(found.size()) || steps < 3) {
    throw Error("the " + std::string(AxisWord(axis)) +
                "phase patterns must be numbered 0, 1, ... without gaps, at least three of them");
  }
  return steps;
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
      return axis + "phase-" + std::to_string(pattern.index);
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
  int limit = kMaxGrayBits;
  if (TakePrefix(rest, "gray-")) {
    pattern.kind = PatternKind::kGray;
    if (rest.ends_with(kInverseEnding)) {
      pattern.kind = PatternKind::kGrayInverse;
      rest.remove_suffix(kInverseEnding.size());
    }
  } else if (TakePrefix(rest, "phase-")) {
    pattern.kind = PatternKind::kPhase;
    limit = kMaxPhaseSteps;
  } else {
    RejectName(name);
  }
  const auto [end, error] = std::from_chars(rest.begin(), rest.end(), pattern.index);
  const bool whole = error == std::errc() && end == rest.end();
  if (!whole || pattern.index < 0 || pattern.index >= limit || PatternName(pattern) != name) {
    RejectName(name);
  }
  return pattern;
}

int GrayBits(const PatternSequence& sequence, PatternAxis axis) {
  const int size = AxisSize(sequence, axis);
  return size < 1 ? 0 : static_cast<int>(std::bit_width(static_cast<unsigned>(size - 1)));
}

PatternSequence MakePatternSequence(int projector_width, int projector_height, PatternRows rows) {
  CheckProjectorSize(projector_width, projector_height);
  PatternSequence sequence;
  sequence.projector_width = projector_width;
  sequence.projector_height = projector_height;
  sequence.patterns.push_back({PatternKind::kWhite, PatternAxis::kColumn, 0});
  sequence.patterns.push_back({PatternKind::kBlack, PatternAxis::kColumn, 0});
  AppendAxis(sequence, PatternAxis::kColumn);
  if (rows == PatternRows::kWith) AppendAxis(sequence, PatternAxis::kRow);
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
    if (gray && pattern.index >= GrayBits(sequence, pattern.axis)) {
      throw Error("pattern \"" + name + "\" is a bit that a projector of " +
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
      const double turns = static_cast<double>(number) / sequence.phase_period_px -
                           static_cast<double>(pattern.index) / sequence.phase_steps;
      return 0.5 + 0.5 * std::cos(2 * std::numbers::pi * turns);
    }
  }
  return 0;
}

}  // namespace lfm
