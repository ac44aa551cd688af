// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "house_rules.h"

namespace lfm {
namespace {

const std::string kSpdx = "// SPDX-License-Identifier: BSD-3-Clause\n";
const std::string kCmakeSpdx = "# SPDX-License-Identifier: BSD-3-Clause\n";

/// A small house in which every rule holds.
SourceTree GoodHouse() {
  SourceTree tree;
  for (const char* room : {"core", "calib", "scan", "mesh", "sample_data"}) {
    tree[std::string(room) + "/README.md"] = "# A room\n";
  }
  tree["core/CMakeLists.txt"] =
      kCmakeSpdx + "lfm_stage(core\n  SOURCES pose.cpp\n  PUBLIC_HEADERS pose.h error.h)\n";
  tree["core/pose.h"] = kSpdx + "#include \"core/error.h\"\n#include <vector>\n";
  tree["core/error.h"] = kSpdx;
  tree["calib/CMakeLists.txt"] =
      kCmakeSpdx +
      "lfm_stage(calib SOURCES a.cpp PUBLIC_HEADERS board.h  # the board\n"
      "  calib.h LINK lfm_core)\n";
  tree["calib/board.h"] = kSpdx + "#include \"core/pose.h\"\n";
  tree["calib/calib.h"] = kSpdx + "#include \"calib/corners.h\"\n";
  tree["calib/corners.h"] = kSpdx;
  tree["scan/CMakeLists.txt"] = kCmakeSpdx + "lfm_stage(scan PUBLIC_HEADERS patterns.h scan.h)\n";
  tree["scan/scan.h"] = kSpdx + "#include \"calib/calib.h\"\n";
  tree["scan/patterns.h"] = kSpdx;
  tree["mesh/mesh.cpp"] = kSpdx + "#include \"scan/scan.h\"\n#include \"core/pose.h\"\n";
  tree["sample_data/studio.cpp"] = kSpdx +
                                   "#include \"calib/board.h\"\n#include \"scan/patterns.h\"\n"
                                   "#include \"core/pose.h\"\n#include \"sample_data/lights.h\"\n"
                                   "const char* kTruth = \"ground_truth\";\n";
  tree["tests/mesh/mesh_test.cpp"] = kSpdx + "#include \"mesh/mesh.h\"\n";
  return tree;
}

/// The only broken rule after one file of the good house was replaced.
std::string OnlyBrokenRule(const std::string& path, const std::string& text) {
  SourceTree tree = GoodHouse();
  tree[path] = text;
  const std::vector<std::string> broken = FindBrokenRules(tree);
  if (broken.size() == 1) return broken[0];
  return std::to_string(broken.size()) + " broken rules";
}

TEST(HouseRules, GoodHouseHasNoBrokenRule) {
  const std::vector<std::string> broken = FindBrokenRules(GoodHouse());
  EXPECT_TRUE(broken.empty()) << broken.front();
}

TEST(HouseRules, IncludeToTheRightIsFound) {
  EXPECT_EQ(OnlyBrokenRule("calib/a.cpp", kSpdx + "#include \"scan/scan.h\"\n"),
            "calib/a.cpp: includes \"scan/scan.h\", which belongs to a stage to the right");
  EXPECT_EQ(OnlyBrokenRule("calib/a.cpp", kSpdx + "  #  include \"pipeline/x.h\"\n"),
            "calib/a.cpp: includes \"pipeline/x.h\", which belongs to a stage to the right");
  EXPECT_EQ(OnlyBrokenRule("core/a.cpp", kSpdx + "#include \"calib/board.h\"\n"),
            "core/a.cpp: includes \"calib/board.h\", which is not core's");
  EXPECT_EQ(OnlyBrokenRule("scan/a.cpp", kSpdx + "#include \"sample_data/lights.h\"\n"),
            "scan/a.cpp: includes \"sample_data/lights.h\", which is sample_data's own");
  EXPECT_EQ(OnlyBrokenRule("scan/a.cpp", kSpdx + "#include \"tests/core/zoo.h\"\n"),
            "scan/a.cpp: includes \"tests/core/zoo.h\", which belongs to the tests");
}

TEST(HouseRules, IncludeOfAPrivateHeaderIsFound) {
  EXPECT_EQ(OnlyBrokenRule("scan/a.cpp", kSpdx + "#include \"calib/corners.h\"\n"),
            "scan/a.cpp: includes \"calib/corners.h\", which is not a public header");
  EXPECT_EQ(OnlyBrokenRule("scan/a.cpp", kSpdx + "#include \"core/codec.h\"\n"),
            "scan/a.cpp: includes \"core/codec.h\", which is not a public header");
  // A header that only a comment of the CMakeLists.txt names is not public.
  EXPECT_EQ(OnlyBrokenRule("scan/CMakeLists.txt",
                           kCmakeSpdx + "lfm_stage(scan PUBLIC_HEADERS patterns.h # scan.h\n)\n"),
            "mesh/mesh.cpp: includes \"scan/scan.h\", which is not a public header");
  EXPECT_EQ(OnlyBrokenRule("scan/CMakeLists.txt",
                           kCmakeSpdx + "lfm_stage(scan PUBLIC_HEADERS patterns.h LINK scan.h)\n"),
            "mesh/mesh.cpp: includes \"scan/scan.h\", which is not a public header");
}

TEST(HouseRules, IncludeWithoutARoomIsFound) {
  EXPECT_EQ(OnlyBrokenRule("calib/a.cpp", kSpdx + "#include \"board.h\"\n"),
            "calib/a.cpp: includes \"board.h\", which is not of the form \"room/file.h\"");
  EXPECT_EQ(OnlyBrokenRule("calib/a.cpp", kSpdx + "#include \"../scan/scan.h\"\n"),
            "calib/a.cpp: includes \"../scan/scan.h\", which is not of the form \"room/file.h\"");
}

TEST(HouseRules, SampleDataThatKnowsAStageIsFound) {
  for (const char* header : {"calib/calib.h", "scan/scan.h", "mesh/mesh.h"}) {
    EXPECT_EQ(
        OnlyBrokenRule("sample_data/a.cpp", kSpdx + "#include \"" + std::string(header) + "\"\n"),
        "sample_data/a.cpp: includes \"" + std::string(header) +
            "\", which is not for sample_data, which knows core/, calib/board.h and "
            "scan/patterns.h");
  }
}

TEST(HouseRules, StageThatKnowsGroundTruthIsFound) {
  EXPECT_EQ(OnlyBrokenRule("mesh/a.cpp", kSpdx + "auto f = folder / \"ground_truth\";\n"),
            "mesh/a.cpp: knows of ground_truth");
}

TEST(HouseRules, MissingSpdxLineIsFound) {
  EXPECT_EQ(OnlyBrokenRule("mesh/a.cpp", "int a;\n"), "mesh/a.cpp: the SPDX line is missing");
  EXPECT_EQ(OnlyBrokenRule("tests/mesh/a_test.cpp", ""),
            "tests/mesh/a_test.cpp: the SPDX line is missing");
  EXPECT_EQ(OnlyBrokenRule("mesh/a.cpp", "// SPDX-License-Identifier: MIT\n"),
            "mesh/a.cpp: the SPDX line is missing");
  EXPECT_EQ(OnlyBrokenRule("viewer/CMakeLists.txt", "project(x)\n"),
            "viewer/CMakeLists.txt: the SPDX line is missing");
}

TEST(HouseRules, LongFilesAreFound) {
  std::string text = kSpdx;
  for (int i = 0; i < 399; ++i) text += "\n";
  EXPECT_EQ(OnlyBrokenRule("mesh/a.cpp", text), "0 broken rules");
  EXPECT_EQ(OnlyBrokenRule("mesh/a.cpp", text + "int a;"), "mesh/a.cpp: has 401 lines");
}

TEST(HouseRules, MissingOrLongReadmeIsFound) {
  std::string text;
  for (int i = 0; i < 21; ++i) text += "line\n";
  EXPECT_EQ(OnlyBrokenRule("mesh/README.md", text), "mesh/README.md: has 21 lines");
  SourceTree tree = GoodHouse();
  tree.erase("mesh/README.md");
  EXPECT_EQ(FindBrokenRules(tree), std::vector<std::string>{"mesh/README.md: is missing"});
}

TEST(HouseRules, TestsThatADocumentNamesMustExist) {
  SourceTree tree = GoodHouse();
  tree["tests/mesh/mesh_test.cpp"] = kSpdx + "TEST(Mesh, IsRound) {}\nTEST_F(Mesh,\n  IsFlat) {}\n";
  EXPECT_TRUE(FindUnknownTests("see `Mesh.IsRound`, `Mesh.IsFlat`", tree).empty());
  EXPECT_EQ(FindUnknownTests("see `Mesh.IsCubic` in `mesh.h`", tree),
            std::vector<std::string>{"Mesh.IsCubic"});
}

TEST(HouseRules, ConventionsNameTestsThatExist) {
  std::ifstream stream(std::filesystem::path(LFM_SOURCE_DIR) / "docs/conventions.md");
  const std::string document{std::istreambuf_iterator<char>(stream), {}};
  ASSERT_NE(document.find("`HouseRules.HoldInThisTree`"), std::string::npos);
  for (const std::string& test : FindUnknownTests(document, ReadSourceTree(LFM_SOURCE_DIR))) {
    ADD_FAILURE() << "docs/conventions.md names " << test << ", which is no test";
  }
}

TEST(HouseRules, HoldInThisTree) {
  const SourceTree tree = ReadSourceTree(LFM_SOURCE_DIR);
  // The checker must have seen the tree before its silence means anything.
  ASSERT_TRUE(tree.contains("core/image.h"));
  ASSERT_TRUE(tree.contains("scan/CMakeLists.txt"));
  ASSERT_GT(tree.size(), 50u);
  for (const std::string& line : FindBrokenRules(tree)) ADD_FAILURE() << line;
}

}  // namespace
}  // namespace lfm
