// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <set>
#include <string>
#include <vector>

// Private to core; use core/command_line.h.

namespace lfm {

/// CLI11's reader of a command's --config FILE, which says what it would skip: lines that are no
/// text, sections, brackets that do not close, and lines without an option are a CLI::ConfigError
/// that names the line.
class ConfigFileReader : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

  /// True when the problem `what` ("--terms is 99 but ...") lies in a line of the file that was
  /// read: it names an option of the file that `argv` does not give, too.
  bool Caused(const std::string& what, int argc, char** argv) const;

 private:
  mutable std::set<std::string> options_;  ///< of the file: "--terms"
};

}  // namespace lfm
