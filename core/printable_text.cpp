// SPDX-License-Identifier: BSD-3-Clause
#include "core/printable_text.h"

#include <cstdint>
#include <cstdio>

namespace lfm {
namespace {

// Bytes of the character that `text` begins with; 0 when it is none that can be shown.
size_t ShownBytes(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7f ? 1 : 0;
  const size_t count = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : byte(0) >= 0xc0 ? 2 : 0;
  if (count == 0 || count > text.size()) return 0;
  uint32_t code = byte(0) & (0xffU >> (count + 1));
  for (size_t i = 1; i < count; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fU);
  }
  // 0x80 to 0x9f are control characters as well; surrogates and overlong forms are no UTF-8.
  constexpr uint32_t kLeast[] = {0, 0, 0xa0, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code >= kLeast[count] && code <= 0x10ffff && !surrogate ? count : 0;
}

}  // namespace

std::string PrintableText(std::string_view text) {
  std::string printable;
  for (size_t i = 0; i < text.size();) {
    if (text[i] == '\n' || text[i] == '\r') {
      printable += ' ';
      ++i;
    } else if (const size_t count = ShownBytes(text.substr(i)); count > 0) {
      printable += text.substr(i, count);
      i += count;
    } else {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<uint8_t>(text[i]));
      printable += escaped;
      ++i;
    }
  }
  return printable;
}

}  // namespace lfm
