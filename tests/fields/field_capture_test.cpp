// SPDX-License-Identifier: BSD-3-Clause
#include "fields/field_capture.h"

#include <gtest/gtest.h>

#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

class FieldCapture : public ::testing::Test {
 protected:
  Capture Open(const std::string& path) {
    return OpenFieldCapture(path.empty() ? scratch_.folder : scratch_.folder / path, {},
                            SilentProgress());
  }
  std::filesystem::path At(const std::string& file) { return scratch_.folder / file; }
  void PutLp(const std::string& file) {
    PutGray(At(file).replace_filename("a.png"), 1, 1, 10);
    PutText(At(file), "1\na.png 0 0 1\n");
  }
  void PutManifest(const std::string& field) {
    PutText(At("capture.json"),
            R"({"format": "lfm-capture", "version": 1, "photos": [], "name": "manifest",
                "cameras": {"view": {"width": 1, "height": 1}})" +
                field + "}");
  }

  ScratchFolder scratch_;
};

constexpr const char* kField =
    R"(, "reflectance_field": {"camera": "view", "encoding": "linear",
        "pictures": [{"file": "a.png", "direction": [0, 0, 1], "split": "train"}]})";

TEST_F(FieldCapture, EveryKindIsOpened) {
  PutLp("coin.LP");
  EXPECT_EQ(Open("coin.LP").name, "coin");
  EXPECT_EQ(Open("").name, "coin");
  PutText(At("filenames.txt"), "a.png\n");
  PutText(At("light_directions.txt"), "0 0 1\n");
  EXPECT_EQ(Open("").name, scratch_.folder.filename().string());  // DiLiGenT before .lp
  PutManifest(kField);
  EXPECT_EQ(Open("").name, "manifest");  // the manifest before all
  EXPECT_EQ(Open("capture.json").name, "manifest");
  EXPECT_EQ(Open("coin.LP").name, "coin");
}

TEST_F(FieldCapture, RtiBuildersFolderIsLookedInto) {
  PutText(At("assembly-files/coin.lp"), "1\na.jpg 0 0 1\n");
  PutGray(At("jpeg-exports/a.jpg"), 1, 1, 10);
  EXPECT_EQ(Open("").reflectance_field->pictures.at(0).file, "jpeg-exports/a.jpg");
}

TEST_F(FieldCapture, WhatIsNoneIsAnErrorThatSaysWhatIs) {
  ExpectErrorWith({scratch_.folder.string(), "capture.json", ".lp", "filenames.txt"},
                  [&] { Open(""); });
  ExpectErrorWith({"nowhere", "no such file or folder"}, [&] { Open("nowhere"); });
  PutText(At("readme.txt"), "1\na.png 0 0 1\n");
  ExpectErrorWith({"readme.txt", "neither a folder nor an .lp file"}, [&] { Open("readme.txt"); });
  PutText(At("filenames.txt"), "a.png\n");  // without directions
  ExpectErrorWith({"light_directions.txt"}, [&] { Open(""); });
  std::filesystem::create_directory(At("folder.lp"));
  ExpectErrorWith({"folder.lp", "holds no field"}, [&] { Open("folder.lp"); });
}

TEST_F(FieldCapture, SeveralLpFilesAreNamed) {
  PutLp("b.lp");
  PutLp("a.lp");
  ExpectErrorWith({"'a.lp', 'b.lp'", "name one"}, [&] { Open(""); });
  EXPECT_EQ(Open("b.lp").name, "b");
}

TEST_F(FieldCapture, AManifestWithoutAFieldIsAnError) {
  PutManifest("");
  ExpectErrorWith({"capture.json", "neither"}, [&] { Open(""); });
  PutManifest(", \"nonsense\": 1");
  ExpectErrorWith({"capture.json", "nonsense"}, [&] { Open(""); });
}

}  // namespace
}  // namespace lfm::testing
