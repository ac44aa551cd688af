// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_state.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {
namespace {

constexpr double kZoomPerScrollStep = 0.9;
constexpr double kPixelsPerScrollStep = 30;
constexpr double kTurnPerKey = 5 * std::numbers::pi / 180;
constexpr double kPathKeySeconds = 2;
constexpr double kNearestToPoint = 0.05;  // of the scene's radius
constexpr double kWholeStepTolerance = 1e-3;

ViewerState Moved(ViewerState state, const OrbitCamera& camera) {
  state.camera = camera;
  state.touched = true;
  state.photograph.clear();
  return state;
}

// The point under the pointer, as far away as the target, stays there.
OrbitCamera ZoomTowards(const OrbitCamera& camera, double factor,
                        const Eigen::Vector2d& from_middle, int height) {
  const OrbitCamera zoomed = Zoom(camera, factor);
  const double done = zoomed.distance / camera.distance;
  return Pan(zoomed, from_middle * (1 - 1 / done), height);
}

ShownTerms Toggled(ShownTerms shown, ShownTerms wanted) {
  return shown == wanted ? ShownTerms::kUpTo : wanted;
}

Overlay Next(Overlay overlay) {
  return overlay == Overlay::kPatchSizes ? Overlay::kNone
                                         : static_cast<Overlay>(static_cast<int>(overlay) + 1);
}

ViewerState WithPathKey(ViewerState state) {
  const double time = state.path.keys.empty() ? 0 : state.path.keys.back().time + kPathKeySeconds;
  OrbitCamera camera = state.camera;
  if (!state.path.keys.empty()) {  // the shorter way round from the key before
    const double before = state.path.keys.back().camera.azimuth, turn = 2 * std::numbers::pi;
    camera.azimuth = before + std::remainder(camera.azimuth - before, turn);
  }
  state.path.keys.push_back({time, camera});
  const size_t places = state.path.keys.size();
  state.message = "camera path: " + std::to_string(places) + (places == 1 ? " place" : " places");
  return state;
}

}  // namespace

ViewerState MakeViewerState(const ViewOptions& options) {
  ViewerState state;
  state.terms = state.model_terms = std::max(options.terms, 0);
  state.shown = options.mean_only        ? ShownTerms::kMeanView
                : options.term_alone > 0 ? ShownTerms::kOneAlone
                                         : ShownTerms::kUpTo;
  if (state.shown == ShownTerms::kOneAlone) state.terms = options.term_alone;
  state.background = ParseColor(options.background);
  state.tone = MakeTone(options);
  return state;
}

ViewerState WithScene(ViewerState state, const TriangleMesh& mesh, int terms,
                      const ViewOptions& options, double smallest_radius) {
  const bool all = state.terms >= state.model_terms && state.shown != ShownTerms::kOneAlone;
  state.model_terms = terms;
  state.terms = std::clamp(all ? std::min(terms, options.terms) : state.terms, 0, terms);
  state.home = MakeOrbitCamera(mesh, options);
  if (smallest_radius > 0) {
    state.home.min_distance =
        std::min(state.home.min_distance, OrbitCamera::kNearest * smallest_radius);
  }
  if (!state.touched) {
    state.camera = state.home;
  } else {
    state.camera.scene_center = state.home.scene_center;
    state.camera.scene_radius = state.home.scene_radius;
    state.camera.min_distance =
        std::min({state.camera.min_distance, state.home.min_distance, state.camera.distance});
    state.camera.max_distance = std::max(state.home.max_distance, state.camera.distance);
  }
  return state;
}

ViewerState Apply(ViewerState state, ViewerAction action) {
  const auto turn = [&](double azimuth, double elevation) {
    state = Moved(std::move(state), Orbit(state.camera, azimuth, elevation));
  };
  switch (action) {
    case ViewerAction::kToggleMeanOnly:
      state.shown = Toggled(state.shown, ShownTerms::kMeanView);
      break;
    case ViewerAction::kToggleTermAlone:
      state.shown = Toggled(state.shown, ShownTerms::kOneAlone);
      break;
    case ViewerAction::kToggleWireframe:
      state.edges =
          state.edges == EdgeOverlay::kNone ? EdgeOverlay::kWireframe : EdgeOverlay::kNone;
      break;
    case ViewerAction::kNextOverlay:
      state.overlay = Next(state.overlay);
      break;
    case ViewerAction::kMoreTerms:
      state.terms = std::min(state.terms + 1, state.model_terms);
      break;
    case ViewerAction::kFewerTerms:
      state.terms = std::max(state.terms - 1, 0);
      break;
    case ViewerAction::kSaveScreenshot:
      state.save_screenshot = true;
      break;
    case ViewerAction::kGoHome:
      state = Moved(std::move(state), state.home);
      state.touched = false;
      break;
    case ViewerAction::kTogglePanel:
      state.show_panel = !state.show_panel;
      break;
    case ViewerAction::kToggleFrameTimes:
      state.show_frame_times = !state.show_frame_times;
      break;
    case ViewerAction::kToggleCameras:
      state.show_cameras = !state.show_cameras;
      break;
    case ViewerAction::kTogglePhotograph:
      state.show_photograph = !state.show_photograph;
      break;
    case ViewerAction::kToggleTape:
      state.tool = state.tool == Tool::kMeasure ? Tool::kPick : Tool::kMeasure;
      state.tape.clear();
      break;
    case ViewerAction::kAddPathKey:
      state = WithPathKey(std::move(state));
      break;
    case ViewerAction::kRemovePathKey:
      if (!state.path.keys.empty()) state.path.keys.pop_back();
      break;
    case ViewerAction::kTurnLeft:
      turn(kTurnPerKey, 0);
      break;
    case ViewerAction::kTurnRight:
      turn(-kTurnPerKey, 0);
      break;
    case ViewerAction::kTurnUp:
      turn(0, kTurnPerKey);
      break;
    case ViewerAction::kTurnDown:
      turn(0, -kTurnPerKey);
      break;
    case ViewerAction::kCloser:
      state = Moved(std::move(state), Zoom(state.camera, kZoomPerScrollStep));
      break;
    case ViewerAction::kFarther:
      state = Moved(std::move(state), Zoom(state.camera, 1 / kZoomPerScrollStep));
      break;
    case ViewerAction::kQuit:
      state.quit = true;
      break;
  }
  return state;
}

ViewerState ApplyDrag(ViewerState state, DragMode mode, const Eigen::Vector2d& pixels, int height) {
  if (height < 1 || pixels.isZero() || !pixels.allFinite()) return state;
  const Eigen::Vector2d turn = pixels * (std::numbers::pi / height);
  switch (mode) {
    case DragMode::kPan:
      return Moved(std::move(state), Pan(state.camera, pixels, height));
    case DragMode::kZoom:
      return Moved(
          std::move(state),
          Zoom(state.camera, std::pow(kZoomPerScrollStep, -pixels.y() / kPixelsPerScrollStep)));
    case DragMode::kOrbit:
      return Moved(std::move(state), Orbit(state.camera, -turn.x(), turn.y()));
  }
  return state;
}

ViewerState ApplyScroll(ViewerState state, const ScrollInput& scroll) {
  if (!scroll.steps.allFinite() || scroll.steps.isZero() || scroll.height < 1) return state;
  const double rest = scroll.steps.y() - std::round(scroll.steps.y());
  if (scroll.steps.x() != 0 || std::abs(rest) > kWholeStepTolerance) state.trackpad_seen = true;
  const bool turns = state.scrolling == Scrolling::kTurns ||
                     (state.scrolling == Scrolling::kAutomatic && state.trackpad_seen);
  const Eigen::Vector2d pixels = kPixelsPerScrollStep * scroll.steps;
  if (scroll.shift) return ApplyDrag(std::move(state), DragMode::kPan, pixels, scroll.height);
  if (turns && !scroll.ctrl) {
    return ApplyDrag(std::move(state), DragMode::kOrbit, pixels, scroll.height);
  }
  if (scroll.steps.y() == 0) return state;
  const double factor = std::pow(kZoomPerScrollStep, scroll.steps.y());
  return Moved(std::move(state),
               ZoomTowards(state.camera, factor, scroll.from_middle, scroll.height));
}

ViewerState FocusOn(ViewerState state, const Eigen::Vector3d& point) {
  OrbitCamera camera = state.camera;
  camera.target = point;
  camera.min_distance = std::min(camera.min_distance, kNearestToPoint * state.camera.scene_radius);
  return Moved(std::move(state), camera);
}

ViewerState AddTapeEnd(ViewerState state, const Eigen::Vector3d& point) {
  if (state.tape.size() >= 2) state.tape.clear();
  state.tape.push_back(point);
  return state;
}

std::optional<double> TapeLength(const ViewerState& state) {
  if (state.tape.size() < 2) return std::nullopt;
  return (state.tape[1] - state.tape[0]).norm();
}

OrbitCamera OrbitLike(const Camera& camera, const Pose& camera_from_world,
                      const OrbitCamera& scene) {
  OrbitCamera orbit = scene;
  const Eigen::Vector3d eye = camera_from_world.Center();
  const Eigen::Vector3d axis = camera_from_world.rotation.row(2);
  const double depth = (scene.scene_center - eye).dot(axis);
  orbit.distance = std::clamp(depth, scene.min_distance, scene.max_distance);
  orbit.target = eye + orbit.distance * axis;
  orbit.azimuth = orbit.elevation = 0;
  orbit = Orbit(orbit, std::atan2(-axis.y(), -axis.x()), std::asin(std::clamp(-axis.z(), -1., 1.)));
  orbit.vertical_fov = 2 * std::atan(camera.height / (2 * camera.fy));
  return orbit;
}

GlRenderOptions MakeGlRenderOptions(const ViewerState& state) {
  GlRenderOptions options;
  options.evaluation.terms = state.shown == ShownTerms::kMeanView ? 0 : state.terms;
  if (state.shown == ShownTerms::kOneAlone && state.model_terms > 0) {
    options.evaluation.term_alone = std::max(state.terms, 1) - 1;
  }
  options.edges = state.edges;
  options.view_coordinates = state.view_coordinates;
  options.passes = state.passes;
  options.tone = state.tone;
  options.background = state.background;
  return options;
}

}  // namespace lfm
