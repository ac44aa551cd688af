// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace lfm {

/// Whose fault a failure is; decides the exit status of a command.
enum class ErrorKind {
  kInput,   ///< Bad input or usage: exit status 2.
  kSystem,  ///< Our own failure, or the machine's (a full disk): exit status 1.
};

/// What every library function throws for bad input, bad files and failures of the machine.
///
/// The message is one line: what was wrong, in which file, and what to do about it.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ErrorKind kind = ErrorKind::kInput)
      : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// Thrown by `Progress` when the user pressed Ctrl-C: exit status 130.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace lfm
