// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/page_marks.h"

#include <cstddef>
#include <cstdint>

#include "core/error.h"

namespace lfm {

std::string FillMark(std::string_view page, std::string_view mark, std::string_view text) {
  const size_t at = page.find(mark);
  if (at == std::string_view::npos) {
    throw Error("the web page has no place for " + std::string(mark), ErrorKind::kSystem);
  }
  std::string filled;
  filled.reserve(page.size() + text.size());
  filled.append(page.substr(0, at)).append(text).append(page.substr(at + mark.size()));
  return filled;
}

std::string Base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  for (size_t i = 0, to = 0; i < bytes.size(); i += 3, to += 4) {
    uint32_t group = 0;
    const size_t count = bytes.size() - i < 3 ? bytes.size() - i : 3;
    for (size_t k = 0; k < count; ++k) {
      group |= static_cast<uint32_t>(static_cast<uint8_t>(bytes[i + k])) << (16 - 8 * k);
    }
    for (size_t k = 0; k <= count; ++k) text[to + k] = kDigits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

}  // namespace lfm
