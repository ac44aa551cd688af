// SPDX-License-Identifier: BSD-3-Clause
#include "fields/lp_file.h"

#include <charconv>
#include <cmath>
#include <optional>

#include "core/atomic_file.h"
#include "core/error.h"
#include "fields/text_lines.h"

namespace lfm {
namespace {

constexpr double kShortest = 1e-30, kLongest = 1e30;
constexpr double kUnitLength_abs = 0.01;

std::optional<int64_t> CountOfLine(std::string_view line) {
  int64_t count = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), count);
  if (error != std::errc() || end != line.data() + line.size() || count < 0) return std::nullopt;
  return count;
}

std::string WithoutQuotes(std::string_view name) {
  if (name.size() >= 2 && name.front() == '"' && name.back() == '"') {
    name = name.substr(1, name.size() - 2);
  }
  return std::string(name);
}

bool EndsInThreeNumbers(const std::vector<std::string_view>& words) {
  if (words.size() < 3) return false;
  for (size_t k = words.size() - 3; k < words.size(); ++k) {
    if (!NumberOfWord(words[k])) return false;
  }
  return true;
}

LpLight LightOfLine(const TextLine& line, const std::string& name) {
  const std::vector<std::string_view> words = WordsOfLine(line.text);
  if (words.size() < 4) {
    throw Error(LinePlace(name, line.number) + "expected a picture's name and x, y, z, not " +
                Quoted(line.text));
  }
  LpLight light;
  light.line = line.number;
  const size_t first = words.size() - 3;
  for (size_t k = 0; k < 3; ++k) {
    const std::optional<double> number = NumberOfWord(words[first + k]);
    if (!number) {
      throw Error(LinePlace(name, line.number) + Quoted(words[first + k]) +
                  " is not a finite number; after the picture's name come x, y, z with decimal "
                  "points");
    }
    light.to_light[static_cast<Eigen::Index>(k)] = *number;
  }
  const char* name_end = words[first - 1].data() + words[first - 1].size();
  light.picture =
      WithoutQuotes(line.text.substr(0, static_cast<size_t>(name_end - line.text.data())));
  if (light.picture.empty()) {
    throw Error(LinePlace(name, line.number) + "the picture's name is empty; write it in front");
  }
  return light;
}

}  // namespace

LpFile ParseLp(std::string_view text, const std::string& name) {
  const std::vector<TextLine> lines = LinesOfText(text, name);
  std::optional<int64_t> count;
  LpFile file;
  for (const TextLine& line : lines) {
    const bool is_comment = !count || line.text.starts_with("# ") || line.text.starts_with("#\t") ||
                            !EndsInThreeNumbers(WordsOfLine(line.text));
    if (line.text.starts_with('#') && is_comment) continue;
    if (!count) {
      count = CountOfLine(line.text);
      if (!count) {
        throw Error(LinePlace(name, line.number) + "expected the number of lights, not " +
                    Quoted(line.text) + "; write it above the first light");
      }
      continue;
    }
    LpLight light = LightOfLine(line, name);
    const double length = light.to_light.stableNorm();
    if (!(length >= kShortest && length <= kLongest)) {
      throw Error(LinePlace(name, line.number) + "x, y, z give no direction (their length is " +
                  std::to_string(length) + "); write the direction towards the light");
    }
    if (std::abs(length - 1) > kUnitLength_abs) ++file.not_unit;
    light.to_light = (light.to_light / length).normalized();
    file.lights.push_back(std::move(light));
  }
  if (!count) {
    throw Error(name + ": is empty; expected the number of lights and a line for each");
  }
  if (*count != static_cast<int64_t>(file.lights.size())) {
    throw Error(name + ": promises " + std::to_string(*count) + " lights, but " +
                std::to_string(file.lights.size()) +
                " follow; put the number right, or the lines that are missing");
  }
  if (file.lights.empty()) throw Error(name + ": holds no light; add a line for each picture");
  return file;
}

LpFile ReadLpFile(const std::filesystem::path& file) {
  constexpr size_t kMostBytes = size_t{1} << 26;
  return ParseLp(ReadFile(file, kMostBytes), file.string());
}

}  // namespace lfm
