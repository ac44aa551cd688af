// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/page_marks.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace lfm {
namespace {

// The vectors of RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foob"), "Zm9vYg==");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(FillMark, PutsTextInItsPlaceOrSaysThatThereIsNone) {
  EXPECT_EQ(FillMark("<title>@LFM_TITLE@</title>", kTitleMark, "a $1 \\1"),
            "<title>a $1 \\1</title>");
  EXPECT_EQ(FillMark("@LFM_TITLE@", kTitleMark, ""), "");
  EXPECT_THROW(FillMark("<title></title>", kTitleMark, "a"), Error);
}

}  // namespace
}  // namespace lfm
