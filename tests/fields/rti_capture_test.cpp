// SPDX-License-Identifier: BSD-3-Clause
#include "fields/rti_capture.h"

#include <gtest/gtest.h>

#include <string>

#include "fields/lit_pictures.h"
#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

class RtiCapture : public ::testing::Test {
 protected:
  Capture Open(const std::string& file, const FieldCaptureOptions& options = {}) {
    return OpenLpCapture(scratch_.folder / file, options, progress_);
  }
  std::filesystem::path At(const std::string& file) { return scratch_.folder / file; }

  ScratchFolder scratch_;
  NotedProgress progress_;
};

TEST_F(RtiCapture, IsOneOfAReflectanceFieldInThePicturesFrame) {
  PutGray(At("jpeg-exports/a 1.jpg"), 5, 3, 10);
  PutGray(At("jpeg-exports/a 2.jpg"), 5, 3, 20);
  PutText(At("coin.lp"), "2\r\nC:\\x\\jpeg-exports\\a 1.jpg 0 0 1\r\nC:\\x\\a 2.jpg 0.6 0 0.8\r\n");
  const Capture capture = Open("coin.lp", {.encoding = ColorEncoding::kSrgb});
  EXPECT_EQ(capture.name, "coin");
  ASSERT_TRUE(capture.reflectance_field.has_value());
  const ReflectanceField& field = *capture.reflectance_field;
  EXPECT_FALSE(field.camera_from_world.has_value());
  EXPECT_EQ(field.encoding, ColorEncoding::kSrgb);
  ASSERT_EQ(field.pictures.size(), 2u);
  EXPECT_EQ(field.pictures[0].file, "jpeg-exports/a 1.jpg");
  EXPECT_EQ(field.pictures[1].file, "jpeg-exports/a 2.jpg");
  EXPECT_LT((field.pictures[1].to_light - Eigen::Vector3d(0.6, 0, 0.8)).norm(), 1e-15);
  EXPECT_EQ(capture.cameras.at(field.camera).width, 5);
  EXPECT_EQ(capture.cameras.at(field.camera).height, 3);
  EXPECT_EQ(progress_.notes(), "");
}

TEST_F(RtiCapture, BecomesAManifestThatLoads) {
  PutGray(At("a.png"), 2, 2, 10);
  PutText(At("coin.lp"), "1\na.png 0.1 0.2 0.9\n");
  const Capture capture = Open("coin.lp");
  SaveCapture(capture);
  const Capture loaded = LoadCapture(scratch_.folder);
  EXPECT_LT((loaded.reflectance_field->pictures.at(0).to_light -
             capture.reflectance_field->pictures.at(0).to_light)
                .norm(),
            1e-15);
}

TEST_F(RtiCapture, PicturesOfRtiBuilderLieBesideItsAssemblyFiles) {
  PutGray(At("coin/jpeg-exports/a.jpg"), 2, 2, 10);
  PutText(At("coin/assembly-files/coin.lp"), "1\nD:\\rti\\coin\\jpeg-exports\\a.jpg 0 0 1\n");
  const Capture capture = Open("coin/assembly-files/coin.lp");
  EXPECT_EQ(capture.reflectance_field->pictures.at(0).file, "jpeg-exports/a.jpg");
  EXPECT_EQ(MakeImageLoader(capture)("jpeg-exports/a.jpg").width(), 2);
}

TEST_F(RtiCapture, EveryEighthLightIsHeldOutUnlessStated) {
  for (int i = 0; i < 17; ++i) PutGray(At(std::to_string(i) + ".png"), 1, 1, 10);
  std::string text = "17\n";
  for (int i = 0; i < 17; ++i) text += std::to_string(i) + ".png 0 0 1\n";
  PutText(At("a.lp"), text);
  const auto held_out = [&](int every) {
    std::vector<size_t> lights;
    const Capture capture = Open("a.lp", {.held_out_lights = every});
    const std::vector<LitPicture>& pictures = capture.reflectance_field->pictures;
    for (size_t i = 0; i < pictures.size(); ++i) {
      if (pictures[i].split == PhotoSplit::kTest) lights.push_back(i);
    }
    return lights;
  };
  EXPECT_EQ(held_out(FieldCaptureOptions{}.held_out_lights), (std::vector<size_t>{7, 15}));
  EXPECT_EQ(held_out(0), std::vector<size_t>{});
  EXPECT_EQ(held_out(100), std::vector<size_t>{});
  EXPECT_EQ(held_out(9), std::vector<size_t>{8});
  ExpectErrorWith({"a.lp", "held-out-lights"}, [&] { Open("a.lp", {.held_out_lights = 1}); });
}

TEST_F(RtiCapture, PositionsAreNoted) {
  PutGray(At("a.png"), 1, 1, 10);
  PutGray(At("b.png"), 1, 1, 10);
  PutText(At("a.lp"), "2\na.png 0 300 400\nb.png 0 0 1\n");
  const Capture capture = Open("a.lp");
  EXPECT_NE(progress_.notes().find("1 of 2 lights are no unit vectors"), std::string::npos);
  EXPECT_LT((capture.reflectance_field->pictures[0].to_light - Eigen::Vector3d(0, 0.6, 0.8)).norm(),
            1e-15);
}

TEST_F(RtiCapture, MissingPicturesAreNamedAFewAtMost) {
  PutGray(At("a.png"), 1, 1, 10);
  PutText(At("a.lp"),
          "6\na.png 0 0 1\nb.png 0 0 1\nc.png 0 0 1\nd.png 0 0 1\ne.png 0 0 1\n"
          "f.png 0 0 1\n");
  ExpectErrorWith(
      {"a.lp", "missing", "'b.png', 'c.png', 'd.png' and 2 more", scratch_.folder.string()},
      [&] { Open("a.lp"); });
}

TEST_F(RtiCapture, PicturesThatCannotBeToldApartAreErrors) {
  PutGray(At("x/a.png"), 1, 1, 10);
  PutText(At("twice.lp"), "2\nx/a.png 0 0 1\n/other/A.PNG 1 0 0\n");
  ExpectErrorWith({"twice.lp", "line 3", "'x/a.png'", "line 2"}, [&] { Open("twice.lp"); });
  PutGray(At("y/a.png"), 1, 1, 10);
  PutText(At("either.lp"), "1\n/other/a.png 0 0 1\n");
  ExpectErrorWith({"either.lp", "line 2", "'x/a.png', 'y/a.png'"}, [&] { Open("either.lp"); });
}

TEST_F(RtiCapture, NothingOutsideItsFolderIsRead) {
  PutGray(At("secret.png"), 1, 1, 10);
  PutText(At("in/a.lp"), "1\n../secret.png 0 0 1\n");
  ExpectErrorWith({"missing", "secret.png"}, [&] { Open("in/a.lp"); });
  PutText(At("in/b.lp"), "1\n" + At("secret.png").string() + " 0 0 1\n");
  ExpectErrorWith({"missing", "secret.png"}, [&] { Open("in/b.lp"); });
}

TEST_F(RtiCapture, AFirstPictureThatIsNoneIsNamed) {
  PutText(At("a.png"), "no picture");
  PutText(At("a.lp"), "1\na.png 0 0 1\n");
  ExpectErrorWith({"a.png"}, [&] { Open("a.lp"); });
}

TEST(LitPictures, SomeNamesAreListed) {
  EXPECT_EQ(SomeNames({"a"}), "'a'");
  EXPECT_EQ(SomeNames({"a", "b", "c"}), "'a', 'b', 'c'");
  EXPECT_EQ(SomeNames({"a", "b", "c", "d"}), "'a', 'b', 'c' and 1 more");
}

}  // namespace
}  // namespace lfm::testing
