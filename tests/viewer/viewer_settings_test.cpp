// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "core/error.h"
#include "synthetic_model.h"

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kAngle_abs = 1e-12, kMm_abs = 1e-9;

ViewerState TestState() {
  const ViewOptions options;
  ViewerState state =
      WithScene(MakeViewerState(options), MakeSphere(60, {10, -20, 80}, 1), 5, options);
  state.models = {{"bust", "bust.glb"}, {"vase", "vase.glb"}};
  return state;
}

struct SettingCase {
  const char* setting;
  std::function<bool(const ViewerState&)> holds;  ///< not before it was set
};

std::vector<SettingCase> Cases() {
  using S = ViewerState;
  const auto azimuth = [](double degrees) {
    return [=](const S& s) {
      return std::abs(std::remainder(s.camera.azimuth - degrees * kDegree, 2 * std::numbers::pi)) <
                 kAngle_abs &&
             s.touched;
    };
  };
  return {
      {"terms 2", [](const S& s) { return s.terms == 2; }},
      {"terms 0", [](const S& s) { return s.terms == 0; }},
      {"show mean", [](const S& s) { return s.shown == ShownTerms::kMeanView; }},
      {"show term-alone", [](const S& s) { return s.shown == ShownTerms::kOneAlone; }},
      {"overlay normals", [](const S& s) { return s.overlay == Overlay::kNormals; }},
      {"overlay photographs", [](const S& s) { return s.overlay == Overlay::kPhotographs; }},
      {"overlay guessed", [](const S& s) { return s.overlay == Overlay::kGuessed; }},
      {"overlay terms", [](const S& s) { return s.overlay == Overlay::kTerms; }},
      {"overlay patch-sizes", [](const S& s) { return s.overlay == Overlay::kPatchSizes; }},
      {"edges on", [](const S& s) { return s.edges == EdgeOverlay::kWireframe; }},
      {"view-coordinates vertex",
       [](const S& s) { return s.view_coordinates == ViewCoordinates::kPerVertex; }},
      {"view-coordinates corner-maps",
       [](const S& s) { return s.view_coordinates == ViewCoordinates::kMapsAtCorners; }},
      {"passes paper", [](const S& s) { return s.passes == Passes::kPaper; }},
      {"passes paper-unsigned", [](const S& s) { return s.passes == Passes::kPaperUnsigned; }},
      {"exposure -2.5", [](const S& s) { return s.tone.exposure_stops == -2.5; }},
      {"exposure 10", [](const S& s) { return s.tone.exposure_stops == 10; }},
      {"tone soft", [](const S& s) { return s.tone.curve == ToneCurve::kSoft; }},
      {"background ff0080", [](const S& s) { return s.background == ParseColor("ff0080"); }},
      {"background #336699", [](const S& s) { return s.background == ParseColor("336699"); }},
      {"azimuth 40.5", azimuth(40.5)},
      {"azimuth -30", azimuth(330)},
      {"azimuth 765", azimuth(45)},
      {"elevation -45",
       [](const S& s) { return std::abs(s.camera.elevation + 45 * kDegree) < kAngle_abs; }},
      {"elevation 89", [](const S& s) { return s.camera.elevation > 88.9 * kDegree; }},
      {"distance 400", [](const S& s) { return std::abs(s.camera.distance - 400) < kMm_abs; }},
      {"distance 1", [](const S& s) { return s.camera.distance == s.camera.min_distance; }},
      {"photograph a photo.jpg", [](const S& s) { return s.photograph == "a photo.jpg"; }},
      {"compare on", [](const S& s) { return s.show_photograph; }},
      {"cameras on", [](const S& s) { return s.show_cameras; }},
      {"measure on", [](const S& s) { return s.tool == Tool::kMeasure; }},
      {"scrolling zooms", [](const S& s) { return s.scrolling == Scrolling::kZooms; }},
      {"scrolling turns", [](const S& s) { return s.scrolling == Scrolling::kTurns; }},
      {"panel off", [](const S& s) { return !s.show_panel; }},
      {"frame-times on", [](const S& s) { return s.show_frame_times; }},
      {"add-dropped on", [](const S& s) { return s.add_dropped; }},
      {"turntable 7",
       [](const S& s) { return s.turntable_frames == 7 && s.film == Film::kTurntable; }},
      {"film turntable", [](const S& s) { return s.film == Film::kTurntable && !s.stop_film; }},
      {"film path", [](const S& s) { return s.film == Film::kPath && !s.stop_film; }},
      {"place 2 100 0 -5 10 20.5 90 0.5",
       [](const S& s) {
         const ShownModel& vase = s.models[1];
         return vase.translation == Eigen::Vector3d(100, 0, -5) &&
                vase.angles_deg == Eigen::Vector3d(10, 20.5, 90) && vase.scale == 0.5 &&
                vase.name == "vase" && s.models[0] == ShownModel{"bust", "bust.glb"};
       }},
      {"save screenshot", [](const S& s) { return s.save_screenshot; }},
      {"save path", [](const S& s) { return s.save_path; }},
      {"save scene", [](const S& s) { return s.save_scene; }},
      {"film none", [](const S& s) { return s.film == Film::kNone && s.stop_film; }},
  };
}

std::string NameOf(const std::string& setting) { return setting.substr(0, setting.find(' ')); }

TEST(ViewerSettings, EveryOneHasTheEffectItShould) {
  std::set<std::string> tried;
  for (const auto& [setting, holds] : Cases()) {
    const ViewerState before = TestState();
    EXPECT_FALSE(holds(before)) << setting;
    EXPECT_TRUE(holds(SetByName(before, setting))) << setting;
    tried.insert(NameOf(setting));
  }
  const std::vector<std::string> names = SettingNames();
  EXPECT_EQ(tried, std::set<std::string>(names.begin(), names.end()));
  EXPECT_EQ(tried.size(), names.size()) << "each once";
}

TEST(ViewerSettings, EveryOneCanBeTakenBack) {
  for (const auto& [there, back] : std::vector<std::pair<std::string, std::string>>{
           {"show mean", "show all"},
           {"overlay terms", "overlay none"},
           {"edges on", "edges off"},
           {"view-coordinates vertex", "view-coordinates pixel"},
           {"passes paper", "passes one"},
           {"tone soft", "tone clip"},
           {"exposure 3", "exposure 0"},
           {"photograph p01", "photograph none"},
           {"compare on", "compare off"},
           {"cameras on", "cameras off"},
           {"measure on", "measure off"},
           {"scrolling turns", "scrolling automatic"},
           {"panel off", "panel on"},
           {"frame-times on", "frame-times off"},
           {"add-dropped on", "add-dropped off"}}) {
    const ViewerState state = SetByName(TestState(), there);
    int holding = 0;
    for (const SettingCase& tried : Cases()) {
      if (NameOf(tried.setting) != NameOf(there)) continue;
      EXPECT_FALSE(tried.holds(SetByName(state, back))) << back << " is not " << tried.setting;
      ++holding;
    }
    EXPECT_GT(holding, 0) << there;
  }
}

TEST(ViewerSettings, ChangeNothingElse) {
  for (const auto& [setting, holds] : Cases()) {
    const ViewerState after = SetByName(TestState(), setting);
    for (const SettingCase& other : Cases()) {
      if (NameOf(other.setting) == NameOf(setting)) continue;
      // The length of a turntable starts it.
      if (NameOf(setting) == "turntable" && NameOf(other.setting) == "film") continue;
      EXPECT_FALSE(other.holds(after)) << setting << " changed " << other.setting;
    }
  }
}

TEST(ViewerSettings, TermsAreNoMoreThanTheModelHas) {
  EXPECT_EQ(SetByName(TestState(), "terms 5").terms, 5);
  EXPECT_EQ(SetByName(TestState(), "terms 1024").terms, 5);
}

TEST(ViewerSettings, TheCameraLeavesThePhotographAndCountsAsTouched) {
  ViewerState state = TestState();
  for (const char* setting : {"azimuth 10", "elevation 10", "distance 300"}) {
    state.photograph = "p01";
    const ViewerState moved = SetByName(state, setting);
    EXPECT_TRUE(moved.photograph.empty()) << setting;
    EXPECT_TRUE(moved.touched) << setting;
  }
  EXPECT_FALSE(SetByName(state, "exposure 1").touched);
}

TEST(ViewerSettings, MeasuringBeginsWithoutATape) {
  ViewerState state = TestState();
  state.tape = {{1, 2, 3}, {4, 5, 6}};
  EXPECT_TRUE(SetByName(state, "measure on").tape.empty());
  EXPECT_TRUE(SetByName(state, "measure off").tape.empty());
}

/// The message has all of `parts`, in one line.
void ExpectRefused(const std::string& setting, const std::vector<std::string>& parts) {
  try {
    SetByName(TestState(), setting);
    ADD_FAILURE() << "accepted: " << setting;
  } catch (const Error& error) {
    const std::string message = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' in: " << message;
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << message;
  }
}

TEST(ViewerSettings, BadValuesAreRefusedWithWhatIsPossible) {
  const std::map<std::string, std::vector<std::string>> possible = {
      {"terms", {"from 0 to 1024"}},
      {"show", {"all", "mean", "term-alone"}},
      {"overlay", {"none", "normals", "photographs", "guessed", "terms", "patch-sizes"}},
      {"edges", {"off or on"}},
      {"view-coordinates", {"pixel", "vertex", "corner-maps"}},
      {"passes", {"one", "paper", "paper-unsigned"}},
      {"exposure", {"from -10 to 10"}},
      {"tone", {"clip", "soft"}},
      {"background", {"rrggbb"}},
      {"azimuth", {"from -3600 to 3600"}},
      {"elevation", {"from -89 to 89"}},
      {"distance", {"from 1e-06 to 1e+09"}},
      {"compare", {"off or on"}},
      {"cameras", {"off or on"}},
      {"measure", {"off or on"}},
      {"scrolling", {"automatic", "zooms", "turns"}},
      {"panel", {"off or on"}},
      {"frame-times", {"off or on"}},
      {"add-dropped", {"off or on"}},
      {"turntable", {"from 1 to 100000"}},
      {"film", {"none", "turntable", "path"}},
      {"place", {"number"}},
      {"save", {"screenshot", "path", "scene"}},
  };
  for (const std::string& name : SettingNames()) {
    if (name == "photograph") continue;  // any text may be one's id
    ASSERT_TRUE(possible.contains(name)) << name;
    std::vector<std::string> parts = possible.at(name);
    parts.push_back("'" + name + "'");
    for (const char* value : {"chartreuse", "1x", "", " ", "nan", "inf", "-inf", "99999999999"}) {
      parts.push_back("'" + std::string(value) + "'");
      ExpectRefused(name + " " + value, parts);
      parts.pop_back();
    }
    ExpectRefused(name, parts);
  }
}

TEST(ViewerSettings, NumbersStayInTheirRanges) {
  for (const char* setting :
       {"terms -1", "terms 1025", "exposure 10.01", "exposure -10.01", "azimuth 3601",
        "azimuth -3601", "elevation 89.5", "elevation -89.5", "distance 0", "distance -5",
        "distance 2e9", "turntable 0", "turntable 100001", "exposure 1 2", "exposure  1",
        "exposure 0x1", "exposure 1,5"}) {
    ExpectRefused(setting, {"number from"});
  }
}

TEST(ViewerSettings, OnlyModelsThatAreThereArePlaced) {
  for (const char* setting :
       {"place 0 0 0 0 0 0 0 1", "place 3 0 0 0 0 0 0 1", "place 1.5 0 0 0 0 0 0 1",
        "place -1 0 0 0 0 0 0 1", "place 1 0 0 0 0 0 0", "place 1 0 0 0 0 0 0 1 1",
        "place 1 0 0 0 0 0 0 0", "place 1 0 0 0 0 0 0 -2"}) {
    ExpectRefused(setting, {"eight numbers", "2", "mm", "degrees", "scale"});
  }
  ExpectRefused("place 1 nan 0 0 0 0 0 1", {"number"});
}

TEST(ViewerSettings, UnknownNamesAreRefusedWithThoseThatAreKnown) {
  for (const char* setting : {"colour red", "Terms 2", "", " ", " terms 2", "term 2", "terms\t2"}) {
    ExpectRefused(setting, SettingNames());
  }
}

TEST(StateToJson, HoldsWhatIsShown) {
  ViewerState state = SetByName(SetByName(TestState(), "azimuth 75"), "elevation -20");
  state = SetByName(SetByName(state, "distance 321"), "terms 4");
  state.camera.target = {1, -2, 3.5};
  state.photograph = "p07";
  state.message = "saved a.png";
  state.tape = {{1, 2, 3}};
  ViewerStatus status;
  status.models = {"bust", "vase"};
  status.triangles = 12345;
  status.passes = 7;
  status.error = "cannot open c.glb";
  status.legend = {{{1, 0, 0}, "0 terms"}, {{0, 1, 0}, "3 terms"}};
  nlohmann::json json = StateToJson(state, status);
  constexpr double kDegree_abs = 1e-9;
  EXPECT_NEAR(json.at("azimuth").get<double>(), 75, kDegree_abs);
  EXPECT_NEAR(json.at("elevation").get<double>(), -20, kDegree_abs);
  EXPECT_NEAR(json.at("distance").get<double>(), 321, kMm_abs);
  EXPECT_EQ(json.at("target"), nlohmann::json({1.0, -2.0, 3.5}));
  EXPECT_EQ(json.at("terms"), 4);
  EXPECT_EQ(json.at("model_terms"), 5);
  EXPECT_EQ(json.at("models"), nlohmann::json({"bust", "vase"}));
  EXPECT_EQ(json.at("triangles"), 12345);
  EXPECT_EQ(json.at("passes"), 7);
  EXPECT_EQ(json.at("photograph"), "p07");
  EXPECT_EQ(json.at("message"), "saved a.png");
  EXPECT_EQ(json.at("error"), "cannot open c.glb");
  EXPECT_EQ(json.at("legend"), nlohmann::json({"0 terms", "3 terms"}));
  EXPECT_EQ(json.at("tape").size(), 1u);
  EXPECT_EQ(json.at("tape").at(0), nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_FALSE(json.contains("tape_mm")) << "one end has no length";
  EXPECT_FALSE(json.contains("photograph_psnr_db")) << "nothing was compared";

  state.tape.push_back({3, 5, 9});
  status.photograph_psnr_db = 38.25;
  json = StateToJson(state, status);
  EXPECT_NEAR(json.at("tape_mm").get<double>(), 7, kMm_abs);
  EXPECT_EQ(json.at("tape").size(), 2u);
  EXPECT_EQ(json.at("photograph_psnr_db"), 38.25);
}

TEST(StateToJson, HasListsWhereThereIsNothing) {
  const nlohmann::json json = StateToJson(TestState(), {});
  for (const char* list : {"models", "tape", "legend"}) {
    EXPECT_TRUE(json.at(list).is_array()) << list;
    EXPECT_TRUE(json.at(list).empty()) << list;
  }
  EXPECT_EQ(json.at("error"), "");
  EXPECT_EQ(json.at("photograph"), "");
}

}  // namespace
}  // namespace lfm
