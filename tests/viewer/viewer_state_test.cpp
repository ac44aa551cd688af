// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "core/error.h"
#include "synthetic_model.h"

namespace lfm {
namespace {

constexpr double kMm_abs = 1e-9, kAngle_abs = 1e-12;
constexpr double kPi = std::numbers::pi;
const Eigen::Vector3d kCenter(10, -20, 80);

constexpr double kMeshRadius = 60;

TriangleMesh TestMesh() { return MakeSphere(kMeshRadius, kCenter, 2); }

ViewerState TestState() {
  return WithScene(MakeViewerState(ViewOptions()), TestMesh(), 3, ViewOptions());
}

TEST(ViewerState, StartsWithAllTermsOfTheScene) {
  const ViewerState state = TestState();
  EXPECT_EQ(state.model_terms, 3);
  EXPECT_EQ(state.terms, 3);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 3);
  EXPECT_LT(MakeGlRenderOptions(state).evaluation.term_alone, 0);
  EXPECT_FALSE(state.touched);
}

TEST(ViewerState, StartsAsTheOptionsSay) {
  ViewOptions options;
  options.terms = 2;
  options.mean_only = true;
  options.background = "ff0080";
  options.exposure = -1.5;
  options.tone = ToneCurve::kSoft;
  ViewerState state = WithScene(MakeViewerState(options), TestMesh(), 3, options);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 0);
  state = Apply(state, ViewerAction::kToggleMeanOnly);
  const GlRenderOptions drawn = MakeGlRenderOptions(state);
  EXPECT_EQ(drawn.evaluation.terms, 2);
  EXPECT_EQ(drawn.background, ParseColor("ff0080"));
  EXPECT_EQ(drawn.tone.exposure_stops, -1.5);
  EXPECT_EQ(drawn.tone.curve, ToneCurve::kSoft);

  ViewOptions alone;
  alone.term_alone = 2;
  state = WithScene(MakeViewerState(alone), TestMesh(), 3, alone);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.term_alone, 1);
  alone.term_alone = 8;  // more than there are: the last
  state = WithScene(MakeViewerState(alone), TestMesh(), 3, alone);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.term_alone, 2);
}

TEST(ViewerState, ComesAsNearToTheSmallestObjectAsToItAlone) {
  const auto least_distance = [](double smallest_radius) {
    ViewerState state =
        WithScene(MakeViewerState(ViewOptions()), TestMesh(), 3, ViewOptions(), smallest_radius);
    state.camera = Zoom(state.camera, 1e-9);
    return state.camera.distance;
  };
  const double whole = least_distance(0);
  EXPECT_NEAR(whole, OrbitCamera::kNearest * kMeshRadius, 0.01 * kMeshRadius);
  EXPECT_NEAR(least_distance(6), OrbitCamera::kNearest * 6, kMm_abs);
  EXPECT_EQ(least_distance(10 * kMeshRadius), whole);
}

TEST(ViewerState, TermsStopAtTheirLimits) {
  ViewerState state = TestState();
  state = Apply(state, ViewerAction::kMoreTerms);
  EXPECT_EQ(state.terms, 3);
  for (int i = 0; i < 5; ++i) state = Apply(state, ViewerAction::kFewerTerms);
  EXPECT_EQ(state.terms, 0);
  state = Apply(state, ViewerAction::kMoreTerms);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 1);
}

TEST(ViewerState, MeanOnlyShowsNoTermsAndComesBack) {
  ViewerState state = Apply(TestState(), ViewerAction::kToggleMeanOnly);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 0);
  EXPECT_LT(MakeGlRenderOptions(state).evaluation.term_alone, 0);
  state = Apply(state, ViewerAction::kToggleMeanOnly);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 3);
}

TEST(ViewerState, ATermAloneIsTheOneThatTermsNames) {
  ViewerState state = Apply(TestState(), ViewerAction::kToggleTermAlone);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.term_alone, 2);
  for (const int expected : {1, 0, 0}) {  // there is none before the first
    state = Apply(state, ViewerAction::kFewerTerms);
    EXPECT_EQ(MakeGlRenderOptions(state).evaluation.term_alone, expected);
  }
  state = Apply(state, ViewerAction::kToggleMeanOnly);  // one instead of the other
  EXPECT_LT(MakeGlRenderOptions(state).evaluation.term_alone, 0);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 0);
  state = Apply(TestState(), ViewerAction::kToggleTermAlone);
  state = Apply(state, ViewerAction::kToggleTermAlone);
  EXPECT_LT(MakeGlRenderOptions(state).evaluation.term_alone, 0);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 3);

  const ViewerState without = WithScene(TestState(), TestMesh(), 0, ViewOptions());
  EXPECT_LT(
      MakeGlRenderOptions(Apply(without, ViewerAction::kToggleTermAlone)).evaluation.term_alone, 0);
}

TEST(ViewerState, TogglesAndRequests) {
  ViewerState state = Apply(TestState(), ViewerAction::kToggleWireframe);
  EXPECT_EQ(MakeGlRenderOptions(state).edges, EdgeOverlay::kWireframe);
  state = Apply(state, ViewerAction::kToggleWireframe);
  EXPECT_EQ(MakeGlRenderOptions(state).edges, EdgeOverlay::kNone);
  EXPECT_TRUE(Apply(state, ViewerAction::kSaveScreenshot).save_screenshot);
  EXPECT_TRUE(Apply(state, ViewerAction::kQuit).quit);
  const struct {
    ViewerAction action;
    bool ViewerState::*member;
  } switches[] = {{ViewerAction::kTogglePanel, &ViewerState::show_panel},
                  {ViewerAction::kToggleFrameTimes, &ViewerState::show_frame_times},
                  {ViewerAction::kToggleCameras, &ViewerState::show_cameras},
                  {ViewerAction::kTogglePhotograph, &ViewerState::show_photograph}};
  for (const auto& [action, member] : switches) {
    const ViewerState once = Apply(state, action);
    EXPECT_NE(once.*member, state.*member);
    EXPECT_EQ(Apply(once, action).*member, state.*member);
    EXPECT_FALSE(once.touched);
    EXPECT_FALSE(once.quit);
  }
}

TEST(ViewerState, OverlaysGoRoundThroughAllOfThem) {
  ViewerState state = TestState();
  std::set<Overlay> visited;
  do {
    EXPECT_TRUE(visited.insert(state.overlay).second);
    state = Apply(state, ViewerAction::kNextOverlay);
  } while (state.overlay != Overlay::kNone && visited.size() < 20);
  EXPECT_EQ(visited, (std::set<Overlay>{Overlay::kNone, Overlay::kNormals, Overlay::kPhotographs,
                                        Overlay::kGuessed, Overlay::kTerms, Overlay::kPatchSizes}));
}

TEST(ViewerState, TheTapeHasTwoEndsAndBeginsAnew) {
  ViewerState state = Apply(TestState(), ViewerAction::kToggleTape);
  EXPECT_EQ(state.tool, Tool::kMeasure);
  EXPECT_FALSE(TapeLength(state));
  state = AddTapeEnd(state, {1, 2, 3});
  EXPECT_FALSE(TapeLength(state));
  state = AddTapeEnd(state, {3, 5, 9});
  ASSERT_TRUE(TapeLength(state));
  EXPECT_NEAR(*TapeLength(state), 7, kMm_abs);
  state = AddTapeEnd(state, {100, 0, 0});
  EXPECT_EQ(state.tape, (std::vector<Eigen::Vector3d>{{100, 0, 0}}));
  EXPECT_FALSE(TapeLength(state));
  state = Apply(state, ViewerAction::kToggleTape);
  EXPECT_EQ(state.tool, Tool::kPick);
  EXPECT_TRUE(state.tape.empty());
}

TEST(ViewerState, AllTermsAreShownWhereAllWereBefore) {
  const ViewOptions options;
  EXPECT_EQ(WithScene(TestState(), TestMesh(), 5, options).terms, 5);
  EXPECT_EQ(WithScene(TestState(), TestMesh(), 2, options).terms, 2);
  EXPECT_EQ(WithScene(TestState(), TestMesh(), 2, options).model_terms, 2);
  const ViewerState fewer = Apply(TestState(), ViewerAction::kFewerTerms);
  EXPECT_EQ(WithScene(fewer, TestMesh(), 5, options).terms, 2) << "chosen by the user";
  EXPECT_EQ(WithScene(fewer, TestMesh(), 1, options).terms, 1);
  const ViewerState alone = Apply(TestState(), ViewerAction::kToggleTermAlone);
  EXPECT_EQ(MakeGlRenderOptions(WithScene(alone, TestMesh(), 5, options)).evaluation.term_alone, 2);
  ViewOptions at_most_four;
  at_most_four.terms = 4;
  EXPECT_EQ(WithScene(TestState(), TestMesh(), 9, at_most_four).terms, 4);
}

TEST(ViewerState, AnUntouchedCameraFramesTheNewScene) {
  ViewOptions options;
  options.azimuth = 40;
  options.elevation = -10;
  const TriangleMesh mesh = MakeSphere(200, {500, 0, 0}, 2);
  const ViewerState state = WithScene(TestState(), mesh, 3, options);
  const OrbitCamera expected = MakeOrbitCamera(mesh, options);
  for (const OrbitCamera& camera : {state.camera, state.home}) {
    EXPECT_EQ(camera.target, expected.target);
    EXPECT_EQ(camera.distance, expected.distance);
    EXPECT_NEAR(camera.azimuth, 40 * kPi / 180, kAngle_abs);
    EXPECT_NEAR(camera.elevation, -10 * kPi / 180, kAngle_abs);
    EXPECT_EQ(camera.scene_radius, expected.scene_radius);
  }
  EXPECT_FALSE(state.touched);
}

// Larger, smaller, and elsewhere: the picture stays, home does not.
TEST(ViewerState, ATouchedCameraStaysWhereItIs) {
  ViewerState touched = TestState();
  touched.camera = Pan(Zoom(Orbit(touched.camera, 0.3, 0.2), 0.8), {20, 30}, 720);
  touched.touched = true;
  const Eigen::Vector3d eye = CameraFromWorld(touched.camera).Center();
  for (const TriangleMesh& mesh :
       {MakeSphere(2, kCenter, 2), MakeSphere(60, {300, 0, 0}, 2), MakeSphere(2000, kCenter, 2)}) {
    const ViewerState state = WithScene(touched, mesh, 3, ViewOptions());
    EXPECT_EQ(state.camera.target, touched.camera.target);
    EXPECT_EQ(CameraFromWorld(state.camera).Center(), eye);
    EXPECT_TRUE(state.touched);
    EXPECT_EQ(state.home.target, MakeOrbitCamera(mesh, ViewOptions()).target);
    EXPECT_EQ(state.camera.scene_center, state.home.scene_center);
    EXPECT_EQ(state.camera.scene_radius, state.home.scene_radius);
  }
}

TEST(ViewerState, ATouchedCameraDoesNotJumpWhenTheSceneIsOfAnotherSize) {
  ViewerState touched = TestState();
  touched.touched = true;
  for (const double radius : {2.0, 60.0, 2000.0}) {
    const ViewerState state = WithScene(touched, MakeSphere(radius, kCenter, 2), 3, ViewOptions());
    EXPECT_GE(state.camera.distance, state.camera.min_distance) << radius;
    EXPECT_LE(state.camera.distance, state.camera.max_distance) << radius;
    EXPECT_LE(Apply(state, ViewerAction::kCloser).camera.distance, state.camera.distance) << radius;
    EXPECT_GE(Apply(state, ViewerAction::kFarther).camera.distance, state.camera.distance)
        << radius;
  }
}

TEST(ViewerState, HomeIsWhereTheSceneIsFramed) {
  ViewerState state = TestState();
  const OrbitCamera home = state.camera;
  state = ApplyDrag(state, DragMode::kPan, {30, 20}, 720);
  state = ApplyDrag(state, DragMode::kOrbit, {30, 20}, 720);
  state = Apply(state, ViewerAction::kCloser);
  state.photograph = "p01";
  ASSERT_TRUE(state.touched);
  state = Apply(state, ViewerAction::kGoHome);
  EXPECT_EQ(state.camera.target, home.target);
  EXPECT_EQ(state.camera.distance, home.distance);
  EXPECT_EQ(state.camera.azimuth, home.azimuth);
  EXPECT_EQ(state.camera.elevation, home.elevation);
  EXPECT_TRUE(state.photograph.empty());
  EXPECT_FALSE(state.touched) << "the next scene is framed again";
}

TEST(ViewerState, APathGoesTheShorterWayRound) {
  ViewerState state = TestState();
  const auto add_at = [&](double azimuth_deg) {
    state.camera.azimuth = azimuth_deg * kPi / 180;
    state = Apply(state, ViewerAction::kAddPathKey);
    return state.path.keys.back().camera.azimuth * 180 / kPi;
  };
  constexpr double kDegree_abs = 1e-9;
  EXPECT_NEAR(add_at(350), 350, kDegree_abs);
  EXPECT_NEAR(add_at(10), 370, kDegree_abs);
  EXPECT_NEAR(add_at(130), 490, kDegree_abs);
  EXPECT_NEAR(add_at(250), 610, kDegree_abs) << "twice round";
  EXPECT_NEAR(add_at(130), 490, kDegree_abs) << "and back";
  EXPECT_NEAR(add_at(340), 340, kDegree_abs);
  ASSERT_EQ(state.path.keys.size(), 6u);
  for (size_t i = 1; i < 6; ++i) EXPECT_GT(state.path.keys[i].time, state.path.keys[i - 1].time);
  for (const OrbitCamera& camera : FramesOf(state.path)) {
    const double degrees = camera.azimuth * 180 / kPi;
    EXPECT_GE(degrees, 340 - kDegree_abs);
    EXPECT_LE(degrees, 610 + kDegree_abs);
  }
}

TEST(ViewerState, PathKeysAreTheCamerasThatWereThere) {
  ViewerState state = TestState();
  EXPECT_TRUE(Apply(state, ViewerAction::kRemovePathKey).path.keys.empty());
  state = Apply(state, ViewerAction::kAddPathKey);
  const OrbitCamera first = state.camera;
  state = Apply(Apply(state, ViewerAction::kCloser), ViewerAction::kTurnUp);
  state = Apply(state, ViewerAction::kAddPathKey);
  ASSERT_EQ(state.path.keys.size(), 2u);
  const std::vector<OrbitCamera> frames = FramesOf(state.path);
  EXPECT_NEAR(frames.front().distance, first.distance, kMm_abs);
  EXPECT_NEAR(frames.front().elevation, first.elevation, kAngle_abs);
  EXPECT_NEAR(frames.back().distance, state.camera.distance, kMm_abs);
  EXPECT_NEAR(frames.back().elevation, state.camera.elevation, kAngle_abs);
  state = Apply(state, ViewerAction::kRemovePathKey);
  ASSERT_EQ(state.path.keys.size(), 1u);
  EXPECT_EQ(state.path.keys[0].camera.distance, first.distance);
}

TEST(ViewOptions, SizesAreParsedStrictly) {
  EXPECT_EQ(ParsePictureSize("960x720").width, 960);
  EXPECT_EQ(ParsePictureSize("960x720").height, 720);
  for (const char* bad : {"", "x", "960", "960x", "x720", "960x720x3", "-1x5", "0x5", "5x0",
                          "1e3x5", "99999x5", "99999999999999999999x5", " 9x9", "9X9"}) {
    EXPECT_THROW(ParsePictureSize(bad), Error) << bad;
  }
}

TEST(ViewOptions, ColoursAreParsedStrictly) {
  EXPECT_LT((ParseColor("ff0080") - Eigen::Vector3f(1, 0, 128 / 255.0f)).norm(), 1e-6);
  EXPECT_EQ(ParseColor("#336699"), ParseColor("336699"));
  for (const char* bad : {"", "#", "red", "#12345", "1234567", "-12345", "##1234", "12345g"}) {
    EXPECT_THROW(ParseColor(bad), Error) << bad;
  }
}

TEST(ViewOptions, TheCameraStandsAsAsked) {
  ViewOptions options;
  options.azimuth = -30;
  options.elevation = 40;
  options.distance = 500;
  const OrbitCamera orbit = MakeOrbitCamera(TestMesh(), options);
  const Eigen::Vector3d offset = CameraFromWorld(orbit).Center() - kCenter;
  EXPECT_NEAR(offset.norm(), 500, 1.5);  // the box of an icosphere is not quite its ball's
  EXPECT_NEAR(std::atan2(offset.y(), offset.x()) * 180 / kPi, -30, 0.2);
  EXPECT_NEAR(std::asin(offset.z() / offset.norm()) * 180 / kPi, 40, 0.2);
  options.distance = 0;
  EXPECT_GT(MakeOrbitCamera(TestMesh(), options).distance, 200);
}

TEST(ViewOptions, ExposureAndCurveMakeTheTone) {
  ViewOptions options;
  EXPECT_TRUE(MakeTone(options).IsIdentity());
  options.exposure = 2.5;
  EXPECT_EQ(MakeTone(options).exposure_stops, 2.5);
  EXPECT_EQ(MakeTone(options).curve, ToneCurve::kClip);
  options.tone = ToneCurve::kSoft;
  EXPECT_EQ(MakeTone(options).curve, ToneCurve::kSoft);
}

TEST(ViewOptions, TermsAreCountedFromOne) {
  ViewOptions options;
  options.terms = 4;
  EXPECT_EQ(MakeEvaluationOptions(options).terms, 4);
  EXPECT_LT(MakeEvaluationOptions(options).term_alone, 0);
  options.term_alone = 3;
  EXPECT_EQ(MakeEvaluationOptions(options).term_alone, 2);
  options.mean_only = true;
  EXPECT_EQ(MakeEvaluationOptions(options).terms, 0);
  EXPECT_LT(MakeEvaluationOptions(options).term_alone, 0) << "the mean view is no term";
}

}  // namespace
}  // namespace lfm
