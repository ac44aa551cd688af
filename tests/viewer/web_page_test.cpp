// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/web_page.h"

#include <gtest/gtest.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/glb.h"
#include "synthetic_model.h"
#include "tests/support/scratch_folder.h"

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

TEST(WebPage, HoldsModelAndTitleAndAsksForNothing) {
  const std::string glb = GlbBytes(MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral));
  const ScratchFolder scratch;
  const auto folder = scratch.folder / "new" / "web";
  WriteWebFolder(glb, "a <b> & \"c\"", folder);
  EXPECT_EQ(ReadFile(folder / "model.glb"), glb);
  for (const char* name : {"model.html", "index.html"}) {
    const std::string page = ReadFile(folder / name);
    EXPECT_NE(page.find("a &lt;b&gt; &amp; &quot;c&quot;"), std::string::npos) << name;
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos) << name;
    EXPECT_EQ(page.find("unsafe-"), std::string::npos) << name;
    EXPECT_EQ(page.find("@LFM_"), std::string::npos) << name;
    EXPECT_EQ(page.find("src=\"http"), std::string::npos) << name;
  }
  const std::string single = ReadFile(folder / "model.html");
  EXPECT_NE(single.find(Base64(glb)), std::string::npos);
  EXPECT_NE(single.find("script-src 'sha256-"), std::string::npos);
  EXPECT_EQ(single.find("connect-src"), std::string::npos);
  EXPECT_GT(ReadFile(folder / "app.js").size(), 100000u) << "three.js is in it";
  // Whatever a title says, the model has its place.
  WriteWebFolder(glb, "@LFM_MODEL_BASE64@", folder);
  EXPECT_NE(ReadFile(folder / "model.html").find(Base64(glb)), std::string::npos);
}

}  // namespace
}  // namespace lfm
