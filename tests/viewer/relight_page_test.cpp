// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/relight_page.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"
#include "viewer/page_marks.h"

namespace lfm {
namespace {

bool Holds(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

TEST(RelightPage, HoldsModelTitleAndCameraAndAsksForNothing) {
  const std::string lfr("any bytes \0\xff", 12);
  const ScratchFolder scratch;
  const auto folder = scratch.folder / "new" / "web";
  Eigen::Matrix3d camera;
  camera << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
  WriteRelightPages(lfr, "a <b> @LFM_CAMERA@", folder, camera);
  EXPECT_EQ(ReadFile(folder / "model.lfr"), lfr);
  for (const char* name : {"relight.html", "index.html"}) {
    const std::string page = ReadFile(folder / name);
    EXPECT_TRUE(Holds(page, "<title>a &lt;b&gt; @LFM_CAMERA@</title>")) << name;
    EXPECT_TRUE(Holds(page, "content=\"0.6 -0.8 0 0.8 0.6 0 0 0 1\"")) << name;
    EXPECT_TRUE(Holds(page, "default-src 'none'")) << name;
    EXPECT_FALSE(Holds(page, "unsafe-")) << name;
    EXPECT_FALSE(Holds(page, "src=\"http")) << name;
  }
  const std::string single = ReadFile(folder / "relight.html");
  EXPECT_TRUE(Holds(single, Base64(lfr)));
  EXPECT_TRUE(Holds(single, "script-src 'sha256-"));
  EXPECT_FALSE(Holds(single, "connect-src"));
  EXPECT_TRUE(Holds(ReadFile(folder / "index.html"), "content=\"model.lfr\""));
  EXPECT_LT(ReadFile(folder / "app.js").size(), 100000u) << "three.js is not in it";
}

TEST(RelightPage, WithoutACameraLeavesItOut) {
  const ScratchFolder scratch;
  WriteRelightPages("lfr", "a title", scratch.folder);
  for (const char* name : {"relight.html", "index.html"}) {
    const std::string page = ReadFile(scratch.folder / name);
    EXPECT_TRUE(Holds(page, "<meta name=\"camera\" content=\"\">")) << name;
    EXPECT_FALSE(Holds(page, "@LFM_")) << name;
  }
}

TEST(RelightPage, RefusesNoModelAndWhatIsNoRotation) {
  const ScratchFolder scratch;
  const auto folder = scratch.folder / "web";
  EXPECT_THROW(WriteRelightPages("", "a title", folder), Error);
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1, 1, -1).asDiagonal();
  const Eigen::Matrix3d not_finite =
      Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (const Eigen::Matrix3d& camera :
       {mirror, not_finite, Eigen::Matrix3d(1.01 * Eigen::Matrix3d::Identity())}) {
    EXPECT_THROW(WriteRelightPages("lfr", "a title", folder, camera), Error);
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

}  // namespace
}  // namespace lfm
