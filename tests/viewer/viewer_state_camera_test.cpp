// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "synthetic_model.h"
#include "viewer/viewer_state.h"

namespace lfm {
namespace {

constexpr double kPixel_abs = 1e-6, kMm_abs = 1e-9, kAngle_abs = 1e-12;
constexpr double kPi = std::numbers::pi;
constexpr int kWidth = 960, kHeight = 720;
const Eigen::Vector3d kCenter(10, -20, 80);

TriangleMesh TestMesh() { return MakeSphere(60, kCenter, 2); }

ViewerState TestState() {
  return WithScene(MakeViewerState(ViewOptions()), TestMesh(), 3, ViewOptions());
}

Eigen::Vector3d Eye(const ViewerState& state) { return CameraFromWorld(state.camera).Center(); }
Eigen::Vector3d Axis(const OrbitCamera& camera) { return CameraFromWorld(camera).rotation.row(2); }

void ExpectSameView(const OrbitCamera& a, const OrbitCamera& b) {
  EXPECT_EQ(a.target, b.target);
  EXPECT_EQ(a.azimuth, b.azimuth);
  EXPECT_EQ(a.elevation, b.elevation);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.vertical_fov, b.vertical_fov);
}

Eigen::Vector2d PixelOf(const OrbitCamera& camera, const Eigen::Vector3d& point) {
  return Project(PinholeCamera(camera, kWidth, kHeight), CameraFromWorld(camera) * point).value();
}

ScrollInput Steps(double right, double forwards) {
  ScrollInput scroll;
  scroll.steps = {right, forwards};
  scroll.height = kHeight;
  return scroll;
}

TEST(ViewerState, TheObjectFollowsThePointer) {
  const ViewerState state = TestState();
  // A point of the near side, on the axis of view.
  const Eigen::Vector3d near_point = state.camera.target + 0.1 * (Eye(state) - state.camera.target);
  const ViewerState turned = ApplyDrag(state, DragMode::kOrbit, {30, 20}, kHeight);
  const Eigen::Vector2d middle = PixelOf(state.camera, state.camera.target);
  const Eigen::Vector2d pixel = PixelOf(turned.camera, near_point);
  EXPECT_GT(pixel.x(), middle.x() + 1);
  EXPECT_GT(pixel.y(), middle.y() + 1);
  const ViewerState panned = ApplyDrag(state, DragMode::kPan, {30, 20}, kHeight);
  EXPECT_LT((PixelOf(panned.camera, state.camera.target) - middle - Eigen::Vector2d(30, 20)).norm(),
            kPixel_abs);
  const ViewerState half_turn = ApplyDrag(state, DragMode::kOrbit, {kHeight, 0}, kHeight);
  EXPECT_NEAR(std::abs(half_turn.camera.azimuth - state.camera.azimuth), kPi, kAngle_abs);
  EXPECT_EQ(half_turn.camera.elevation, state.camera.elevation);
  for (const DragMode mode : {DragMode::kOrbit, DragMode::kPan, DragMode::kZoom}) {
    ExpectSameView(ApplyDrag(state, mode, {30, 20}, 0).camera, state.camera);
    EXPECT_FALSE(ApplyDrag(state, mode, {0, 0}, kHeight).touched);
    EXPECT_TRUE(ApplyDrag(state, mode, {30, 20}, kHeight).touched);
  }
}

TEST(ViewerState, DraggingUpwardsZoomsIn) {
  const ViewerState state = TestState();
  const ViewerState near = ApplyDrag(state, DragMode::kZoom, {50, -40}, kHeight);
  EXPECT_LT(near.camera.distance, 0.95 * state.camera.distance);
  EXPECT_EQ(near.camera.azimuth, state.camera.azimuth);
  EXPECT_EQ(near.camera.target, state.camera.target);
  const ViewerState back = ApplyDrag(near, DragMode::kZoom, {0, 40}, kHeight);
  EXPECT_NEAR(back.camera.distance, state.camera.distance, kMm_abs);
}

TEST(ViewerState, KeysTurnAndZoom) {
  const ViewerState state = TestState();
  const auto turned = [&](ViewerAction action) { return Apply(state, action).camera; };
  const double step = std::remainder(
      turned(ViewerAction::kTurnLeft).azimuth - turned(ViewerAction::kTurnRight).azimuth, 2 * kPi);
  EXPECT_GT(step, 0.02);
  EXPECT_NEAR(turned(ViewerAction::kTurnLeft).azimuth - state.camera.azimuth, step / 2, kAngle_abs);
  EXPECT_GT(turned(ViewerAction::kTurnUp).elevation, state.camera.elevation);
  EXPECT_LT(turned(ViewerAction::kTurnDown).elevation, state.camera.elevation);
  EXPECT_LT(turned(ViewerAction::kCloser).distance, state.camera.distance);
  EXPECT_GT(turned(ViewerAction::kFarther).distance, state.camera.distance);
  for (const ViewerAction action : {ViewerAction::kTurnLeft, ViewerAction::kTurnUp,
                                    ViewerAction::kCloser, ViewerAction::kFarther}) {
    EXPECT_TRUE(Apply(state, action).touched);
  }
}

TEST(ViewerState, TheWheelZoomsUnderThePointer) {
  const ViewerState state = TestState();
  for (const Eigen::Vector2d& pointer :
       {Eigen::Vector2d(0, 0), {120, 0}, {0, -90}, {-80, 130}, {200, 160}}) {
    for (const double steps : {1.0, 3.0, -1.0}) {
      const Camera camera = PinholeCamera(state.camera, kWidth, kHeight);
      const Eigen::Vector3d in_camera(pointer.x() / camera.fx, pointer.y() / camera.fy, 1);
      const Eigen::Vector3d under =
          CameraFromWorld(state.camera).Inverse() * (state.camera.distance * in_camera);
      ScrollInput scroll = Steps(0, steps);
      scroll.from_middle = pointer;
      const ViewerState zoomed = ApplyScroll(state, scroll);
      EXPECT_EQ(zoomed.camera.distance<state.camera.distance, steps> 0);
      EXPECT_LT((PixelOf(zoomed.camera, under) - PixelOf(state.camera, under)).norm(), kPixel_abs)
          << pointer.transpose() << ", " << steps << " steps";
      EXPECT_LT((Axis(zoomed.camera) - Axis(state.camera)).norm(), kAngle_abs);
      scroll.steps = -scroll.steps;
      const ViewerState back = ApplyScroll(zoomed, scroll);
      EXPECT_NEAR(back.camera.distance, state.camera.distance, kMm_abs);
      EXPECT_LT((back.camera.target - state.camera.target).norm(), kMm_abs);
      EXPECT_TRUE(back.touched);
    }
  }
}

TEST(ViewerState, AtTheNearestNothingSlides) {
  ViewerState state = TestState();
  state.camera = Zoom(state.camera, 1e-6);
  ScrollInput scroll = Steps(0, 2);
  scroll.from_middle = {150, 90};
  ExpectSameView(ApplyScroll(state, scroll).camera, state.camera);
}

bool Zooms(const ViewerState& state, const ScrollInput& scroll) {
  const ViewerState after = ApplyScroll(state, scroll);
  const bool zooms = after.camera.distance != state.camera.distance;
  const bool turns = after.camera.azimuth != state.camera.azimuth ||
                     after.camera.elevation != state.camera.elevation;
  EXPECT_NE(zooms, turns);
  EXPECT_TRUE(zooms || after.camera.target == state.camera.target);
  return zooms;
}

TEST(ViewerState, ATrackpadTurnsOnceItHasScrolledAsTrackpadsDo) {
  const ViewerState state = TestState();
  EXPECT_TRUE(Zooms(state, Steps(0, 1)));
  EXPECT_FALSE(ApplyScroll(state, Steps(0, -3)).trackpad_seen);
  for (const ScrollInput& trackpad : {Steps(0, 0.4), Steps(0, -1.5), Steps(1, 0), Steps(-1, 2)}) {
    EXPECT_FALSE(Zooms(state, trackpad));
    const ViewerState seen = ApplyScroll(state, trackpad);
    EXPECT_TRUE(seen.trackpad_seen);
    EXPECT_FALSE(Zooms(seen, Steps(0, 1))) << "whole steps may be a trackpad's as well";
  }
}

TEST(ViewerState, ScrollingDoesWhatWasChosen) {
  ViewerState state = TestState();
  state.scrolling = Scrolling::kZooms;
  EXPECT_TRUE(Zooms(state, Steps(0, 0.4)));
  EXPECT_TRUE(Zooms(ApplyScroll(state, Steps(0.5, 0.4)), Steps(0, 1)));
  state.scrolling = Scrolling::kTurns;
  EXPECT_FALSE(Zooms(state, Steps(0, 1)));
  EXPECT_FALSE(Zooms(state, Steps(0.5, 0)));
}

TEST(ViewerState, WithShiftScrollingPansAndWithCtrlItZooms) {
  for (const Scrolling scrolling : {Scrolling::kAutomatic, Scrolling::kZooms, Scrolling::kTurns}) {
    for (const bool trackpad_seen : {false, true}) {
      ViewerState state = TestState();
      state.scrolling = scrolling;
      state.trackpad_seen = trackpad_seen;
      ScrollInput shift = Steps(0.5, 1);
      shift.shift = true;
      const ViewerState panned = ApplyScroll(state, shift);
      EXPECT_EQ(panned.camera.distance, state.camera.distance);
      EXPECT_EQ(panned.camera.azimuth, state.camera.azimuth);
      EXPECT_EQ(panned.camera.elevation, state.camera.elevation);
      EXPECT_GT((panned.camera.target - state.camera.target).norm(), 1);
      ScrollInput ctrl = Steps(0, 0.3);
      ctrl.ctrl = true;
      EXPECT_TRUE(Zooms(state, ctrl));
    }
  }
}

TEST(ViewerState, WhatIsNotANumberMovesNothing) {
  const ViewerState state = TestState();
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    for (const ScrollInput& scroll : {Steps(0, bad), Steps(bad, 0), Steps(bad, 1)}) {
      const ViewerState after = ApplyScroll(state, scroll);
      ExpectSameView(after.camera, state.camera);
      EXPECT_FALSE(after.touched);
      EXPECT_FALSE(after.trackpad_seen);
    }
    ScrollInput nowhere = Steps(0, 1);
    nowhere.from_middle = {bad, 3};
    EXPECT_EQ(ApplyScroll(state, nowhere).camera.target, state.camera.target);
    for (const DragMode mode : {DragMode::kOrbit, DragMode::kPan, DragMode::kZoom}) {
      ExpectSameView(ApplyDrag(state, mode, {bad, bad}, kHeight).camera, state.camera);
    }
  }
  ExpectSameView(ApplyScroll(state, Steps(0, 0)).camera, state.camera);
  ScrollInput minimised = Steps(0, 1);
  minimised.height = 0;
  ExpectSameView(ApplyScroll(state, minimised).camera, state.camera);
}

TEST(ViewerState, FocusIsSeenFromTheSameDirectionAndDistance) {
  ViewerState state = TestState();
  state.photograph = "p01";
  const Eigen::Vector3d point(30, -5, 110);
  const ViewerState focused = FocusOn(state, point);
  EXPECT_EQ(focused.camera.target, point);
  EXPECT_LT((Axis(focused.camera) - Axis(state.camera)).norm(), kAngle_abs);
  EXPECT_NEAR((Eye(focused) - point).norm(), state.camera.distance, kMm_abs);
  EXPECT_TRUE(focused.touched);
  EXPECT_TRUE(focused.photograph.empty());
  ViewerState near = focused;
  for (int i = 0; i < 100; ++i) near = Apply(near, ViewerAction::kCloser);
  EXPECT_LT(near.camera.distance, state.camera.min_distance / 2) << "than to a whole scene";
  EXPECT_GT(near.camera.distance, 0);
  EXPECT_EQ(near.camera.target, point);
}

/// A camera that stands and looks somehow; its picture is that of PinholeCamera's form.
Camera PhotographCamera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 1100;
  camera.cx = (kWidth - 1) / 2.0;
  camera.cy = (kHeight - 1) / 2.0;
  return camera;
}

TEST(OrbitLike, AnUprightCameraAimedAtTheMiddleShowsTheSamePicture) {
  const OrbitCamera scene = TestState().camera;
  const Camera camera = PhotographCamera();
  for (const Eigen::Vector3d& offset : {Eigen::Vector3d(300, 0, 0),
                                        {-120, 200, 150},
                                        {50, -250, -180},
                                        {0, -90, 10},  // nearer than an orbit comes
                                        {0, 20, 900}}) {
    const Pose pose = LookAt(kCenter + offset, kCenter, Eigen::Vector3d::UnitZ());
    const OrbitCamera orbit = OrbitLike(camera, pose, scene);
    const Camera shown = PinholeCamera(orbit, kWidth, kHeight);
    if (offset.norm() > scene.min_distance) {
      EXPECT_LT((orbit.target - kCenter).norm(), kMm_abs) << "turns about the middle";
    }
    for (const Eigen::Vector3d& point : TestMesh().vertices) {
      const auto expected = Project(camera, pose * point);
      const auto pixel = Project(shown, CameraFromWorld(orbit) * point);
      ASSERT_EQ(expected.has_value(), pixel.has_value()) << offset.transpose();
      if (!expected) continue;
      EXPECT_LT((*pixel - *expected).norm(), kPixel_abs) << offset.transpose();
    }
  }
}

TEST(OrbitLike, HasTheEyeAndTheDirectionOfAnyCamera) {
  const OrbitCamera scene = TestState().camera;
  const struct {
    Eigen::Vector3d eye, target, up;
  } cases[] = {{{300, 0, 0}, {0, 40, 90}, {0, 0.4, 1}},        // rolled, past the middle
               {{-50, 400, 20}, kCenter, {1, 0, 0.1}},         // on its side
               {{200, 200, 200}, {400, 400, 210}, {0, 0, 1}},  // looks away
               {{20, -10, 85}, {20, 70, 60}, {0, 0, 1}},       // inside
               {{4e5, 2e5, 1e4}, kCenter, {0, 0, 1}}};         // farther than an orbit goes
  for (const auto& [eye, target, up] : cases) {
    const Pose pose = LookAt(eye, target, up);
    const OrbitCamera orbit = OrbitLike(PhotographCamera(), pose, scene);
    EXPECT_LT((CameraFromWorld(orbit).Center() - eye).norm(), kMm_abs * eye.norm());
    EXPECT_LT((Axis(orbit) - pose.rotation.row(2).transpose()).norm(), 1e-9);
    EXPECT_GE(orbit.distance, scene.min_distance);
    EXPECT_LE(orbit.distance, scene.max_distance);
    EXPECT_GE(orbit.azimuth, 0);
    EXPECT_LT(orbit.azimuth, 2 * kPi);
    EXPECT_NEAR(std::tan(orbit.vertical_fov / 2), kHeight / 2.0 / 1100, kAngle_abs);
  }
}

TEST(OrbitLike, StopsAtTheSteepestOrbit) {
  const OrbitCamera scene = TestState().camera;
  const Pose above = LookAt(kCenter + Eigen::Vector3d(0, 0, 400), kCenter, {0, 1, 0});
  const OrbitCamera orbit = OrbitLike(PhotographCamera(), above, scene);
  constexpr double kDegree = kPi / 180;
  EXPECT_LE(orbit.elevation, OrbitCamera::kMaxElevation);
  EXPECT_GT(-Axis(orbit).z(), std::cos(1.01 * kDegree));
  EXPECT_LT((CameraFromWorld(orbit).Center() - above.Center()).norm(), 400 * 1.01 * kDegree);
}

}  // namespace
}  // namespace lfm
