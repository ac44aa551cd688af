// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace lfm::vrml {

enum class TokenKind { kEnd, kNumber, kString, kWord, kSymbol };

/// A lexical unit of VRML97 (ISO/IEC 14772-1, Annex A).
struct Token {
  TokenKind kind = TokenKind::kEnd;
  int line = 1;
  double number = 0;  ///< of kNumber; finite
  std::string text;   ///< of kWord, kString (escapes resolved) and kSymbol: one of [ ] { } .
};

/// Takes a text apart: comments go, commas are white space. Throws Error, naming file and line, for
/// what is no token: an open string, `12abc`, a number that does not fit a double, characters that
/// identifiers cannot have.
class Tokens {
 public:
  /// Both must outlive this. `name` stands for the file in messages.
  Tokens(std::string_view text, const std::string& name);
  const Token& Peek() const { return token_; }
  Token Take();
  /// Whether the next token is this word or symbol; when it is, takes it.
  bool TakeIf(std::string_view text);
  /// Takes a symbol that has to be there.
  void Expect(std::string_view symbol);
  /// Takes a word that has to be there; `what` says which.
  std::string TakeWord(const std::string& what);
  [[noreturn]] void Fail(int line, const std::string& problem) const;

 private:
  void Advance();
  void SkipBlank();
  void ReadString();
  void ReadNumber();

  std::string_view rest_;
  const std::string& name_;
  int line_ = 1;
  Token token_;
};

/// The file's own text as messages may hold it: in quotes, one line, not too long.
std::string Quoted(std::string_view text);

/// What every message of a VRML file looks like.
[[noreturn]] void FailAt(const std::string& name, int line, const std::string& problem);

}  // namespace lfm::vrml
