// SPDX-License-Identifier: BSD-3-Clause
#include "fields/lp_file.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

constexpr double kDirection_abs = 1e-15;

TEST(LpFile, HoldsACountThenAPictureWithItsDirectionALine) {
  const LpFile file = ParseLp("2\nimg_01.jpg 0 0 1\nimg_02.jpg 0.6 -0.8 0\n", "x.lp");
  ASSERT_EQ(file.lights.size(), 2u);
  EXPECT_EQ(file.lights[0].picture, "img_01.jpg");
  EXPECT_EQ(file.lights[0].line, 2);
  EXPECT_EQ(file.lights[0].to_light, Eigen::Vector3d(0, 0, 1));
  EXPECT_LT((file.lights[1].to_light - Eigen::Vector3d(0.6, -0.8, 0)).norm(), kDirection_abs);
  EXPECT_EQ(file.not_unit, 0);
}

TEST(LpFile, NamesWithBlanksAndPathsOfOtherMachinesAreKept) {
  const LpFile file = ParseLp(
      "\xef\xbb\xbf"
      "4\r\n"
      "C:\\My RTI\\jpeg-exports\\coin 01.JPG 0.1 0.2 0.97\r\n"
      "\"/home/me/a  b.png\"\t-1.0E-1\t+.5\t8.6e-1\r\n"
      "  plain.jpg   0 0 1  \r\n"
      "12 3.jpg 1 0 0",
      "x.lp");
  ASSERT_EQ(file.lights.size(), 4u);
  EXPECT_EQ(file.lights[0].picture, "C:\\My RTI\\jpeg-exports\\coin 01.JPG");
  EXPECT_EQ(file.lights[1].picture, "/home/me/a  b.png");
  EXPECT_LT((file.lights[1].to_light - Eigen::Vector3d(-0.1, 0.5, 0.86).normalized()).norm(),
            kDirection_abs);
  EXPECT_EQ(file.lights[2].picture, "plain.jpg");
  EXPECT_EQ(file.lights[3].picture, "12 3.jpg");
}

TEST(LpFile, BlankLinesAndRemarksAreSkipped) {
  const LpFile file = ParseLp("# by a dome\n\n 1 \n\n#1.jpg 0 0 1\n# end\n\n\n", "x.lp");
  ASSERT_EQ(file.lights.size(), 1u);
  EXPECT_EQ(file.lights[0].picture, "#1.jpg");
  EXPECT_EQ(file.lights[0].line, 5);
}

TEST(LpFile, RemarksMayEndInThreeNumbers) {
  const LpFile file =
      ParseLp("# made 2020 1 2\n2\n# note 1 2 3\na.png 0 0 1\n#b.png 0 1 0\n", "lights.lp");
  ASSERT_EQ(file.lights.size(), 2u);
  EXPECT_EQ(file.lights[1].picture, "#b.png");
}

TEST(LpFile, PositionsOfAnyLengthBecomeDirections) {
  const LpFile file =
      ParseLp("4\na 300 0 400\nb 3e-25 0 4e-25\nc 3e25 0 -4e25\nd 0.6 0 0.8\n", "x.lp");
  for (const LpLight& light : file.lights) {
    EXPECT_NEAR(light.to_light.norm(), 1, kDirection_abs);
    EXPECT_NEAR(light.to_light.x(), 0.6, kDirection_abs);
    EXPECT_NEAR(std::abs(light.to_light.z()), 0.8, kDirection_abs);
  }
  EXPECT_LT(file.lights[2].to_light.z(), 0);  // below the horizon
  EXPECT_EQ(file.not_unit, 3);
}

TEST(LpFile, AWrongCountIsNamedWithTheOther) {
  ExpectErrorWith({"x.lp", "3 lights", "but 2"}, [] { ParseLp("3\na 0 0 1\nb 0 0 1\n", "x.lp"); });
  ExpectErrorWith({"x.lp", "1 lights", "but 2"}, [] { ParseLp("1\na 0 0 1\nb 0 0 1\n", "x.lp"); });
  ExpectErrorWith({"999999999999 lights", "but 1"},
                  [] { ParseLp("999999999999\na 0 0 1\n", "x.lp"); });
  ExpectErrorWith({"x.lp", "no light"}, [] { ParseLp("0\n", "x.lp"); });
}

TEST(LpFile, WhatCannotBeReadIsNamedWithItsLine) {
  struct Case {
    const char* text;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases = {
      {"", {"x.lp", "is empty"}},
      {"\r\n \r\n", {"x.lp", "is empty"}},
      {"a.jpg 0 0 1\n", {"line 1", "number of lights", "a.jpg"}},
      {"-1\na 0 0 1\n", {"line 1", "number of lights"}},
      {"1.5\na 0 0 1\n", {"line 1", "number of lights"}},
      {"99999999999999999999\na 0 0 1\n", {"line 1", "number of lights"}},
      {"1\na 0 0\n", {"line 2", "a picture's name and x, y, z"}},
      {"1\n0 0 1\n", {"line 2", "a picture's name and x, y, z"}},
      {"1\na 0,5 0,5 0,7\n", {"line 2", "'0,5'", "decimal points"}},
      {"1\na 0 nan 1\n", {"line 2", "'nan'", "finite"}},
      {"1\na 0 0 inf\n", {"line 2", "'inf'", "finite"}},
      {"1\na 0 1e999 1\n", {"line 2", "'1e999'"}},
      {"1\na 0 0 0\n", {"line 2", "no direction"}},
      {"1\na 1e-31 0 0\n", {"line 2", "no direction"}},
      {"1\na 1e308 1e308 1e308\n", {"line 2", "no direction"}},
      {"1\n\"\" 0 0 1\n", {"line 2", "name is empty"}},
  };
  for (const Case& c : cases) {
    ExpectErrorWith(c.parts, [&] { ParseLp(c.text, "x.lp"); });
  }
  ExpectErrorWith({"plain text"}, [] { ParseLp(std::string("1\0\n", 3), "x.lp"); });
}

TEST(LpFile, EveryFileThatIsCutShortIsRefused) {
  const std::string whole = "3\na.jpg 0.36 0.48 0.8\nb c.jpg 0.6 0.0 0.8\nd.jpg 0.0 0.0 1.25";
  EXPECT_NO_THROW(ParseLp(whole, "x.lp"));
  // Of the last line any beginning that still has three numbers cannot be told from a whole one.
  const size_t last_number = whole.size() - 4;
  for (size_t length = 0; length <= last_number; ++length) {
    ExpectErrorWith({"x.lp"}, [&] { ParseLp(whole.substr(0, length), "x.lp"); });
  }
}

TEST(LpFile, DamageGivesDirectionsOrOneLineOfError) {
  const std::string whole = "3\r\n\"a b.jpg\" 0.36 0.48 0.8\r\nb.jpg\t6e-1 0 +.8\n#x\nd 0 0 1.25\n";
  const std::string bytes("\0\r\n\t \"#.-+eE019xn\xef\xbb\xbf\xff", 21);
  std::mt19937 random(11);
  int read = 0, refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = whole;
    for (size_t edits = random() % 4 + 1; edits > 0; --edits) {
      const size_t at = random() % text.size();
      if (random() % 3 == 0) text.erase(at, random() % 4);
      if (text.empty()) text = "3";
      if (random() % 2 == 0) text[random() % text.size()] = bytes[random() % bytes.size()];
      if (random() % 3 == 0) text.insert(at % text.size(), 1, bytes[random() % bytes.size()]);
    }
    try {
      for (const LpLight& light : ParseLp(text, "x.lp").lights) {
        ASSERT_NEAR(light.to_light.norm(), 1, 1e-12);
        ASSERT_FALSE(light.picture.empty());
      }
      ++read;
    } catch (const Error& error) {
      ASSERT_EQ(std::string(error.what()).find_first_of("\r\n"), std::string::npos) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(LpFile, FilesAreReadFromDisk) {
  const ScratchFolder scratch;
  PutText(scratch.folder / "a.lp", "1\na.jpg 0 0 1\n");
  EXPECT_EQ(ReadLpFile(scratch.folder / "a.lp").lights.size(), 1u);
  ExpectErrorWith({"b.lp"}, [&] { ReadLpFile(scratch.folder / "b.lp"); });
  ExpectErrorWith({scratch.folder.string()}, [&] { ReadLpFile(scratch.folder); });
}

}  // namespace
}  // namespace lfm::testing
