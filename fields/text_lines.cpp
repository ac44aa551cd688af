// SPDX-License-Identifier: BSD-3-Clause
#include "fields/text_lines.h"

#include <charconv>
#include <cmath>
#include <system_error>

#include "core/error.h"

namespace lfm {
namespace {

constexpr std::string_view kBlanks = " \t\v\f";

std::string_view Trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

// Whether a number that no double can hold is so for being tiny: what counts is the sign of its
// exponent.
bool IsTiny(std::string_view word) {
  const size_t exponent = word.find_first_of("eE");
  if (exponent != std::string_view::npos) return word.substr(exponent + 1).starts_with('-');
  // Hundreds of digits: tiny when there are none but zeros in front of the point.
  return word.substr(0, word.find('.')).find_first_of("123456789") == std::string_view::npos;
}

}  // namespace

std::vector<TextLine> LinesOfText(std::string_view text, const std::string& name) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (text.find('\0') != std::string_view::npos) {
    throw Error(name + ": is not plain text; save it as text in UTF-8");
  }
  std::vector<TextLine> lines;
  int number = 0;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
    ++number;
    const std::string_view line = Trimmed(text.substr(begin, end - begin));
    if (!line.empty()) lines.push_back({number, line});
    begin = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
  }
  return lines;
}

std::vector<std::string_view> WordsOfLine(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t begin = line.find_first_not_of(kBlanks); begin < line.size();
       begin = line.find_first_not_of(kBlanks, begin)) {
    const size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

std::optional<double> NumberOfWord(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range && IsTiny(word)) return 0.0;
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string LinePlace(const std::string& name, int line) {
  return name + ": line " + std::to_string(line) + ": ";
}

std::string Quoted(std::string_view text) {
  constexpr size_t kMost = 80;
  if (text.size() <= kMost) return "'" + std::string(text) + "'";
  return "'" + std::string(text.substr(0, kMost)) + "...'";
}

}  // namespace lfm
