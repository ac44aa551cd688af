// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lfm {

/// A line of a text file without the blanks round it.
struct TextLine {
  int number = 0;  ///< from 1
  std::string_view text;
};

/// The lines of `text` that are not blank, whatever machine wrote them: a byte order mark and line
/// ends of all kinds (LF, CR LF, CR) are taken off. Views into `text`. Throws Error, `name` in
/// front, when it is no text in UTF-8 or a code page (a zero byte: UTF-16, or a binary file).
std::vector<TextLine> LinesOfText(std::string_view text, const std::string& name);

/// The words of a line, apart by blanks or tabs.
std::vector<std::string_view> WordsOfLine(std::string_view line);

/// A whole word as a finite number, with a point whatever the locale; a number too small to be held
/// is 0. No answer for anything else.
std::optional<double> NumberOfWord(std::string_view word);

/// "name: line 3: ", for messages.
std::string LinePlace(const std::string& name, int line);
/// The beginning of `text` in single quotes, for messages.
std::string Quoted(std::string_view text);

}  // namespace lfm
