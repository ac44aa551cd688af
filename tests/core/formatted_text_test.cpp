// SPDX-License-Identifier: BSD-3-Clause
#include "core/formatted_text.h"

#include <gtest/gtest.h>

namespace lfm {
namespace {

TEST(FormattedText, IsWhatPrintfPrints) {
  EXPECT_EQ(FormattedText("%.2f dB of %s, %d", 31.415, "bust", 7), "31.41 dB of bust, 7");
  EXPECT_EQ(FormattedText("%s", ""), "");
  const std::string longer(5000, 'x');
  EXPECT_EQ(FormattedText("<%s>", longer.c_str()), "<" + longer + ">");
}

}  // namespace
}  // namespace lfm
