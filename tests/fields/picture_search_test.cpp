// SPDX-License-Identifier: BSD-3-Clause
#include "fields/picture_search.h"

#include <gtest/gtest.h>

#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

using Paths = std::vector<std::string>;

class PictureSearch : public ::testing::Test {
 protected:
  void PutAll(const Paths& files) {
    for (const std::string& file : files) PutText(scratch_.folder / file, "x");
  }
  Paths Find(const std::string& path, int levels = 3) {
    return FindPicture(ListFileNames(scratch_.folder, levels), path);
  }
  ScratchFolder scratch_;
};

TEST_F(PictureSearch, PathsInsideTheFolderAreTakenAsTheyStand) {
  PutAll({"a.jpg", "sub/a.jpg", "sub/b.jpg", "deep/er/than/the/list/c.jpg", "odd\\name.jpg"});
  EXPECT_EQ(Find("a.jpg"), Paths{"a.jpg"});
  EXPECT_EQ(Find("./sub//a.jpg"), Paths{"sub/a.jpg"});
  EXPECT_EQ(Find("sub\\a.jpg"), Paths{"sub/a.jpg"});
  EXPECT_EQ(Find("deep/er/than/the/list/c.jpg"), Paths{"deep/er/than/the/list/c.jpg"});
  EXPECT_EQ(Find("odd\\name.jpg"), Paths{"odd\\name.jpg"});
}

TEST_F(PictureSearch, PathsOfOtherMachinesAreFoundByName) {
  PutAll({"jpeg-exports/Coin 01.jpg", "one/two/three/d.jpg", "one/two/three/four/e.jpg"});
  EXPECT_EQ(Find("C:\\RTI\\coin\\jpeg-exports\\Coin 01.jpg"), Paths{"jpeg-exports/Coin 01.jpg"});
  EXPECT_EQ(Find("/Users/me/COIN 01.JPG"), Paths{"jpeg-exports/Coin 01.jpg"});
  EXPECT_EQ(Find("../../coin 01.jpg"), Paths{"jpeg-exports/Coin 01.jpg"});
  EXPECT_EQ(Find("d.jpg"), Paths{"one/two/three/d.jpg"});
  EXPECT_EQ(Find("e.jpg"), Paths{});
  EXPECT_EQ(Find("Coin 02.jpg"), Paths{});
  for (const char* nothing : {"", "/", "\\", ".", "..", "jpeg-exports", "C:\\"}) {
    EXPECT_EQ(Find(nothing), Paths{}) << nothing;
  }
}

TEST_F(PictureSearch, FoldersOfThePathDecideBetweenPicturesOfOneName) {
  PutAll({"Thumbs/a.jpg", "exports/a.jpg", "old/exports/a.jpg", "b/x.jpg", "c/x.jpg", "C/X.jpg"});
  EXPECT_EQ(Find("D:\\coin\\exports\\a.jpg"), Paths{"exports/a.jpg"});  // the least deep
  EXPECT_EQ(Find("D:\\coin\\old\\exports\\a.jpg"), Paths{"old/exports/a.jpg"});
  EXPECT_EQ(Find("/elsewhere/thumbs/a.jpg"), Paths{"Thumbs/a.jpg"});
  EXPECT_EQ(Find("/elsewhere/X.jpg"), Paths{"C/X.jpg"});  // the very name
  EXPECT_EQ(Find("/elsewhere/x.jpg"), (Paths{"b/x.jpg", "c/x.jpg"}));
}

TEST_F(PictureSearch, NothingOutsideTheFolderIsFound) {
  const ScratchFolder outside;
  PutText(outside.folder / "secret.jpg", "x");
  PutText(outside.folder / "other.jpg", "x");
  PutAll({"a.jpg", ".hidden/h.jpg"});
  std::filesystem::create_symlink(outside.folder / "secret.jpg", scratch_.folder / "secret.jpg");
  std::filesystem::create_directory_symlink(outside.folder, scratch_.folder / "link");
  EXPECT_EQ(Find((outside.folder / "other.jpg").string()), Paths{});
  EXPECT_EQ(Find("../" + outside.folder.filename().string() + "/other.jpg"), Paths{});
  EXPECT_EQ(Find("secret.jpg"), Paths{});
  EXPECT_EQ(Find("link/other.jpg"), Paths{});
  EXPECT_EQ(Find("other.jpg"), Paths{});
  EXPECT_EQ(Find("elsewhere/h.jpg"), Paths{});
  std::filesystem::create_symlink(scratch_.folder / "a.jpg", scratch_.folder / "inside.jpg");
  EXPECT_EQ(Find("inside.jpg"), Paths{"inside.jpg"});
}

TEST_F(PictureSearch, AFolderThatIsNotThereIsAnError) {
  ExpectErrorWith({"nowhere", "cannot be read"},
                  [&] { ListFileNames(scratch_.folder / "nowhere", 1); });
}

}  // namespace
}  // namespace lfm::testing
