// SPDX-License-Identifier: BSD-3-Clause
#include "encode/vrml_tokens.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/error.h"

namespace lfm::vrml {
namespace {

constexpr std::string_view kSymbols = "[]{}.";
constexpr size_t kMostQuoted = 60;  // of the file's own text in messages

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; }

// Annex A.3: IdRestChars, and what may come first. Bytes of UTF-8 beyond ASCII are letters.
bool GoesOnInWord(char c) {
  const auto code = static_cast<unsigned char>(c);
  constexpr std::string_view kNever = "\"#',.[\\]{}";
  return code > 0x20 && code != 0x7f && kNever.find(c) == std::string_view::npos;
}
bool BeginsWord(char c) { return GoesOnInWord(c) && !IsDigit(c) && c != '+' && c != '-'; }

bool EndsNumber(std::string_view rest) {
  return rest.empty() || IsBlank(rest.front()) || rest.front() == '#' || rest.front() == '"' ||
         (rest.front() != '.' && kSymbols.find(rest.front()) != std::string_view::npos);
}

}  // namespace

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text.substr(0, kMostQuoted)) {
    quoted += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return quoted + (text.size() > kMostQuoted ? "...\"" : "\"");
}

void FailAt(const std::string& name, int line, const std::string& problem) {
  throw Error(name + ", line " + std::to_string(line) + ": " + problem +
              "; correct the file, or write it again with lfm-encode --afx");
}

Tokens::Tokens(std::string_view text, const std::string& name) : rest_(text), name_(name) {
  Advance();
}

void Tokens::Fail(int line, const std::string& problem) const { FailAt(name_, line, problem); }

Token Tokens::Take() {
  Token taken = std::move(token_);
  Advance();
  return taken;
}

bool Tokens::TakeIf(std::string_view text) {
  const bool named = token_.kind == TokenKind::kWord || token_.kind == TokenKind::kSymbol;
  if (!named || token_.text != text) return false;
  Advance();
  return true;
}

void Tokens::Expect(std::string_view symbol) {
  if (!TakeIf(symbol)) Fail(token_.line, "\"" + std::string(symbol) + "\" is missing");
}

std::string Tokens::TakeWord(const std::string& what) {
  if (token_.kind != TokenKind::kWord) Fail(token_.line, what + " is missing");
  return Take().text;
}

void Tokens::SkipBlank() {
  while (!rest_.empty()) {
    if (rest_.front() == '#') {
      rest_.remove_prefix(std::min(rest_.find_first_of("\r\n"), rest_.size()));
    } else if (IsBlank(rest_.front())) {
      line_ += rest_.front() == '\n';
      rest_.remove_prefix(1);
    } else {
      return;
    }
  }
}

void Tokens::ReadString() {
  token_.kind = TokenKind::kString;
  size_t at = 1;
  for (; at < rest_.size() && rest_[at] != '"'; ++at) {
    // A backslash stands for the quote or backslash behind it, and for itself elsewhere.
    const bool escape = rest_[at] == '\\' && at + 1 < rest_.size() &&
                        (rest_[at + 1] == '"' || rest_[at + 1] == '\\');
    if (escape) ++at;
    line_ += rest_[at] == '\n';
    token_.text += rest_[at];
  }
  if (at >= rest_.size()) Fail(token_.line, "a string is not closed");
  rest_.remove_prefix(at + 1);
}

void Tokens::ReadNumber() {
  token_.kind = TokenKind::kNumber;
  const bool negative = rest_.front() == '-';
  if (negative || rest_.front() == '+') rest_.remove_prefix(1);
  const bool hexadecimal = rest_.starts_with("0x") || rest_.starts_with("0X");
  std::from_chars_result result{};
  if (hexadecimal) {
    uint32_t value = 0;
    result = std::from_chars(rest_.data() + 2, rest_.data() + rest_.size(), value, 16);
    token_.number = value;
  } else if (!rest_.empty() && (IsDigit(rest_.front()) || rest_.front() == '.')) {
    result = std::from_chars(rest_.data(), rest_.data() + rest_.size(), token_.number);
  } else {  // a sign alone, or words such as -inf that from_chars would take
    Fail(token_.line, "a number is missing behind a sign");
  }
  if (result.ec != std::errc() || !std::isfinite(token_.number)) {
    Fail(token_.line, "a number is out of range or has no digits");
  }
  rest_.remove_prefix(static_cast<size_t>(result.ptr - rest_.data()));
  if (!EndsNumber(rest_)) Fail(token_.line, "a number runs into something else");
  if (negative) token_.number = -token_.number;
}

void Tokens::Advance() {
  SkipBlank();
  token_ = {TokenKind::kEnd, line_, 0, {}};
  if (rest_.empty()) return;
  const char first = rest_.front();
  const bool point_of_number = first == '.' && rest_.size() > 1 && IsDigit(rest_[1]);
  if (first == '"') return ReadString();
  if (IsDigit(first) || first == '+' || first == '-' || point_of_number) return ReadNumber();
  if (kSymbols.find(first) != std::string_view::npos) {
    token_.kind = TokenKind::kSymbol;
    token_.text = first;
    rest_.remove_prefix(1);
    return;
  }
  size_t length = 0;
  if (BeginsWord(first)) {
    while (length < rest_.size() && GoesOnInWord(rest_[length])) ++length;
  }
  if (length == 0) {
    Fail(line_, Quoted(rest_.substr(0, 1)) + " cannot stand here");
  }
  token_.kind = TokenKind::kWord;
  token_.text = rest_.substr(0, length);
  rest_.remove_prefix(length);
}

}  // namespace lfm::vrml
