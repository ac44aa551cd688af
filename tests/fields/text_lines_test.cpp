// SPDX-License-Identifier: BSD-3-Clause
#include "fields/text_lines.h"

#include <gtest/gtest.h>

#include "tests/fields/field_files.h"

namespace lfm::testing {
namespace {

TEST(TextLines, LineEndsOfEveryMachineAreTheSame) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string text = "\xef\xbb\xbf a b \t" + end + end + "  " + end + "c" + end + "d";
    const std::vector<TextLine> lines = LinesOfText(text, "x");
    ASSERT_EQ(lines.size(), 3u);
    EXPECT_EQ(lines[0].text, "a b");
    EXPECT_EQ(lines[0].number, 1);
    EXPECT_EQ(lines[1].text, "c");
    EXPECT_EQ(lines[1].number, 4);
    EXPECT_EQ(lines[2].text, "d");
    EXPECT_EQ(lines[2].number, 5);
  }
  EXPECT_TRUE(LinesOfText("", "x").empty());
  EXPECT_TRUE(LinesOfText("\xef\xbb\xbf", "x").empty());
  EXPECT_TRUE(LinesOfText(" \r\n\t\n", "x").empty());
}

TEST(TextLines, WhatIsNoTextIsRefused) {
  // "2" in UTF-16.
  ExpectErrorWith({"lights.lp", "plain text"},
                  [] { LinesOfText(std::string("\xff\xfe\x32\x00", 4), "lights.lp"); });
}

TEST(TextLines, WordsStandApartByBlanksAndTabs) {
  EXPECT_TRUE(WordsOfLine("").empty());
  EXPECT_TRUE(WordsOfLine(" \t ").empty());
  const std::vector<std::string_view> words = WordsOfLine("\ta  b\t \tcd ");
  EXPECT_EQ(words, (std::vector<std::string_view>{"a", "b", "cd"}));
}

TEST(TextLines, NumbersAreWholeWordsAndFinite) {
  EXPECT_EQ(NumberOfWord("-0.5"), -0.5);
  EXPECT_EQ(NumberOfWord("+.25"), 0.25);
  EXPECT_EQ(NumberOfWord("1.5E-3"), 1.5e-3);
  EXPECT_EQ(NumberOfWord("-1e+02"), -100);
  EXPECT_EQ(NumberOfWord("1e-999"), 0);
  EXPECT_EQ(NumberOfWord("0." + std::string(400, '0') + "1"), 0);
  for (const std::string word : {"", "+", "+-1", "nan", "-inf", "infinity", "1e999", "0,5", "1x",
                                 "x1", "1 2", "--1", "0x10", "1e", "e5"}) {
    EXPECT_FALSE(NumberOfWord(word)) << word;
  }
  EXPECT_FALSE(NumberOfWord(std::string(400, '9')));
}

TEST(TextLines, QuotedTextIsCutShort) {
  EXPECT_EQ(Quoted("a"), "'a'");
  EXPECT_LT(Quoted(std::string(1000000, 'a')).size(), 100u);
}

}  // namespace
}  // namespace lfm::testing
