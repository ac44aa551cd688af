// SPDX-License-Identifier: BSD-3-Clause
#include "fields/header_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

constexpr size_t kLongestWord = 64;

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

HeaderText::HeaderText(std::string_view bytes, std::string name)
    : bytes_(bytes), name_(std::move(name)) {}

void HeaderText::Fail(const std::string& problem) const { throw Error(name_ + ": " + problem); }

void HeaderText::SkipComments() {
  while (at_ < bytes_.size() && bytes_[at_] == '#') {
    at_ = bytes_.find('\n', at_);
    at_ = at_ == std::string_view::npos ? bytes_.size() : at_ + 1;
  }
}

std::string HeaderText::Word() {
  while (at_ < bytes_.size() && IsBlank(bytes_[at_])) ++at_;
  const size_t begin = at_;
  while (at_ < bytes_.size() && !IsBlank(bytes_[at_]) && at_ - begin <= kLongestWord) ++at_;
  if (at_ == begin) Fail("ends within its header");
  if (at_ - begin > kLongestWord) Fail("has no header of lines of text");
  std::string word(bytes_.substr(begin, at_ - begin));
  if (!std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c <= '~'; })) {
    Fail("has no header of lines of text");
  }
  return word;
}

int HeaderText::Integer(int least, int largest) {
  const std::string word = Word();
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < least ||
      value > largest) {
    Fail("'" + word + "' in its header is no whole number from " + std::to_string(least) + " to " +
         std::to_string(largest));
  }
  return value;
}

double HeaderText::Number(double largest) {
  const std::string word = Word();
  double value = 0;
  const size_t sign = word.starts_with('+') ? 1 : 0;
  const auto [end, error] = std::from_chars(word.data() + sign, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= largest)) {
    Fail("'" + word + "' in its header is no number that can be used");
  }
  return value;
}

std::string_view HeaderText::Rest() {
  while (at_ < bytes_.size() && (bytes_[at_] == ' ' || bytes_[at_] == '\t')) ++at_;
  if (at_ < bytes_.size() && bytes_[at_] == '\r') ++at_;
  if (at_ >= bytes_.size() || bytes_[at_] != '\n') Fail("ends within its header");
  ++at_;
  return bytes_.substr(at_);
}

void HeaderText::RequireSize(size_t bytes) const {
  const size_t there = bytes_.size() - at_;
  if (there == bytes) return;
  Fail("its header promises " + std::to_string(bytes) + " bytes of content, but " +
       std::to_string(there) + " are there");
}

}  // namespace lfm
