// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "viewer/camera_path.h"
#include "viewer/gl_renderer.h"
#include "viewer/orbit_camera.h"
#include "viewer/overlay_colors.h"
#include "viewer/shown_model.h"
#include "viewer/view_options.h"

namespace lfm {

/// What of the light field is shown.
enum class ShownTerms {
  kUpTo,      ///< the mean view and the first `terms` terms
  kMeanView,  ///< the mean view alone
  kOneAlone,  ///< term number `terms` alone, over gray
};

/// What a click of the left button does.
enum class Tool {
  kPick,     ///< a photograph's camera: stand there
  kMeasure,  ///< sets an end of the measuring tape on the surface
};

/// What scrolling does without a key held.
enum class Scrolling {
  kAutomatic,  ///< zooms; turns, once a device has scrolled as trackpads do
  kZooms,
  kTurns,
};

/// A film to be recorded.
enum class Film { kNone, kTurntable, kPath };

/// A click into the picture, from its upper left corner (0, 0) to its lower right (1, 1).
struct PictureClick {
  Eigen::Vector2d at = {0, 0};
  bool twice = false;
};

/// What the interactive viewer shows, and what it was asked to do next.
struct ViewerState {
  OrbitCamera camera;
  OrbitCamera home;              ///< where "home" goes back to
  bool touched = false;          ///< the camera was moved: models that arrive do not frame it anew
  std::string photograph;        ///< the photograph whose camera shows the scene; empty: `camera`
  bool show_photograph = false;  ///< beside the rendering, with their difference
  bool show_cameras = false;     ///< of the photographs

  int model_terms = 0;  ///< most terms that a model has
  int terms = 0;        ///< [0, model_terms]
  ShownTerms shown = ShownTerms::kUpTo;
  Overlay overlay = Overlay::kNone;
  EdgeOverlay edges = EdgeOverlay::kNone;
  ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel;
  Passes passes = Passes::kOne;
  Tone tone;
  Eigen::Vector3f background = {0, 0, 0};  ///< sRGB-coded

  std::vector<ShownModel> models;  ///< as the scene has them; moving one here moves it there

  Tool tool = Tool::kPick;
  std::vector<Eigen::Vector3d> tape;  ///< none, one or both ends, mm, world
  Scrolling scrolling = Scrolling::kAutomatic;
  bool trackpad_seen = false;
  CameraPath path;  ///< as composed so far
  int turntable_frames = 120;

  bool show_panel = true, show_frame_times = false;
  bool add_dropped = false;  ///< dropped models join what is shown, instead of replacing it
  std::string message;       ///< the last thing to tell the user

  // Asked for, not done yet.
  std::optional<PictureClick> click;
  Film film = Film::kNone;
  bool stop_film = false, save_screenshot = false, save_path = false, save_scene = false;
  bool quit = false;
};

ViewerState MakeViewerState(const ViewOptions& options);
/// The scene is now of this mesh (world) and has this many terms: a camera that was not touched
/// frames it as `options` say; all terms are shown where all were before. `smallest_radius`, mm: of
/// the scene's smallest object, which the eye may come as near to as if it were alone; 0: as near
/// as the whole mesh allows.
ViewerState WithScene(ViewerState state, const TriangleMesh& mesh, int terms,
                      const ViewOptions& options, double smallest_radius = 0);

/// What a key or a button asks for.
enum class ViewerAction {
  kToggleMeanOnly,
  kToggleTermAlone,
  kToggleWireframe,
  kNextOverlay,
  kMoreTerms,
  kFewerTerms,
  kSaveScreenshot,
  kGoHome,
  kTogglePanel,
  kToggleFrameTimes,
  kToggleCameras,
  kTogglePhotograph,
  kToggleTape,
  kAddPathKey,
  kRemovePathKey,
  kTurnLeft,
  kTurnRight,
  kTurnUp,
  kTurnDown,
  kCloser,
  kFarther,
  kQuit,
};
ViewerState Apply(ViewerState state, ViewerAction action);

enum class DragMode { kOrbit, kPan, kZoom };
/// The pointer moved by `pixels` (x right, y down) with a button held, in a window `height` pixels
/// high. Orbiting: the object follows the pointer, half a turn over the window's height. Zooming:
/// upwards comes closer.
ViewerState ApplyDrag(ViewerState state, DragMode mode, const Eigen::Vector2d& pixels, int height);

struct ScrollInput {
  Eigen::Vector2d steps = {0, 0};        ///< to the right, forwards (away from the user)
  bool shift = false, ctrl = false;      ///< pan; zoom: pinches arrive as ctrl with most drivers
  Eigen::Vector2d from_middle = {0, 0};  ///< where the pointer is, pixels
  int height = 1;                        ///< of the window, pixels
};
/// Zooming forwards comes closer, towards what lies under the pointer. Steps that are no whole
/// numbers, or sideways, are a trackpad's.
ViewerState ApplyScroll(ViewerState state, const ScrollInput& scroll);

/// Turns about this point of the scene from now on, seen from the same direction and distance; the
/// eye may come nearer to it than to a whole scene.
ViewerState FocusOn(ViewerState state, const Eigen::Vector3d& point);

/// Sets the next end of the tape; with both ends there it begins anew.
ViewerState AddTapeEnd(ViewerState state, const Eigen::Vector3d& point);
/// Its length, mm; none without both ends.
std::optional<double> TapeLength(const ViewerState& state);

/// An orbit that shows what this camera shows, as far as an orbit can (upright, its middle on the
/// scene's): same eye and direction; straight up or down, where orbits do not go, nearly.
OrbitCamera OrbitLike(const Camera& camera, const Pose& camera_from_world,
                      const OrbitCamera& scene);

GlRenderOptions MakeGlRenderOptions(const ViewerState& state);

}  // namespace lfm
