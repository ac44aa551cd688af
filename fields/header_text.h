// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace lfm {

/// Words of text at the head of a binary file, one after the other; what is wrong is an Error that
/// begins with the file's name.
class HeaderText {
 public:
  /// Refers to `bytes`.
  HeaderText(std::string_view bytes, std::string name);

  /// Leaves out lines that begin with '#', here and now.
  void SkipComments();
  std::string Word();
  int Integer(int least, int largest);
  /// Finite, of magnitude `largest` at most.
  double Number(double largest);
  /// What follows the line end after the last word: CR LF, or LF, with blanks before.
  std::string_view Rest();
  /// Throws Error unless exactly `bytes` follow (Rest must have been asked).
  void RequireSize(size_t bytes) const;
  [[noreturn]] void Fail(const std::string& problem) const;

 private:
  std::string_view bytes_;
  std::string name_;
  size_t at_ = 0;
};

}  // namespace lfm
