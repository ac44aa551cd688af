// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_state.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {
namespace {

constexpr double kZoomPerWheelStep = 0.9;

}  // namespace

ViewerState MakeViewerState(const LightFieldModel& model, const ViewOptions& options) {
  ViewerState state;
  state.camera = state.home = MakeOrbitCamera(model.mesh, options);
  state.model_terms = model.terms;
  state.terms = std::clamp(options.terms, 0, model.terms);
  state.mean_only = options.mean_only;
  state.background = ParseColor(options.background);
  return state;
}

ViewerState Apply(ViewerState state, ViewerAction action) {
  switch (action) {
    case ViewerAction::kToggleMeanOnly:
      state.mean_only = !state.mean_only;
      break;
    case ViewerAction::kToggleWireframe:
      state.edges =
          state.edges == EdgeOverlay::kNone ? EdgeOverlay::kWireframe : EdgeOverlay::kNone;
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
    case ViewerAction::kResetView:
      state.camera = state.home;
      break;
    case ViewerAction::kTogglePanel:
      state.show_panel = !state.show_panel;
      break;
    case ViewerAction::kQuit:
      state.quit = true;
      break;
  }
  return state;
}

ViewerState ApplyDrag(ViewerState state, DragMode mode, const Eigen::Vector2d& pixels, int height) {
  if (height < 1) return state;
  if (mode == DragMode::kPan) {
    state.camera = Pan(state.camera, pixels, height);
  } else {
    const Eigen::Vector2d turn = pixels * (std::numbers::pi / height);
    state.camera = Orbit(state.camera, -turn.x(), turn.y());
  }
  return state;
}

ViewerState ApplyWheel(ViewerState state, double steps) {
  state.camera = Zoom(state.camera, std::pow(kZoomPerWheelStep, steps));
  return state;
}

GlRenderOptions MakeGlRenderOptions(const ViewerState& state) {
  GlRenderOptions options;
  options.evaluation.terms = state.mean_only ? 0 : state.terms;
  options.edges = state.edges;
  options.view_coordinates = state.view_coordinates;
  options.background = state.background;
  return options;
}

}  // namespace lfm
