// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "viewer/gl_renderer.h"
#include "viewer/orbit_camera.h"
#include "viewer/view_options.h"

namespace lfm {

/// What the interactive viewer shows, and what it was asked to do next.
struct ViewerState {
  OrbitCamera camera;
  OrbitCamera home;     ///< where "reset view" goes back to
  int model_terms = 0;  ///< most terms that the model has
  int terms = 0;        ///< shown, [0, model_terms]
  bool mean_only = false;
  EdgeOverlay edges = EdgeOverlay::kNone;
  ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel;
  Eigen::Vector3f background = {0, 0, 0};  ///< sRGB-coded
  bool show_panel = true;
  bool save_screenshot = false;  ///< asked for, not done yet
  bool quit = false;
  std::string message;  ///< the last thing to tell the user
};

ViewerState MakeViewerState(const LightFieldModel& model, const ViewOptions& options);

/// What a key or a button asks for.
enum class ViewerAction {
  kToggleMeanOnly,
  kToggleWireframe,
  kMoreTerms,
  kFewerTerms,
  kSaveScreenshot,
  kResetView,
  kTogglePanel,
  kQuit,
};
ViewerState Apply(ViewerState state, ViewerAction action);

enum class DragMode { kOrbit, kPan };
/// The pointer moved by `pixels` (x right, y down) with a button held, in a window `height` pixels
/// high. Orbiting: the object follows the pointer, half a turn over the window's height.
ViewerState ApplyDrag(ViewerState state, DragMode mode, const Eigen::Vector2d& pixels, int height);
/// The wheel turned by `steps`; forwards (positive) comes closer.
ViewerState ApplyWheel(ViewerState state, double steps);

GlRenderOptions MakeGlRenderOptions(const ViewerState& state);

}  // namespace lfm
