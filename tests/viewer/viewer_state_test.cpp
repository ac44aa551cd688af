// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_state.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "synthetic_model.h"

namespace lfm {
namespace {

ViewerState TestState() {
  return MakeViewerState(MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral), ViewOptions());
}

TEST(ViewerState, StartsWithAllTermsOfTheModel) {
  const ViewerState state = TestState();
  EXPECT_EQ(state.model_terms, 3);
  EXPECT_EQ(state.terms, 3);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 3);
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
  state = Apply(state, ViewerAction::kToggleMeanOnly);
  EXPECT_EQ(MakeGlRenderOptions(state).evaluation.terms, 3);
}

TEST(ViewerState, TogglesAndRequests) {
  ViewerState state = Apply(TestState(), ViewerAction::kToggleWireframe);
  EXPECT_EQ(MakeGlRenderOptions(state).edges, EdgeOverlay::kWireframe);
  state = Apply(state, ViewerAction::kToggleWireframe);
  EXPECT_EQ(MakeGlRenderOptions(state).edges, EdgeOverlay::kNone);
  EXPECT_TRUE(Apply(state, ViewerAction::kSaveScreenshot).save_screenshot);
  EXPECT_TRUE(Apply(state, ViewerAction::kQuit).quit);
  EXPECT_FALSE(Apply(state, ViewerAction::kTogglePanel).show_panel);
}

TEST(ViewerState, TheObjectFollowsThePointer) {
  const ViewerState state = TestState();
  const Camera camera = PinholeCamera(state.camera, 960, 720);
  // A point of the near side, on the axis of view.
  const Eigen::Vector3d eye = CameraFromWorld(state.camera).Center();
  const Eigen::Vector3d near_point = state.camera.target + 0.1 * (eye - state.camera.target);
  const ViewerState turned = ApplyDrag(state, DragMode::kOrbit, {30, 20}, 720);
  const Eigen::Vector2d pixel =
      Project(camera, CameraFromWorld(turned.camera) * near_point).value();
  EXPECT_GT(pixel.x(), camera.cx + 1);
  EXPECT_GT(pixel.y(), camera.cy + 1);
  const ViewerState panned = ApplyDrag(state, DragMode::kPan, {30, 20}, 720);
  const Eigen::Vector2d center =
      Project(camera, CameraFromWorld(panned.camera) * state.camera.target).value();
  EXPECT_NEAR(center.x(), camera.cx + 30, 1e-6);
  EXPECT_NEAR(center.y(), camera.cy + 20, 1e-6);
  EXPECT_EQ(ApplyDrag(state, DragMode::kOrbit, {30, 20}, 0).camera.azimuth, state.camera.azimuth);
}

TEST(ViewerState, WheelForwardsComesCloserAndResetGoesHome) {
  const ViewerState state = TestState();
  const ViewerState near = ApplyWheel(state, 2);
  EXPECT_LT(near.camera.distance, state.camera.distance);
  EXPECT_NEAR(ApplyWheel(near, -2).camera.distance, state.camera.distance, 1e-9);
  const ViewerState home = Apply(near, ViewerAction::kResetView);
  EXPECT_EQ(home.camera.distance, state.camera.distance);
  EXPECT_EQ(ApplyWheel(state, std::nan("")).camera.distance, state.camera.distance);
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
  const OrbitCamera orbit = MakeOrbitCamera(MakeSphere(60, {10, -20, 80}, 1), options);
  const Eigen::Vector3d offset = CameraFromWorld(orbit).Center() - Eigen::Vector3d(10, -20, 80);
  EXPECT_NEAR(offset.norm(), 500, 1.5);  // the box of an icosphere is not quite its ball's
  EXPECT_NEAR(std::atan2(offset.y(), offset.x()) * 180 / M_PI, -30, 0.2);
  EXPECT_NEAR(std::asin(offset.z() / offset.norm()) * 180 / M_PI, 40, 0.2);
  options.distance = 0;
  EXPECT_GT(MakeOrbitCamera(MakeSphere(60, {10, -20, 80}, 1), options).distance, 200);
}

}  // namespace
}  // namespace lfm
