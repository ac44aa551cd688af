// SPDX-License-Identifier: BSD-3-Clause
#include "core/config_file.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "core/printable_text.h"

namespace lfm {
namespace {

[[noreturn]] void Fail(int line, const std::string& problem) {
  throw CLI::ConfigError("line " + std::to_string(line) + ": " + problem);
}

// One line, without white space round it; what it is is left to CLI11.
void CheckLine(const std::string& line, int number) {
  // CLI11 passes over lines of one or two characters.
  constexpr size_t kShortest = 3;
  if (line.front() == '[') {
    Fail(number, line.find(']') == std::string::npos
                     ? "a section's name ends with ]"
                     : "options are in no sections; leave out " + line);
  }
  if (line.front() == '=' || line.size() < kShortest) {
    Fail(number, "\"" + line + "\" is no option; expected a line such as threads = 2");
  }
}

// Throws where a line is what nobody meant to write.
void CheckLines(std::istream& input) {
  int number = 0, array_begin = 0;
  for (std::string line; std::getline(input, line);) {
    ++number;
    std::replace(line.begin(), line.end(), '\t', ' ');
    CLI::detail::trim(line);
    if (PrintableText(line) != line) {
      Fail(number, "is no text; is this a file of options (TOML)?");
    }
    if (line.empty() || line.front() == '#' || line.front() == ';') continue;
    if (array_begin == 0) {
      CheckLine(line, number);
      const size_t equals = line.find('=');
      if (equals == std::string::npos) continue;
      const size_t value = line.find_first_not_of(' ', equals + 1);
      if (value == std::string::npos) Fail(number, "\"" + line + "\" gives no value");
      if (line[value] != '[') continue;
      array_begin = number;
    }
    if (line.find(']') != std::string::npos) array_begin = 0;
  }
  if (array_begin > 0) Fail(array_begin, "its [ is never closed");
}

bool IsPartOfOption(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
}

bool Names(const std::string& text, const std::string& option) {
  for (size_t at = text.find(option); at != std::string::npos; at = text.find(option, at + 1)) {
    const size_t end = at + option.size();
    if (end == text.size() || !IsPartOfOption(text[end])) return true;
  }
  return false;
}

}  // namespace

std::vector<CLI::ConfigItem> ConfigFileReader::from_config(std::istream& input) const {
  constexpr std::streamsize kMostBytes = 1 << 20;
  std::string content(kMostBytes, '\0');
  input.read(content.data(), kMostBytes);
  content.resize(input.gcount());
  if (content.size() == kMostBytes) {
    Fail(1, "begins more than a megabyte of text; is this a file of options (TOML)?");
  }
  std::stringstream text(content);
  CheckLines(text);
  text.clear();
  text.seekg(0);
  std::vector<CLI::ConfigItem> read = CLI::ConfigTOML::from_config(text);
  options_.clear();
  for (const CLI::ConfigItem& item : read) options_.insert("--" + item.name);
  return read;
}

bool ConfigFileReader::Caused(const std::string& what, int argc, char** argv) const {
  return std::any_of(options_.begin(), options_.end(), [&](const std::string& option) {
    return Names(what, option) && std::none_of(argv + 1, argv + argc, [&](const char* argument) {
             return std::string(argument).substr(0, std::string(argument).find('=')) == option;
           });
  });
}

}  // namespace lfm
