// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/web_page.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "encode/glb.h"
#include "synthetic_model.h"
#include "tests/support/scratch_folder.h"
#include "viewer/page_marks.h"

namespace lfm {
namespace {

constexpr double kPlacement_abs = 1e-12;

// A turn about z by an angle of cosine 0.6 and sine 0.8.
Placement Somewhere() {
  Placement placement;
  placement.world_from_model.rotation << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
  placement.world_from_model.translation = {0.1, -200, 1e6 / 3};
  placement.scale = 1.0 / 3;
  return placement;
}

size_t CountOf(const std::string& part, const std::string& text) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

void ExpectSamePlace(const Placement& found, const Placement& expected) {
  EXPECT_LE((found.world_from_model.rotation - expected.world_from_model.rotation).norm(),
            kPlacement_abs);
  EXPECT_EQ(found.world_from_model.translation, expected.world_from_model.translation);
  EXPECT_EQ(found.scale, expected.scale);
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

TEST(WebPage, LeavesNoModelOfEarlierPagesBehind) {
  const std::string first = "one model", second = "another model", third = "a third";
  const std::vector<WebModel> models = {{first, {}}, {second, Somewhere()}, {third, Somewhere()}};
  const ScratchFolder scratch;
  const auto exists = [&](const char* name) {
    return std::filesystem::exists(scratch.folder / name);
  };
  // What lies in a folder without pages is not ours.
  WriteFileAtomically(scratch.folder / "model-2.glb", "somebody's");
  WriteWebFolder(first, "alone", scratch.folder);
  EXPECT_EQ(ReadFile(scratch.folder / "model-2.glb"), "somebody's");

  WriteWebFolder(models, "three", scratch.folder);
  WriteWebFolder(std::span(models).first(2), "two", scratch.folder);
  EXPECT_TRUE(exists("model-2.glb") && exists("scene.json"));
  EXPECT_FALSE(exists("model-3.glb"));
  WriteWebFolder(first, "alone", scratch.folder);
  EXPECT_FALSE(exists("model-2.glb") || exists("scene.json"));
  EXPECT_TRUE(exists("model.glb") && exists("index.html"));
}

TEST(WebPage, HoldsASceneWithEachFileOnce) {
  const std::string first = "one model", second = "another model", first_again = first;
  const std::vector<WebModel> models = {
      {first, {}}, {second, Somewhere()}, {first_again, Somewhere()}};
  const ScratchFolder scratch;
  WriteWebFolder(models, "a room", scratch.folder);
  EXPECT_EQ(ReadFile(scratch.folder / "model.glb"), first);
  EXPECT_EQ(ReadFile(scratch.folder / "model-2.glb"), second);
  EXPECT_FALSE(std::filesystem::exists(scratch.folder / "model-3.glb"));

  const std::vector<SceneEntry> entries = ReadSceneFile(scratch.folder / "scene.json");
  ASSERT_EQ(entries.size(), models.size());
  const char* files[] = {"model.glb", "model-2.glb", "model.glb"};
  for (size_t i = 0; i < models.size(); ++i) {
    EXPECT_EQ(entries[i].file, scratch.folder / files[i]);
    ExpectSamePlace(entries[i].placement, models[i].placement);
  }

  const std::string single = ReadFile(scratch.folder / "model.html");
  EXPECT_EQ(CountOf(Base64(first), single), 1u);
  EXPECT_EQ(CountOf(Base64(second), single), 1u);
  std::string json = ReadFile(scratch.folder / "scene.json");
  json.pop_back();
  EXPECT_EQ(CountOf("<template id=\"scene\">" + json + "</template>", single), 1u);
  EXPECT_EQ(single.find("id=\"model\""), std::string::npos);
  const std::string served = ReadFile(scratch.folder / "index.html");
  EXPECT_EQ(CountOf("content=\"scene.json\"", served), 1u);
  EXPECT_EQ(CountOf("model.glb", served), 0u);
  for (const std::string& page : {single, served}) {
    EXPECT_EQ(CountOf("<script", page), 1u);
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
    EXPECT_EQ(page.find("unsafe-"), std::string::npos);
    EXPECT_EQ(page.find("@LFM_"), std::string::npos);
  }
  EXPECT_EQ(single.find("connect-src"), std::string::npos);
}

TEST(WebPage, OfOneModelWhereItIsIsNoScene) {
  const std::string glb = "one model";
  const ScratchFolder scratch;
  WriteWebFolder(glb, "a title", scratch.folder / "model");
  WriteWebFolder(std::vector<WebModel>{{glb, {}}}, "a title", scratch.folder / "scene");
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scratch.folder / "model")) {
    const std::filesystem::path name = entry.path().filename();
    EXPECT_EQ(ReadFile(scratch.folder / "scene" / name), ReadFile(entry.path())) << name;
    ++files;
  }
  EXPECT_EQ(files, 4u);
  EXPECT_FALSE(std::filesystem::exists(scratch.folder / "scene" / "scene.json"));
  const std::string served = ReadFile(scratch.folder / "model" / "index.html");
  EXPECT_EQ(CountOf("content=\"model.glb\"", served), 1u);

  WriteWebFolder(std::vector<WebModel>{{glb, Somewhere()}}, "a title", scratch.folder / "moved");
  ExpectSamePlace(ReadSceneFile(scratch.folder / "moved" / "scene.json").at(0).placement,
                  Somewhere());
}

TEST(WebPage, RefusesWhatNoPageCouldShow) {
  const ScratchFolder scratch;
  const auto folder = scratch.folder / "web";
  const auto write = [&](const Placement& placement) {
    WriteWebFolder(std::vector<WebModel>{{"one", {}}, {"two", placement}}, "a room", folder);
  };
  EXPECT_THROW(WriteWebFolder(std::vector<WebModel>{}, "a room", folder), Error);
  EXPECT_THROW(WriteWebFolder(std::vector<WebModel>(1001, {"one", {}}), "a room", folder), Error);
  for (const double scale : {0.0, -1.0, 1e7, std::numeric_limits<double>::quiet_NaN()}) {
    Placement placement = Somewhere();
    placement.scale = scale;
    EXPECT_THROW(write(placement), Error) << scale;
  }
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  for (const double x : {2e9, -std::numeric_limits<double>::infinity(), not_a_number}) {
    Placement placement = Somewhere();
    placement.world_from_model.translation.x() = x;
    EXPECT_THROW(write(placement), Error) << x;
  }
  Placement turned = Somewhere();
  turned.world_from_model.rotation(0, 0) = not_a_number;
  EXPECT_THROW(write(turned), Error);
  EXPECT_FALSE(std::filesystem::exists(folder));
  write(Somewhere());
  EXPECT_TRUE(std::filesystem::exists(folder / "model-2.glb"));
}

}  // namespace
}  // namespace lfm
